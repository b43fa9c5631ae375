"""Bend vector at an angle from the bend root's Y axis (000 §6.3(2)(A), §7.6; 3D A-19)."""

from collections.abc import Iterable
from math import cos, sin
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.strategy import Degrees, Sided, Strategy

Array = NDArray[np.float64]


class Manual(NamedTuple):
    """Parameters of `manual`."""

    angle: Annotated[
        float,
        Field(ge=-360.0, le=360.0, description="from the root's Y axis about its Z axis [deg]"),
        Degrees,
        Sided,
    ] = 0.0
    exclude_bank: Annotated[
        bool, Field(description="leave out the bank the root takes in the aim pose")
    ] = False


def manual(
    frame: Array,
    aim: Array,
    end_offset: Array,
    to_world: Array,
    bank: float,
    previous: Array,
    params: Manual,
    out: Array,
) -> None:
    """Turn the root's Y axis about its Z axis: frame RZ(-bank, if excluded) RZ(angle) Y."""
    angle = params.angle - (bank if params.exclude_bank else 0.0)
    x, y = sin(angle), cos(angle)
    for axis in range(3):
        out[axis] = frame[axis, 0] * x + frame[axis, 1] * y


@hookimpl
def limbik_bend_vectors() -> Iterable[Strategy]:
    """Offer `manual`."""
    return [Strategy("manual", manual, Manual, "At an angle from the bend root's Y axis.")]
