"""Pictures of a run: bars that compare the variants, and maps of where goals were reached."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.core.goals import PLACE
from limbik.core.rotation import Array
from limbik.plugins.experiments.summary import Row, Summary, View, metric_title
from limbik.plugins.output.compare import COLOURS
from limbik.plugins.output.plot import FAINT, INK, LOOK, new_figure, picture

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_BARS = 40
MOST_MAPS = 12
WIDE_NAME = 52  # characters
WIDE_TITLE = 32
SEVERAL = 6.0  # goals in a cell of a map that say something about it


@dataclass(frozen=True)
class Picture:
    """A picture with its name.

    Attributes:
        name: File name without ending.
        group: The chain and the goal set it is about.
        title: What it shows.
        content: Bytes of a PNG file.
    """

    name: str
    group: tuple[str, str]
    title: str
    content: bytes


def pictures(summary: Summary) -> list[Picture]:
    """Draw everything there is to see of a run."""
    from matplotlib import rc_context

    drawn = []
    with rc_context(LOOK):
        for chain, goals, rows in summary.groups():
            solved = [row for row in rows if row.count]
            if not solved:
                continue
            name = "".join(c if c.isalnum() or c in "-_" else "-" for c in f"{chain}-{goals}")
            figure = _bars(solved, summary.metrics)
            content = picture(figure, "png", dpi=120)
            drawn.append(Picture(name, (chain, goals), "the variants compared", content))
            if not solved[0].is_path:
                figure = _maps(solved, summary.views[chain, goals])
                title, content = "where goals were reached", picture(figure, "png", dpi=120)
                drawn.append(Picture(f"{name}-map", (chain, goals), title, content))
    return drawn


def best(rows: Sequence[Row], most: int) -> list[Row]:
    """Return so many rows, in their order: those with the most goals reached, then the nearest."""
    ranked = sorted(rows, key=lambda row: (-row.share, row.miss[1], row.time))
    kept = {id(row) for row in ranked[:most]}
    return [row for row in rows if id(row) in kept]


def _bars(rows: Sequence[Row], metrics: Sequence[str]) -> "Figure":
    """One bar a variant in one panel for each number; less is better in all but the first."""
    shown = best(rows, MOST_BARS)
    panels: list[tuple[str, Callable[[Row], float]]] = [
        ("reached [%]", lambda row: 100.0 * row.share),
        ("miss, 95 % are nearer [% L]", lambda row: row.miss[1]),
        ("time of a solve [µs]", lambda row: row.time),
    ]
    for name in metrics:
        if any(isfinite(row.metric(name)) for row in shown):
            panels.append((metric_title(name), lambda row, name=name: row.metric(name)))  # type: ignore[misc]
    names = [_cut(row.label) for row in shown]
    margin = 0.3 + 0.068 * max(map(len, names))
    columns = min(len(panels), 4)
    lines = -(-len(panels) // columns)
    each = 0.9 + 0.24 * len(shown)
    width, height = margin + 2.3 * columns + 0.2, lines * each + 0.35
    figure = new_figure(width, height)
    colours = _colours(rows)
    for index, (title, value) in enumerate(panels):
        axes: Any = figure.add_subplot(lines, columns, index + 1)
        values = [value(row) for row in shown]
        places = range(len(shown))
        axes.barh(places, values, 0.72, color=[colours[row.strategy] for row in shown])
        if index == 0:
            _scale_shares(axes, shown)
        else:
            _scale(axes, values)
        _numbers(axes, [row.interval[1] * 100.0 for row in shown] if index == 0 else values, values)
        axes.set_title(title, fontsize=9, color=INK, loc="left")
        axes.set_yticks(places, names if index % columns == 0 else [])
        axes.set_ylim(len(shown) - 0.4, -0.6)
        axes.tick_params(length=0, labelsize=8)
        axes.grid(True, axis="x")
        axes.set_axisbelow(True)
        for side in ("top", "right", "left"):
            axes.spines[side].set_visible(False)
    note = "95 % intervals after Wilson; L: the chain's length."
    if len(shown) < len(rows):
        note += f" The best {len(shown)} of {len(rows)} variants."
    figure.text(0.1 / width, 0.08 / height, note, fontsize=7.5, color=FAINT)
    figure.subplots_adjust(
        margin / width, 0.5 / height, 1.0 - 0.25 / width, 1.0 - 0.3 / height, 0.14, 0.62 / each
    )
    return figure


def _scale_shares(axes: Any, rows: Sequence[Row]) -> None:
    """Draw the intervals of the shares, and leave out what all bars have in common."""
    for place, row in enumerate(rows):
        low, high = row.interval
        axes.plot([100.0 * low, 100.0 * high], [place, place], color=INK, lw=1.2)
    least = min(100.0 * row.interval[0] for row in rows)
    start = 0.0 if least < 70.0 else 10.0 * np.floor(least / 10.0)
    axes.set_xlim(start, 100.0 + 0.25 * (100.0 - start))
    axes.set_xticks([tick for tick in axes.get_xticks() if start <= tick <= 100.0])


def _scale(axes: Any, values: Sequence[float]) -> None:
    """Leave room for the numbers; use a logarithmic scale where values differ by far."""
    positive = [value for value in values if value > 0.0]
    if not positive:
        axes.set_xlim(0.0, 1.0)
        axes.set_xticks([0.0])
    elif max(positive) > 50.0 * min(positive):
        low = 10.0 ** np.floor(np.log10(min(positive)) - 0.3)
        axes.set_xscale("log")
        axes.set_xlim(low, max(positive) * (max(positive) / low) ** 0.35)
        axes.minorticks_off()
    else:
        axes.set_xlim(0.0, 1.28 * max(positive))


def _numbers(axes: Any, places: Sequence[float], values: Sequence[float]) -> None:
    """Write each value behind its bar."""
    low = axes.get_xlim()[0]
    for row, (place, value) in enumerate(zip(places, values, strict=True)):
        known = isfinite(value)
        axes.annotate(
            _short(value) if known else "–",
            (max(place, low) if known else low, row),
            (3.0, 0.0),
            textcoords="offset points",
            va="center",
            fontsize=7.5,
            color=INK if known else FAINT,
        )


def _maps(rows: Sequence[Row], view: View) -> "Figure":
    """One map a variant: the share of the goals in each cell that were reached."""
    shown = best(rows, MOST_MAPS)
    columns = min(len(shown), 4)
    lines = -(-len(shown) // columns)
    size = view.high - view.low
    tall = 2.3 * min(float(size[1] / size[0]), 2.5)
    width, height = 2.45 * columns + 1.3, (tall + 0.5) * lines + 0.5
    figure = new_figure(max(width, 4.5), height)
    extent = (view.low[0], view.high[0], view.low[1], view.high[1])
    coarse = 1 if rows[0].steps else _coarseness(shown)
    image = None
    for index, row in enumerate(shown):
        axes: Any = figure.add_subplot(lines, columns, index + 1)
        goals, reached = (_pooled(layer, coarse) for layer in row.map)
        share = np.divide(100.0 * reached, goals, out=np.full_like(goals, np.nan), where=goals > 0)
        image = axes.imshow(
            share.T, origin="lower", extent=extent, vmin=0.0, vmax=100.0, interpolation="nearest"
        )
        axes.set_facecolor("#eef0f2")
        axes.set_title(fill(row.label, WIDE_TITLE, max_lines=2), fontsize=8, color=INK, pad=3)
        axes.tick_params(length=0, labelsize=7)
        axes.tick_params(labelleft=index % columns == 0, labelbottom=index + columns >= len(shown))
    figure.subplots_adjust(
        0.5 / width, 0.62 / height, 1.0 - 0.95 / width, 1.0 - 0.4 / height, 0.06, 0.45 / tall
    )
    bar_axes: Any = figure.add_axes((1.0 - 0.8 / width, 0.3, 0.12 / width, 0.5))
    bar: Any = figure.colorbar(image, cax=bar_axes)  # type: ignore[arg-type]
    bar.set_label("goals reached in a cell [%]", fontsize=7.5, color=INK)
    bar.ax.tick_params(labelsize=7, length=0)
    first, second = (PLACE[axis] for axis in view.axes)
    note = f"{first} to the right, {second} up [length]; grey: no goals."
    if len(shown) < len(rows):
        note += f" The best {len(shown)} of {len(rows)} variants."
    figure.text(0.1 / width, 0.1 / height, note, fontsize=7.5, color=FAINT)
    return figure


def _coarseness(rows: Sequence[Row]) -> int:
    """How many cells to join along both axes so that most of those with goals have several."""
    for coarse in (1, 2, 3):
        goals = _pooled(rows[0].map[0], coarse)
        if goals[goals > 0].mean() >= SEVERAL:
            return coarse
    return 4


def _pooled(layer: Array, coarse: int) -> Array:
    """Add up squares of cells."""
    wide, tall = (size // coarse for size in layer.shape)
    return np.asarray(layer.reshape(wide, coarse, tall, coarse).sum(axis=(1, 3)))


def _colours(rows: Sequence[Row]) -> dict[str, str]:
    """Give each strategy a colour."""
    names = dict.fromkeys(row.strategy for row in rows)
    return {name: COLOURS[index % len(COLOURS)] for index, name in enumerate(names)}


def _short(value: float) -> str:
    """Write a number in three digits, or all before the point."""
    return f"{value:.0f}" if 1000.0 <= abs(value) < 1e6 else f"{value:.3g}"


def _cut(text: str) -> str:
    return text if len(text) <= WIDE_NAME else f"{text[: WIDE_NAME - 1]}…"
