"""What became of the goal, in words on the page."""

from html import escape

import numpy as np

from limbik.core.solution import Status
from limbik.plugins.output.records import outcome
from limbik.plugins.viewer.looks import BLOCKING, GOAL, Colour
from limbik.plugins.viewer.session import LAST, Shown

_ROW = '<div style="font-size:0.86em;line-height:1.45;padding:0.1em 0.9em">{}</div>'
_STRONG = '<b style="color:rgb{}">{}</b>'


def status_html(rows: list[tuple[str, Shown]], error: str) -> str:
    """Write a line for each pose, and what was refused last.

    Args:
        rows: Names and what they show.
        error: Empty for none.
    """
    texts = [_line(name, shown) for name, shown in rows]
    if error:
        texts.append(_STRONG.format(BLOCKING, escape(error)))
    return "".join(_ROW.format(text) for text in texts)


def _line(name: str, shown: Shown) -> str:
    solution = shown.solution
    if not shown.setup.settings.ik:
        text = _STRONG.format(BLOCKING, "FK only")
    else:
        good = solution.status == Status.REACHED
        colour: Colour = GOAL if good else BLOCKING
        text = _STRONG.format(colour, escape(outcome(solution)))
    parts = [f"{escape(name)}: {text}", f"distance {float(solution.distance):.3g}"]
    if int(solution.iterations) > 0:
        parts.append(f"{solution.iterations} rounds")
    if shown.stage != LAST:
        parts.append(f"seen: {escape(shown.stages[shown.stage])}")
    limits = solution.limits_touched()
    if limits:
        parts.append("at a limit: " + escape(", ".join(limits)))
    return " · ".join(parts)


def angles_markdown(shown: Shown) -> str:
    """Write the joint angles of what is seen as a table [deg]."""
    rows = ["| joint | heading | pitch | bank |", "|:--|--:|--:|--:|"]
    for name, angles in zip(shown.solution.chain.names, shown.angles, strict=True):
        numbers = " | ".join(f"{number:.1f}" for number in np.degrees(angles))
        rows.append(f"| {name} | {numbers} |")
    return "\n".join(rows)
