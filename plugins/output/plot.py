"""Draw what a solve did: every stage of a limb, its goal and the joints at their limits.

One picture a goal; with few goals each gets three views, with many one. The world of limbik is
left-handed with Y up; matplotlib's is right-handed with Z up, so (x, y, z) is drawn at (x, z, y):
nothing is mirrored.
"""

from collections.abc import Sequence
from importlib.util import find_spec
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.core.errors import EnvironmentProblem, Fault, InputError
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.solution import Solution
from limbik.core.solution2d import PlanarSolution
from limbik.plugins.output.plotplane import (
    draw_planar,
    draw_plane,
    legend_entries,
    plane_points,
)
from limbik.plugins.output.records import outcome

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
MOST_PICTURES = 12
WIDEST_TEXT = 44  # characters
SPACE = (0, 2, 1)  # limbik's axes in the order of matplotlib's
INK, FAINT, LINE, PAPER = "#1f2933", "#7b8794", "#d5dbe1", "#ffffff"
GOAL, LIMIT, FINAL = "#00875a", "#d62246", "#0b3d91"
STAGES: dict[str, dict[str, Any]] = {
    "initial": {"color": "#b8c1cc", "lw": 2.0, "label": "initial"},
    "aim": {"color": "#56b4e9", "lw": 1.6, "label": "aim", "ls": (0, (4, 2))},
    "bend": {"color": "#e69f00", "lw": 1.8, "label": "initial bend"},
    "final": {"color": FINAL, "lw": 3.4, "label": "final"},
}
LOOK: Any = {  # matplotlib names every key in its type
    "font.size": 9.0,
    "grid.color": "#e4e7eb",
    "grid.linewidth": 0.7,
    "axes.edgecolor": LINE,
    "axes3d.xaxis.panecolor": (0.97, 0.975, 0.98, 1.0),
    "axes3d.yaxis.panecolor": (0.97, 0.975, 0.98, 1.0),
    "axes3d.zaxis.panecolor": (0.955, 0.965, 0.975, 1.0),
    "xtick.color": LINE,
    "ytick.color": LINE,
    "xtick.labelcolor": FAINT,
    "ytick.labelcolor": FAINT,
    "svg.hashsalt": "limbik",  # so that the same scene gives the same file
}
Bounds = tuple[Array, Array]


def check_plot(path: Path) -> None:
    """Refuse, before anything is solved, a picture that cannot be drawn.

    Raises:
        InputError: The ending is none of `FORMATS`.
        EnvironmentProblem: matplotlib is not installed.
    """
    if form_of(path) not in FORMATS:
        message = f"the file must end in {', '.join(f'.{f}' for f in FORMATS)}, not '{path.name}'"
        raise InputError(Fault("choice", message, "--plot"))
    if find_spec("matplotlib") is None:
        raise EnvironmentProblem("drawing needs matplotlib: pip install 'limbik[plot]'")


def form_of(path: Path) -> str:
    """Return what a picture's ending asks for, one of `FORMATS` if `check_plot` took it."""
    return path.suffix.lower().removeprefix(".")


def draw(scene: Scene, solutions: Sequence[Solution], form: str = "png") -> bytes:
    """Draw the solutions of a scene; the first `MOST_PICTURES` if there are more.

    Args:
        scene: The scene.
        solutions: One solution a goal, with traces.
        form: One of `FORMATS`.

    Returns:
        The file's content.
    """
    from matplotlib import rc_context

    with rc_context(LOOK):
        return picture(_figure(scene, solutions), form)


def _figure(scene: Scene, solutions: Sequence[Solution]) -> "Figure":
    shown = list(zip(scene.goal_names, solutions, strict=True))[:MOST_PICTURES]
    columns, rows = grid(len(shown))
    width, height = (9.0, 6.8) if len(shown) == 1 else (3.7 * columns, 4.0 * rows + 1.2)
    figure = new_figure(width, height)
    bounds = _bounds([solution for _, solution in shown])
    if len(shown) == 1:
        _draw_views(figure, *shown[0], bounds)
    else:
        for index, (name, solution) in enumerate(shown, 1):
            axes = figure.add_subplot(rows, columns, index, projection="3d")
            _draw_space(axes, solution, bounds)
            _caption(axes, name, solution)
    _legend(figure, scene, len(shown), len(solutions))
    figure.subplots_adjust(0.03, 0.8 / height, 0.97, 1.0 - 1.35 / height, 0.06, 0.34)
    return figure


def new_figure(width: float, height: float) -> "Figure":
    """Return an empty picture of a size [inches]; no window system is asked."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def picture(figure: "Figure", form: str, dpi: int = 130) -> bytes:
    """Return the content of a figure's file."""
    content = BytesIO()
    figure.savefig(content, format=form, dpi=dpi, metadata=undated(form))
    return content.getvalue()


def seen_axes(extent: Array) -> tuple[int, int]:
    """Return the axes of a flat view of points, to the right and up; y is up if it is seen.

    Left out is the axis along which they spread least.

    Args:
        extent: How far the points spread along x, y, z, (3,) [length].
    """
    flat = int(np.argmin(extent + np.array([0.0, 1e-9, 0.0])))
    return ((2, 1), (0, 2), (0, 1))[flat]


def grid(count: int) -> tuple[int, int]:
    """Return columns and rows for some pictures, such that the last row is as full as can be."""
    columns = min((3, 4, 5), key=lambda columns: (-count % columns, columns))
    columns = min(columns, count)
    return columns, -(-count // columns)


def undated(form: str) -> dict[str, None]:
    """Leave the date out, so that the same scene gives the same file."""
    return {"png": {}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}[form]


def _poses(solution: Solution) -> list[tuple[str, Array]]:
    """The stages to draw, under the names of `STAGES`, and the final pose last."""
    trace = solution.trace or ()
    early = [(stage.name, stage.positions) for stage in trace if stage.name in STAGES]
    return [*early, ("final", solution.positions)]


def _bounds(solutions: Sequence[Solution]) -> Bounds:
    """Lowest and highest corner of a box that holds all drawn, the same for every picture."""
    poses = [places for solution in solutions for _, places in _poses(solution)]
    points = np.concatenate([*poses, *([solution.goal] for solution in solutions)])
    poles = [plane_points(s) for s in solutions if isinstance(s, PlanarSolution)]
    return box_around(np.concatenate([points, *poles]))


def box_around(points: Array) -> Bounds:
    """Return a box around points, (k, 3), that is flat in no direction."""
    low, high = points.min(axis=0), points.max(axis=0)
    extent = float((high - low).max()) or 1.0
    spare = np.maximum(0.55 * extent - (high - low), 0.0) / 2.0 + 0.05 * extent  # no flat boxes
    return low - spare, high + spare


def _draw_limb(axes: Any, solution: Solution, order: tuple[int, ...]) -> None:
    """Draw stages, joints and goal; `order` picks the world axes that are drawn."""
    if isinstance(solution, PlanarSolution):
        draw_plane(axes, solution, order)
    for level, (stage, places) in enumerate(_poses(solution), 2):
        style = {k: v for k, v in STAGES[stage].items() if k != "label"}
        axes.plot(*places[:, order].T, zorder=level, solid_capstyle="round", **style)
    final = solution.positions[:, order]
    count = len(final)
    size = 7.0 if count <= 8 else 4.0
    axes.plot(*final.T, "o", ms=size, mfc=PAPER, mec=FINAL, mew=1.6, zorder=8)
    limited = sorted({joint for joint, _ in solution.resting_axes()})
    axes.plot(*final[limited].T, "o", ms=size, mfc=LIMIT, mec=LIMIT, zorder=9)
    goal = solution.goal[list(order)]
    axes.plot(*goal[:, None], "o", ms=13, mfc="none", mec=GOAL, mew=2.0, zorder=10)
    axes.plot(*goal[:, None], "+", ms=9, mec=GOAL, mew=1.6, zorder=10)


def _draw_space(axes: Any, solution: Solution, bounds: Bounds) -> None:
    """Draw one solution in three dimensions, with shadows that give depth."""
    low, _ = bounds
    floor, wall = solution.positions.copy(), solution.positions.copy()
    floor[:, 1], wall[:, 2] = low[1], low[2]
    for shadow in (floor, wall):
        axes.plot(*shadow[:, SPACE].T, color="#dfe4ea", lw=2.0, zorder=1)
    foot = np.array([solution.goal, solution.goal])
    foot[1, 1] = low[1]
    axes.plot(*foot[:, SPACE].T, color=GOAL, lw=0.9, ls=":", zorder=1)
    _draw_limb(axes, solution, SPACE)
    set_space(axes, bounds)


def set_space(axes: Any, bounds: Bounds) -> None:
    """Set limits, equal axes and the view of a picture in space."""
    from matplotlib.ticker import MaxNLocator

    low, high = bounds
    axes.set(xlim=(low[0], high[0]), ylim=(low[2], high[2]), zlim=(low[1], high[1]))
    axes.set_box_aspect((high - low)[list(SPACE)], zoom=1.15)  # equal axes
    axes.view_init(elev=16, azim=40)
    for axis, letter in ((axes.xaxis, "x"), (axes.yaxis, "z"), (axes.zaxis, "y")):
        axis.set_tick_params(labelsize=7, pad=-2)
        axis.set_major_locator(MaxNLocator(4))
        axis.set_label_text(letter, fontsize=9, color=FAINT)
        axis.labelpad = -8


def _draw_views(figure: "Figure", name: str, solution: Solution, bounds: Bounds) -> None:
    """Draw one solution large in space, and from the front and the side."""
    grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1.0))
    space = figure.add_subplot(grid[:, 0], projection="3d")
    _draw_space(space, solution, bounds)
    _caption(space, name, solution)
    low, high = bounds
    for row, (order, title) in enumerate((((0, 1), "x and y"), ((2, 1), "z and y"))):
        axes: Any = figure.add_subplot(grid[row, 1])
        if row == 0 and isinstance(solution, PlanarSolution):
            draw_planar(axes, solution, STAGES, GOAL, LIMIT)
            continue
        _draw_limb(axes, solution, order)
        across, up = order
        axes.set(xlim=(low[across], high[across]), ylim=(low[up], high[up]), aspect="equal")
        axes.set_title(title, fontsize=9, color=FAINT)
        axes.grid(True)
        axes.tick_params(labelsize=7, length=0)


def write_above(axes: Any, lines: Sequence[tuple[float, str, dict[str, Any]]]) -> None:
    """Write lines above a picture: how far up [points], text and look of each."""
    for points, text, style in lines:
        axes.annotate(
            text, (0.5, 1.0), (0.0, points), "axes fraction", "offset points", ha="center", **style
        )


def _caption(axes: Any, name: str, solution: Solution) -> None:
    """Write the goal's name, how it went, and the joints at their limits."""
    ending = f"{outcome(solution)}, distance {float(solution.distance):.2g}"
    lines = (
        (34.0, name, {"fontsize": 11, "fontweight": "bold", "color": INK}),
        (20.0, ending, {"color": GOAL if solution.reached else LIMIT}),
        (8.0, _limit_text(solution), {"fontsize": 7.5, "color": LIMIT}),
    )
    write_above(axes, lines)


def _limit_text(solution: Solution) -> str:
    """Name the joints at their limits, as many as fit above a picture."""
    by_joint: dict[str, list[str]] = {}
    for joint, axis in solution.resting_axes():
        by_joint.setdefault(solution.chain.names[joint], []).append(axis)
    found = [f"{joint} {' '.join(axes)}" for joint, axes in by_joint.items()]
    text = ", ".join(found)
    for left_out in range(1, len(found)):
        if len(text) <= WIDEST_TEXT:
            break
        text = f"{', '.join(found[:-left_out])} and {left_out} more"
    return f"at limit: {text}" if found else ""


def _legend(figure: "Figure", scene: Scene, shown: int, total: int) -> None:
    from matplotlib.lines import Line2D

    dot: dict[str, Any] = {"ls": "none", "marker": "o"}
    entries = [Line2D([], [], **style) for style in STAGES.values()]
    entries.append(Line2D([], [], **dot, ms=9, mfc="none", mec=GOAL, mew=2.0, label="goal"))
    entries.append(Line2D([], [], **dot, ms=7, mfc=LIMIT, mec=LIMIT, label="joint at a limit"))
    columns = len(entries)
    if scene.pole is not None:
        legend_entries(entries, stages=shown == 1)
        columns = -(-len(entries) // 2)
    figure.legend(handles=entries, loc="lower center", ncols=columns, frameon=False, labelcolor=INK)
    goals = f"{total} goals" if total > 1 else "1 goal"
    title = f"{scene.name}: {len(scene.chain)} joints, {goals}"
    title += f", the first {shown} shown" if shown < total else ""
    figure.suptitle(title, fontsize=13, color=INK, y=1.0 - 0.2 / figure.get_figheight(), va="top")
