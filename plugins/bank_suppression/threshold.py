"""Drop the bank of a joint that points almost at the goal or the end.

Source: 000 §6.3(11)(G), (H), (L), §7.6; reading 3D A-35.
"""

from collections.abc import Iterable
from math import sin
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.strategy import Degrees, Strategy

Array = NDArray[np.float64]


class Threshold(NamedTuple):
    """Parameters of `threshold`."""

    angle: Annotated[
        float,
        Field(ge=0.0, le=2.0, description="from the joint's Z axis, below it bank drops [deg]"),
        Degrees,
    ] = 1.0
    heading_correction: Annotated[
        bool, Field(description="give the share of the dropped bank to the heading")
    ] = False
    all_stages: Annotated[bool, Field(description="in the stages before CCD too")] = False


def is_near_z(unit: Array, rim: float) -> bool:
    """Whether a unit vector (3,) lies in the cone about Z with this sine of its half angle."""
    return bool(unit[2] > 0.0 and unit[0] * unit[0] + unit[1] * unit[1] < rim * rim)


def threshold(
    target: Array, current: Array, pitch: float, in_ccd: int, params: Threshold, delta: Array
) -> None:
    """Set the bank's change to 0 where a small turn would be made of large angles.

    With heading correction the heading takes sin(pitch) times the dropped bank: at a pitch of
    ±90° both turn about the same axis.
    """
    if in_ccd == 0 and not params.all_stages:
        return
    rim = sin(params.angle)
    if is_near_z(target, rim) or is_near_z(current, rim):
        dropped = delta[2]
        delta[2] = 0.0
        if params.heading_correction:
            delta[0] += sin(pitch) * dropped


@hookimpl
def limbik_bank_suppressions() -> Iterable[Strategy]:
    """Offer `threshold`."""
    text = "Drop the bank of joints that point almost at the goal or the end."
    return [Strategy("threshold", threshold, Threshold, text)]
