"""Drop the bank of a joint that points almost at the goal or the end.

Source: 000 §6.3(11)(G), (H), (L), §7.6; reading 3D A-35.
"""

from collections.abc import Iterable
from math import atan2, sin, sqrt
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


def angle_to_z(vector: Array) -> float:
    """Angle of a vector (3,) from the Z axis [rad]."""
    return atan2(sqrt(vector[0] * vector[0] + vector[1] * vector[1]), vector[2])


def threshold(
    target: Array, current: Array, pitch: float, in_ccd: int, params: Threshold, delta: Array
) -> None:
    """Set the bank's change to 0 where a small turn would be made of large angles.

    With heading correction the heading takes sin(pitch) times the dropped bank: at a pitch of
    ±90° both turn about the same axis.
    """
    if in_ccd == 0 and not params.all_stages:
        return
    if angle_to_z(target) < params.angle or angle_to_z(current) < params.angle:
        dropped = delta[2]
        delta[2] = 0.0
        if params.heading_correction:
            delta[0] += sin(pitch) * dropped


@hookimpl
def limbik_bank_suppressions() -> Iterable[Strategy]:
    """Offer `threshold`."""
    text = "Drop the bank of joints that point almost at the goal or the end."
    return [Strategy("threshold", threshold, Threshold, text)]
