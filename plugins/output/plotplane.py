"""What a picture of the 2D solver has besides: the IK plane, the pole, the planar joints."""

from typing import Any, Final

import numpy as np

from limbik.core.rotation import Array
from limbik.core.solution2d import PlanarSolution

POLE: Final = "#8250c4"
PLANE: Final = "#efe9f8"
ROUND: Final[dict[str, Any]] = {"color": "#9fb3d9", "lw": 0.7, "zorder": 3}
EARLY: Final[dict[str, dict[str, Any]]] = {
    # Thick to thin, so that stages that lie on each other are all seen.
    "simple aim": {"color": "#cfe3d4", "lw": 7.0, "label": "simple aim"},
    "reference axis": {"color": "#8cc5a0", "lw": 4.5, "label": "axis to pole"},
    "fk": {"color": "#c98bb9", "lw": 2.6, "label": "with FK"},
}
"""Stages only the 2D solver has, drawn in the plane; the others look as they do in space."""


def plane_points(solution: PlanarSolution) -> Array:
    """Return points a picture has to hold besides the poses, (k, 3): the pole."""
    return solution.pole[None]


def draw_plane(axes: Any, solution: PlanarSolution, order: tuple[int, ...]) -> None:
    """Draw the triangle base, goal, pole and the pole vector; `order` picks the world axes."""
    base = solution.positions[0]
    corners = np.array([base, solution.goal, solution.pole, base])[:, order]
    if len(order) == 3:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        shade = Poly3DCollection([corners[:3]], facecolor=PLANE, edgecolor="none", alpha=0.6)
        axes.add_collection3d(shade)
    else:
        axes.fill(*corners[:3].T, color=PLANE, lw=0, zorder=0)
    vector = np.array([base, solution.pole])[:, order]
    axes.plot(*vector.T, color=POLE, lw=1.0, ls=(0, (3, 2)), zorder=2)
    axes.plot(*vector[1:].T, "D", ms=6, mfc=POLE, mec=POLE, zorder=7)


def draw_planar(
    axes: Any, solution: PlanarSolution, looks: dict[str, dict[str, Any]], goal: str, limit: str
) -> None:
    """Draw the planar joints of all stages in the IK plane, X toward the goal, Y to the pole.

    Args:
        axes: Where to draw.
        solution: With its trace.
        looks: How the stages look that both solvers have, by name.
        goal: Colour of the goal.
        limit: Colour of joints at their limits.
    """
    for stage in solution.trace or ():
        seen = _in_plane(solution, stage.positions)
        if stage.name in EARLY or stage.name in looks:
            look = EARLY.get(stage.name) or looks[stage.name]
            level = {"zorder": 4 if stage.name in looks else 2}
            style = {key: value for key, value in look.items() if key != "label"}
            if stage.name != "initial":  # not in the plane, only its shadow
                axes.plot(*seen.T, solid_capstyle="round", **style, **level)
        else:
            axes.plot(*seen.T, **ROUND)
    final = _in_plane(solution, solution.positions)
    at_limit = [joint for joint, _ in solution.resting_axes()]
    look = looks["final"]
    axes.plot(*final.T, color=look["color"], lw=look["lw"], zorder=5)
    axes.plot(*final.T, "o", ms=6, mfc="white", mec=look["color"], mew=1.6, zorder=6)
    axes.plot(*final[at_limit].T, "o", ms=6, mfc=limit, mec=limit, zorder=7)
    target = _in_plane(solution, solution.goal[None])
    axes.axhline(0.0, color=goal, lw=0.8, ls=":", zorder=1)
    axes.plot(*target.T, "+", ms=9, mec=goal, mew=1.6, zorder=8)
    if len(final) <= 8:
        for joint, name in enumerate(solution.chain.names[:-1]):
            angle = round(float(np.degrees(solution.planar_angles[joint])))
            beside = (6, 6) if joint else (4, -14)
            text: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7}
            axes.annotate(f"{name} {angle}°", final[joint], beside, **text)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.12)
    axes.set_title("IK plane: goal to the right, pole up", fontsize=9)
    axes.grid(True)
    axes.tick_params(labelsize=7, length=0)


def _in_plane(solution: PlanarSolution, places: Array) -> Array:
    """Return world positions as seen along the plane's normal, (k, 2)."""
    return np.asarray((places - solution.positions[0]) @ solution.plane[:, :2])


def legend_entries(entries: list[Any], stages: bool) -> None:
    """Add what only these pictures show to a legend's entries: the pole, or all stages too."""
    from matplotlib.lines import Line2D

    diamond: dict[str, Any] = {"ls": (0, (3, 2)), "lw": 1.0, "color": POLE, "marker": "D"}
    entries.append(Line2D([], [], **diamond, label="pole and IK plane"))
    if stages:
        entries += [Line2D([], [], **look) for look in EARLY.values()]
        entries.append(Line2D([], [], color=ROUND["color"], lw=ROUND["lw"], label="CCD rounds"))
