"""Several solvers on one scene, side by side: a table and a picture (001's figures; G-03)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.core.errors import Fault, InputError, shortlist
from limbik.core.goals import PLACE
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.slots import SOLVER
from limbik.core.solution import AT_LIMIT, Solution
from limbik.core.solving import solve_scene
from limbik.core.whole import OWN_SOLVERS, prepare
from limbik.plugins.output.plot import (
    FAINT,
    GOAL,
    INK,
    LIMIT,
    LOOK,
    PAPER,
    new_figure,
    picture,
    seen_axes,
    write_above,
)
from limbik.plugins.output.records import solve_record, status_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = ("#1f6fd6", "#e0559b", "#00875a", "#e69f00", "#6f4bb8", "#0f8b9d", "#8a5a2b", "#5f6b7a")
MOST_ROWS = 5


@dataclass(frozen=True)
class Comparison:
    """What several solvers make of one scene.

    Attributes:
        scene: The scene.
        solutions: One solution a goal for each solver, by its name.
    """

    scene: Scene
    solutions: Mapping[str, Sequence[Solution]]

    @property
    def are_reached(self) -> bool:
        """Whether every solver reaches every goal."""
        return all(s.reached for found in self.solutions.values() for s in found)


def compare(scene: Scene, names: Sequence[str], registry: Registry) -> Comparison:
    """Solve a scene with several solvers.

    Args:
        scene: The scene; its own solver is left aside.
        names: Names of solvers, `3d` and `2d` for limbik's own.
        registry: Where they are looked up.

    Raises:
        InputError: A name is unknown, or a solver does not take this chain.
        PluginError: A solver failed.
    """
    faults: list[Fault] = []
    ready = {}
    for name in names:
        try:
            bound = None if name in OWN_SOLVERS else registry.bind(SOLVER.name, name)
            if bound is not None:
                prepare(bound, scene.chain, scene.settings)
            in_plane = name == "2d"
            if in_plane and scene.pole is None:
                raise InputError("the 2D solver needs a scene with a pole")
            ready[name] = replace(scene, solver=bound, pole=scene.pole if in_plane else None)
        except InputError as error:
            faults += [replace(fault, key=f"--solvers {name}") for fault in error.faults]
    if not names:
        faults.append(Fault("empty", "at least one solver is needed", "--solvers"))
    if faults:
        raise InputError(shortlist(faults))
    return Comparison(scene, {name: solve_scene(s, registry) for name, s in ready.items()})


def broken_limits(solution: Solution) -> int:
    """Count the joint axes outside their ranges."""
    chain, angles = solution.chain, solution.angles
    outside = (angles < chain.low - AT_LIMIT) | (angles > chain.high + AT_LIMIT)
    return int(outside.sum())


def compare_record(comparison: Comparison) -> dict[str, Any]:
    """Describe a comparison for machines."""
    record: dict[str, Any] = {"status": "ok" if comparison.are_reached else "unreached"}
    record["scene"] = comparison.scene.document.name
    record["solvers"] = {
        name: solve_record(comparison.scene, found)["goals"]
        for name, found in comparison.solutions.items()
    }
    for name, found in comparison.solutions.items():
        for goal, solution in zip(record["solvers"][name], found, strict=True):
            goal["broken_limits"] = broken_limits(solution)
    return record


def draw_comparison(comparison: Comparison, form: str) -> bytes:
    """Draw one row a goal and one column a solver; returns the file's content."""
    from matplotlib import rc_context

    with rc_context(LOOK):
        return picture(_figure(comparison), form)


def _figure(comparison: Comparison) -> "Figure":
    scene, solvers = comparison.scene, comparison.solutions
    rows, columns = min(len(scene.goals), MOST_ROWS), len(solvers)
    height = 3.3 * rows + 0.9
    figure = new_figure(3.3 * columns, height)
    order, low, high = _view(comparison, rows)
    for column, (name, found) in enumerate(solvers.items()):
        for row in range(rows):
            axes: Any = figure.add_subplot(rows, columns, row * columns + column + 1)
            _draw(axes, found[row], order, COLOURS[column % len(COLOURS)])
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
            axes.grid(True)
            axes.tick_params(labelsize=7, length=0, labelleft=column == 0)
            title = f"{name}\n" if row == 0 else ""
            _caption(axes, title, scene.goal_names[row], found[row])
    names = f"{PLACE[order[0]]} to the right, {PLACE[order[1]]} up"
    left_out = f"; {len(scene.goals) - rows} more goals" if rows < len(scene.goals) else ""
    text = f"{scene.name}: {names}. × goal, filled: joint at a limit, square: beyond it{left_out}"
    figure.text(0.5, 0.12 / height, text, ha="center", fontsize=8, color=FAINT)
    figure.subplots_adjust(0.06, 0.5 / height, 0.98, 1.0 - 0.62 / height, 0.08, 0.2)
    return figure


def _view(comparison: Comparison, rows: int) -> tuple[tuple[int, int], Array, Array]:
    """Pick the two axes with the largest extent, the upright one upward; low and high corners."""
    found = [s for all_of in comparison.solutions.values() for s in all_of[:rows]]
    points = np.concatenate([*(s.positions for s in found), *(s.goal[None] for s in found)])
    order = seen_axes(np.ptp(points, axis=0))
    seen = points[:, order]
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2.0
    half = 0.56 * float(np.ptp(seen, axis=0).max() or 1.0)
    return order, middle - half, middle + half


def _draw(axes: Any, solution: Solution, order: tuple[int, int], colour: str) -> None:
    """Draw one pose, its joints and its goal."""
    places = solution.positions[:, order]
    axes.plot(*places.T, color=colour, lw=5.0, solid_capstyle="round", alpha=0.85, zorder=2)
    chain, angles = solution.chain, solution.angles
    past = np.maximum(chain.low - angles, angles - chain.high).max(axis=1)
    resting = {joint for joint, _ in solution.resting_axes()}
    for joint in range(len(chain)):
        mark, fill = "o", PAPER
        if past[joint] > AT_LIMIT:
            mark, fill = "s", LIMIT
        elif joint in resting:
            fill = LIMIT
        edge = LIMIT if fill == LIMIT else INK
        axes.plot(*places[joint], mark, ms=6.5, mfc=fill, mec=edge, mew=1.3, zorder=4)
    goal = solution.goal[list(order)]
    axes.plot(*goal, "x", ms=10, mec="#d0021b", mew=2.2, zorder=5)


def _caption(axes: Any, title: str, goal: str, solution: Solution) -> None:
    """Write solver, goal and outcome over a picture."""
    broken = broken_limits(solution)
    parts = [status_label(solution), f"distance {float(solution.distance):.2g}"]
    parts += [f"{solution.iterations} sweeps"] if solution.iterations else []
    parts += [f"{broken} limit{'s' * (broken > 1)} broken"] if broken else []
    good = solution.reached and not broken
    axes.set_title(f"{title}goal {goal}", fontsize=9, color=INK, pad=16)
    write_above(axes, [(5.0, ", ".join(parts), {"fontsize": 7, "color": GOAL if good else LIMIT})])
