"""Pictures of a run: bars that compare the variants, and maps of where goals were reached."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BytesIO
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.plugins.experiments.summary import AXES, CELLS, Row, Summary
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.output.compare import COLOURS
from limbik.plugins.output.plot import FAINT, INK, LOOK, PAPER

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_BARS = 40
MOST_MAPS = 12
WIDE_NAME = 34  # characters


@dataclass(frozen=True)
class Picture:
    """A picture with its name.

    Attributes:
        name: File name without ending.
        title: What it shows.
        content: Bytes of a PNG file.
    """

    name: str
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
            drawn.append(Picture(name, f"{chain}, {goals}: variants", _png(figure)))
            if not solved[0].is_path:
                figure = _maps(solved, *summary.views[chain])
                title = f"{chain}, {goals}: where goals were reached"
                drawn.append(Picture(f"{name}-map", title, _png(figure)))
    return drawn


def _png(figure: "Figure") -> bytes:
    content = BytesIO()
    figure.savefig(content, format="png", dpi=120)
    return content.getvalue()


def _canvas(width: float, height: float) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def best(rows: Sequence[Row], most: int) -> list[Row]:
    """Return so many rows, in their order: those with the most goals reached, then the nearest."""
    ranked = sorted(rows, key=lambda row: (-row.share, row.miss[1], row.time))
    kept = {id(row) for row in ranked[:most]}
    return [row for row in rows if id(row) in kept]


def _bars(rows: Sequence[Row], metrics: Sequence[str]) -> "Figure":
    """One bar a variant in one panel for each number; what is longer is never better but once."""
    shown = best(rows, MOST_BARS)
    panels: list[tuple[str, Callable[[Row], float]]] = [
        ("reached [%]", lambda row: 100.0 * row.share),
        ("miss, 95 % are nearer [% L]", lambda row: row.miss[1]),
        ("time of a solve [µs]", lambda row: row.time),
    ]
    for name in metrics:
        unit = f" [{BY_NAME[name].unit}]" if name in BY_NAME and BY_NAME[name].unit else ""
        if any(isfinite(row.metric(name)) for row in shown):
            panels.append((f"{name}{unit}", lambda row, name=name: row.metric(name)))  # type: ignore[misc]
    names = [_cut(row.label) for row in shown]
    margin = 0.3 + 0.068 * max(map(len, names))
    columns = min(len(panels), 4)
    lines = -(-len(panels) // columns)
    each = 0.9 + 0.24 * len(shown)
    width, height = margin + 2.3 * columns + 0.2, lines * each + 0.35
    figure = _canvas(width, height)
    colours = _colours(rows)
    for index, (title, value) in enumerate(panels):
        axes: Any = figure.add_subplot(lines, columns, index + 1)
        values = [value(row) for row in shown]
        places = range(len(shown))
        axes.barh(places, values, 0.72, color=[colours[row.strategy] for row in shown])
        if index == 0:
            _whiskers(axes, shown)
        _numbers(axes, values, log=index == 1)
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


def _whiskers(axes: Any, rows: Sequence[Row]) -> None:
    """Draw the intervals of the shares, and leave out what all bars have in common."""
    for place, row in enumerate(rows):
        low, high = row.interval
        axes.plot([100.0 * low, 100.0 * high], [place, place], color=INK, lw=1.2)
    least = min(100.0 * row.interval[0] for row in rows)
    axes.set_xlim(0.0 if least < 70.0 else 10.0 * np.floor(least / 10.0), 100.6)


def _numbers(axes: Any, values: Sequence[float], log: bool) -> None:
    """Use a logarithmic scale where values differ by far, and write each value at its bar."""
    positive = [value for value in values if value > 0.0]
    if log and positive and max(positive) > 50.0 * min(positive):
        axes.set_xscale("log")
        axes.set_xlim(10.0 ** np.floor(np.log10(min(positive)) - 0.3), max(positive) * 20.0)
    elif axes.get_xlim()[0] == 0.0 and positive and max(positive) <= axes.get_xlim()[1]:
        axes.set_xlim(0.0, 1.28 * max(positive))
    low, high = axes.get_xlim()
    for place, value in enumerate(values):
        if not isfinite(value):
            axes.text(low, place, " –", va="center", fontsize=7.5, color=FAINT)
            continue
        inside = value > low + 0.82 * (high - low) and axes.get_xscale() == "linear"
        axes.annotate(
            f"{value:.3g}",
            (max(value, low), place),
            (-3.0 if inside else 3.0, 0.0),
            textcoords="offset points",
            ha="right" if inside else "left",
            va="center",
            fontsize=7.5,
            color=PAPER if inside else INK,
        )


def _maps(rows: Sequence[Row], order: tuple[int, int], low: Any, high: Any) -> "Figure":
    """One map a variant: the share of the goals in each cell that were reached."""
    shown = best(rows, MOST_MAPS)
    columns = min(len(shown), 4)
    lines = -(-len(shown) // columns)
    width, height = 2.5 * columns + 1.3, 2.75 * lines + 0.7
    figure = _canvas(width, height)
    extent = (low[0], high[0], low[1], high[1])
    image = None
    for index, row in enumerate(shown):
        axes: Any = figure.add_subplot(lines, columns, index + 1)
        with np.errstate(invalid="ignore"):
            share = np.where(row.map[0] > 0, 100.0 * row.map[1] / row.map[0], np.nan)
        if 4 * np.isfinite(share).sum() < CELLS * CELLS and row.count < CELLS * CELLS // 2:
            axes.set_facecolor("#f7f8f9")
        image = axes.imshow(
            share.T,
            origin="lower",
            extent=extent,
            cmap="RdYlBu",
            vmin=0.0,
            vmax=100.0,
            interpolation="nearest",
        )
        axes.set_title(_cut(row.label), fontsize=8.5, color=INK)
        axes.tick_params(length=0, labelsize=7)
        if index % columns:
            axes.set_yticklabels([])
        if index + columns < len(shown):
            axes.set_xticklabels([])
    bar = figure.colorbar(image, ax=figure.axes, shrink=0.8, pad=0.02)  # type: ignore[arg-type]
    bar.set_label("goals reached in a cell [%]", fontsize=8)
    bar.ax.tick_params(labelsize=7)
    note = (
        f"{AXES[order[0]]} to the right, {AXES[order[1]]} up [length]; no colour: no goals there."
    )
    if len(shown) < len(rows):
        note += f" The best {len(shown)} of {len(rows)} variants."
    figure.text(0.02, 0.1 / height, note, fontsize=7.5, color=FAINT)
    return figure


def _colours(rows: Sequence[Row]) -> dict[str, str]:
    """Give each strategy a colour."""
    names = dict.fromkeys(row.strategy for row in rows)
    return {name: COLOURS[index % len(COLOURS)] for index, name in enumerate(names)}


def _cut(text: str) -> str:
    return text if len(text) <= WIDE_NAME else f"{text[: WIDE_NAME - 1]}…"
