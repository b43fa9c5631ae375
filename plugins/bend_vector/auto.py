"""Bend vector found from where the aim pose misses the goal.

Source: 000 §6.3(2)(B), (11)(E), §7.6; readings 3D A-20, A-21, A-41.
"""

from collections.abc import Iterable
from math import atan2, cos, sin, sqrt
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.strategy import Degrees, Strategy

Array = NDArray[np.float64]

SMALLEST_TURN = 1e-6  # [rad] below it nothing counts as detected (000 §7.6)
SMALLEST_SENSITIVITY = 0.001


class Auto(NamedTuple):
    """Parameters of `auto` (000 table 7-19)."""

    angle: Annotated[
        float,
        Field(ge=-360.0, le=360.0, description="default: from the root's Y about its Z [deg]"),
        Degrees,
    ] = 0.0
    sensitivity: Annotated[
        float, Field(ge=0.0, le=10.0, description="shortest miss that counts [length], 0 = off")
    ] = 0.1
    strength: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the turn that is made [-]")
    ] = 0.1


def side_of_miss(aim: Array, end_offset: Array, side: Array) -> float:
    """Write the part of the offset across the aim, as a unit vector.

    Returns:
        The length of that part [length]; where it is 0, `side` is left alone.
    """
    along = end_offset[0] * aim[0] + end_offset[1] * aim[1] + end_offset[2] * aim[2]
    x = end_offset[0] - along * aim[0]
    y = end_offset[1] - along * aim[1]
    z = end_offset[2] - along * aim[2]
    length = sqrt(x * x + y * y + z * z)
    if length > 0.0:
        side[0], side[1], side[2] = x / length, y / length, z / length
    return length


def turn_toward(start: Array, goal: Array, strength: float, spare_axis: Array) -> None:
    """Turn the unit vector `start` in place toward `goal`, by a share of the angle between them.

    `spare_axis` is turned about where the two are opposite.
    """
    x = start[1] * goal[2] - start[2] * goal[1]
    y = start[2] * goal[0] - start[0] * goal[2]
    z = start[0] * goal[1] - start[1] * goal[0]
    sine = sqrt(x * x + y * y + z * z)
    turn = strength * atan2(sine, start[0] * goal[0] + start[1] * goal[1] + start[2] * goal[2])
    if turn < SMALLEST_TURN:
        return
    if sine > 1e-12:
        x, y, z = x / sine, y / sine, z / sine
    else:
        x, y, z = spare_axis[0], spare_axis[1], spare_axis[2]
    a, b, c = start[0], start[1], start[2]
    start[0] = cos(turn) * a + sin(turn) * (y * c - z * b)
    start[1] = cos(turn) * b + sin(turn) * (z * a - x * c)
    start[2] = cos(turn) * c + sin(turn) * (x * b - y * a)


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
    for axis in range(3):
        out[axis] = frame[axis, 0] * x + frame[axis, 1] * y
    if params.sensitivity <= 0.0:
        return
    side = np.zeros(3)
    if side_of_miss(aim, end_offset, side) >= params.sensitivity:
        turn_toward(out, side, params.strength, aim)


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
