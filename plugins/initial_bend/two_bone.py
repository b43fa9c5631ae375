"""Initial bend as a triangle: one joint is the knee, everything before and after it is straight."""

from collections.abc import Iterable
from math import atan2, pi, sqrt
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.strategy import Strategy

Array = NDArray[np.float64]

ROUNDING = 1e-14  # lengths are over their total


class TwoBone(NamedTuple):
    """Parameters of `two-bone`."""

    joint: Annotated[
        int,
        Field(
            ge=0, le=255, description="the knee, joints from the bend root on; 0 = the middle one"
        ),
    ] = 0


def corner(beside: float, other: float, opposite: float) -> float:
    """Return a triangle's angle between two sides [rad], by half angles: no cancellation.

    Sides that make no triangle give a flat one: angle 0 or π.
    """
    near = max(opposite + other - beside, 0.0) * max(opposite + beside - other, 0.0)
    far = (beside + other + opposite) * max(beside + other - opposite, 0.0)
    if near < ROUNDING and far < ROUNDING:
        return 0.5 * pi  # the goal on the root, equal parts: the limit of small distances
    return 2.0 * atan2(sqrt(near), sqrt(far))


def knee_of(lengths: Array, joint: int) -> int:
    """Return the bone that starts at the knee: as asked, or where the lengths halve best."""
    bones: int = lengths.shape[0]
    if joint > 0:
        return min(joint, bones - 1)
    best, knee, before = 2.0, 1, 0.0
    for bone in range(1, bones):
        before += lengths[bone - 1]
        if abs(before - 0.5) < best - 1e-9:
            best, knee = abs(before - 0.5), bone
    return knee


def two_bone(
    lengths: Array, reach_ratio: float, weights: Array, params: TwoBone, angles: Array
) -> None:
    """Make the triangle of the two straight parts and the line root→goal; then apply the weights.

    With weights of 1 the end is exactly on the goal. Where one part is longer than the other by
    more than the distance, they fold back on each other; a goal out of reach leaves them straight.
    """
    bones = angles.shape[0]
    if bones < 2:
        for bone in range(bones):
            angles[bone] = 0.0
        return
    knee = knee_of(lengths, params.joint)
    before = 0.0
    for bone in range(knee):
        before += lengths[bone]
    after = 1.0 - before
    reach = max(min(reach_ratio, 1.0), abs(before - after))
    first, last = corner(before, reach, after), corner(after, reach, before)
    for bone in range(bones):
        angles[bone] = weights[bone] * (first if bone < knee else -last)


@hookimpl
def limbik_initial_bends() -> Iterable[Strategy]:
    """Offer `two-bone`."""
    text = "A triangle: one joint is the knee, the parts before and after it stay straight."
    return [Strategy("two-bone", two_bone, TwoBone, text)]
