"""Colours and sizes of the viewer; the page lets people change the colours of the lines."""

from typing import Final

Colour = tuple[int, int, int]

BONE: Final[Colour] = (70, 130, 210)
JOINT: Final[Colour] = (245, 247, 250)
BLOCKING: Final[Colour] = (214, 34, 70)
OTHER: Final[Colour] = (233, 152, 42)  # the solver compared with
REST: Final[Colour] = (176, 186, 197)  # what of a body no chain moves
GOAL: Final[Colour] = (0, 135, 90)
PLANE: Final[Colour] = (130, 80, 196)
CONE: Final[Colour] = (214, 34, 70)
TRIAD: Final[tuple[Colour, ...]] = ((214, 60, 60), (60, 160, 70), (60, 90, 220))
ARCS: Final[dict[str, Colour]] = {
    "heading": (226, 134, 28),
    "pitch": (0, 150, 136),
    "bank": (150, 90, 210),
    "planar": (0, 150, 136),
    "own": (226, 134, 28),
}
LINES: Final[dict[str, Colour]] = {
    "handle": (90, 100, 112),
    "IK component": (86, 180, 233),
    "FK component": (201, 86, 170),
    "pole": PLANE,
    "bend direction": (230, 159, 0),
}
"""Lines people can switch and colour (C-14, D-09, E-12)."""

SHOWN_AT_FIRST: Final = ("handle", "pole", "bend direction")
