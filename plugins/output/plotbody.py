"""Draw a body of several chains: its whole skeleton, each chain in a colour, and the goals.

One picture a frame, axes as in `limbik.plugins.output.plot`.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.core.body import BodySolution
from limbik.core.bodyscene import BodyScene
from limbik.core.rotation import Array
from limbik.plugins.output.compare import COLOURS
from limbik.plugins.output.plot import (
    FAINT,
    GOAL,
    INK,
    LIMIT,
    LOOK,
    MOST_PICTURES,
    PAPER,
    SPACE,
    Bounds,
    box_around,
    grid,
    new_figure,
    picture,
    set_space,
    write_above,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_body(scene: BodyScene, found: Sequence[BodySolution], form: str = "png") -> bytes:
    """Draw the frames of a body; `MOST_PICTURES` evenly chosen if there are more.

    Args:
        scene: The scene.
        found: One solution a frame.
        form: `png`, `svg` or `pdf`.

    Returns:
        The file's content.
    """
    from matplotlib import rc_context

    with rc_context(LOOK):
        return picture(_figure(scene, found), form)


def _figure(scene: BodyScene, found: Sequence[BodySolution]) -> "Figure":
    shown = np.unique(np.linspace(0, len(found) - 1, min(len(found), MOST_PICTURES)).astype(int))
    columns, rows = grid(len(shown))
    width, height = (7.0, 7.6) if len(shown) == 1 else (3.7 * columns, 4.0 * rows + 1.2)
    figure = new_figure(width, height)
    goals = [s.goal[None] for k in shown for s in found[k].solutions.values()]
    bounds = box_around(np.concatenate([*goals, *(found[k].positions for k in shown)]))
    for place, index in enumerate(shown, 1):
        axes: Any = figure.add_subplot(rows, columns, place, projection="3d")
        _draw(axes, scene, found[index], bounds)
        _caption(axes, scene, scene.frame_names[index], found[index])
    _legend(figure, scene, len(shown))
    figure.subplots_adjust(0.03, 0.8 / height, 0.97, 1.0 - 1.2 / height, 0.06, 0.28)
    return figure


def _draw(axes: Any, scene: BodyScene, body: BodySolution, bounds: Bounds) -> None:
    bones = _bones(body)
    for shadow, level in ((1, bounds[0][1]), (2, bounds[0][2])):
        for bone in bones:
            flat = bone.copy()
            flat[:, shadow] = level
            axes.plot(*flat[:, SPACE].T, color="#e8ecf0", lw=1.6, zorder=1)
    for bone in bones:
        axes.plot(*bone[:, SPACE].T, color=FAINT, lw=1.6, zorder=2, solid_capstyle="round")
    for part, colour in zip(scene.parts, COLOURS * len(scene.parts), strict=False):
        solution = body.solutions[part.name]
        places = solution.positions[:, SPACE]
        axes.plot(*places.T, color=colour, lw=3.0, zorder=4, solid_capstyle="round")
        axes.plot(*places.T, "o", ms=3.6, mfc=PAPER, mec=colour, mew=1.3, zorder=5)
        goal = solution.goal[list(SPACE)][:, None]
        mark = GOAL if solution.reached else LIMIT
        axes.plot(*goal, "o", ms=11, mfc="none", mec=mark, mew=1.8, zorder=6)
        axes.plot(*goal, "+", ms=7, mec=mark, mew=1.4, zorder=6)
    set_space(axes, bounds)


def _bones(body: BodySolution) -> list[Array]:
    """Ends of every bone that has a length, (2, 3) each."""
    parents = enumerate(body.skeleton.parents)
    pairs = [body.positions[[parent, joint]] for joint, parent in parents if parent >= 0]
    return [pair for pair in pairs if np.ptp(pair, axis=0).max() > 0.0]


def _caption(axes: Any, scene: BodyScene, name: str, body: BodySolution) -> None:
    missed = [part.name for part in scene.parts if not body.solutions[part.name].reached]
    ending = f"not reached: {', '.join(missed)}" if missed else "all chains reached"
    lines = (
        (22.0, name, {"fontsize": 11, "fontweight": "bold", "color": INK}),
        (9.0, ending, {"fontsize": 8, "color": LIMIT if missed else GOAL}),
    )
    write_above(axes, lines)


def _legend(figure: "Figure", scene: BodyScene, shown: int) -> None:
    from matplotlib.lines import Line2D

    parts = zip(scene.parts, COLOURS * len(scene.parts), strict=False)
    entries = [Line2D([], [], color=colour, lw=3, label=part.name) for part, colour in parts]
    ring: dict[str, Any] = {"ls": "none", "marker": "o", "ms": 9, "mfc": "none", "mew": 1.8}
    entries.append(Line2D([], [], **ring, mec=GOAL, label="goal"))
    columns = len(entries) if shown > 1 else 4
    figure.legend(handles=entries, loc="lower center", ncols=columns, frameon=False, labelcolor=INK)
    total = len(scene.frame_names)
    title = f"{scene.name}: {len(scene.parts)} chains, {total} frame{'s' if total > 1 else ''}"
    title += f", {shown} shown" if shown < total else ""
    figure.suptitle(title, fontsize=13, color=INK, y=1.0 - 0.15 / figure.get_figheight(), va="top")
