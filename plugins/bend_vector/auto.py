"""Bend vector found from where the aim pose misses the goal.

Source: 000 §6.3(2)(B), (11)(E), §7.6; readings 3D A-20, A-21, A-41.
"""

from collections.abc import Iterable
from math import cos, sin
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.kernels.rotation import (
    angle_between,
    cross,
    dot,
    has_direction,
    norm,
    scale,
    subtract,
    turned,
    unit,
)
from limbik.core.strategy import Degrees, Sided, Strategy

Array = NDArray[np.float64]

SMALLEST_TURN = 1e-6  # [rad] below it nothing counts as detected (000 §7.6)
SMALLEST_SENSITIVITY = 0.001


class Auto(NamedTuple):
    """Parameters of `auto` (000 table 7-19)."""

    angle: Annotated[
        float,
        Field(ge=-360.0, le=360.0, description="default: from the root's Y about its Z [deg]"),
        Degrees,
        Sided,
    ] = 0.0
    sensitivity: Annotated[
        float, Field(ge=0.0, le=10.0, description="shortest miss that counts [length], 0 = off")
    ] = 0.1
    strength: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the turn that is made [-]")
    ] = 0.1


def auto(
    frame: Array,
    aim: Array,
    end_offset: Array,
    to_world: Array,
    bank: float,
    previous: Array,
    params: Auto,
    out: Array,
) -> None:
    """Turn the default vector toward the side where the aimed end misses the goal's line.

    The default is the root's Y axis turned by `angle` about its Z axis. Where the end of the aim
    pose misses the line root→goal by at least the sensitivity, it is turned toward that miss by
    `strength` times the angle between them.
    """
    x, y = sin(params.angle), cos(params.angle)
    default = (
        frame[0, 0] * x + frame[0, 1] * y,
        frame[1, 0] * x + frame[1, 1] * y,
        frame[2, 0] * x + frame[2, 1] * y,
    )
    line = (aim[0], aim[1], aim[2])
    offset = (end_offset[0], end_offset[1], end_offset[2])
    miss = subtract(offset, scale(line, dot(offset, line)))
    found = default
    if 0.0 < params.sensitivity <= norm(miss):
        angle = params.strength * angle_between(default, miss)
        if angle >= SMALLEST_TURN:
            about = unit(cross(default, miss))
            # Opposite: turn about the aim.
            found = turned(default, about if has_direction(about) else line, angle)
    out[0], out[1], out[2] = found


def check(params: Auto) -> None:
    """Refuse a sensitivity between 0 (off) and the smallest one."""
    if 0.0 < params.sensitivity < SMALLEST_SENSITIVITY:
        raise ValueError(
            f"sensitivity is 0 (off) or {SMALLEST_SENSITIVITY} to 10, not {params.sensitivity}"
        )


@hookimpl
def limbik_bend_vectors() -> Iterable[Strategy]:
    """Offer `auto`."""
    text = "Toward the side where the aimed limb misses the goal."
    return [Strategy("auto", auto, Auto, text, check)]
