"""A swing-twist cone: how far a bone may swing out, and how far it may twist about itself (M-08).

A turn is a twist about the joint's Z axis, then the shortest swing that carries Z to where the bone
points: the swing vector (axis times angle) lies in the XY plane of the zero pose. The cone bounds
it by an ellipse and the twist by a range; `frozen` turns the cone to where it belongs.
"""

from collections.abc import Iterable
from math import atan2, cos, hypot, inf, pi, sin, sqrt
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.jit import kernel
from limbik.core.kernels.re_aim import nearest_in_range
from limbik.core.kernels.rotation import (
    Matrix,
    clamp,
    hpb_to_matrix,
    matrix_to_hpb,
    multiply,
    transposed,
    turn_by,
)
from limbik.core.strategy import Degrees, Strategy

Array = NDArray[np.float64]

ROUNDING = 1e-12  # [rad]; what is outside by less is on the limit
NARROW = 1e-9  # [rad]; a swing this small is none
FULL_TURN = 2.0 * pi - 1e-9  # [rad]; a twist range this wide is no limit
TINY = 1e-16  # share of a number that is lost in its rounding
BEHIND = -0.9  # cosine of a swing this wide
ROUNDS = 60  # most steps to the nearest point of an ellipse, where five are common


class Cone(NamedTuple):
    """Parameters of the cone."""

    swing: Annotated[
        tuple[float, float],
        Field(description="largest tilt about the joint's X and about its Y, 0..180 [deg]"),
        Degrees,
    ]
    twist: Annotated[
        tuple[float, float],
        Field(description="range of the turn about the bone, in the sense of bank [deg]"),
        Degrees,
    ] = (-180.0, 180.0)


def check(params: Cone) -> None:
    """Raise ValueError where the angles [deg] are no cone."""
    if not all(0.0 <= angle <= 180.0 for angle in params.swing):
        raise ValueError("both angles of swing must be 0 to 180")
    low, high = params.twist
    if not -180.0 <= low <= high <= 180.0:
        raise ValueError("twist must be [minimum, maximum] between -180 and 180")


def cone(angles: Array, params: Cone, margin: Array) -> None:
    """Pull a turn into the cone: the swing to the nearest point of the ellipse, then the twist."""
    turn = hpb_to_matrix((angles[0], angles[1], angles[2]))
    x, y = _swing(turn)
    bank = _twist(turn, x, y)
    wide, narrow = params.swing
    inner_x, inner_y, left = _in_ellipse(wide, narrow, x, y)
    low, high = params.twist
    inner_bank = bank
    if high - low < FULL_TURN:
        # By whole turns to where the range is: 180° may be its end at -180°.
        if bank - high > low - (bank - 2.0 * pi):
            bank -= 2.0 * pi
        elif low - bank > (bank + 2.0 * pi) - high:
            bank += 2.0 * pi
        inner_bank = nearest_in_range(bank, bank, low, high)
        past = abs(inner_bank - bank)
        if past > ROUNDING:
            left = min(left, -past)
        elif high - low > NARROW:
            left = min(left, bank - low, high - bank)
    margin[0] = left
    off = max(abs(inner_x - x), abs(inner_y - y), abs(inner_bank - bank))
    if off <= ROUNDING:
        return
    c, s = cos(inner_bank), sin(inner_bank)
    twisted = (c, s, 0.0), (-s, c, 0.0), (0.0, 0.0, 1.0)
    inner = multiply(turn_by((inner_x, inner_y, 0.0)), twisted)
    angles[0], angles[1], angles[2] = matrix_to_hpb(inner, angles[2])


@kernel
def _swing(turn: Matrix) -> tuple[float, float]:
    """Return the swing vector of a turn [rad]; exactly behind, about X."""
    x, y, z = turn[0][2], turn[1][2], turn[2][2]
    level = hypot(x, y)
    angle = atan2(level, z)
    if level < 1e-300:
        return angle, 0.0
    return -y / level * angle, x / level * angle


@kernel
def _twist(turn: Matrix, x: float, y: float) -> float:
    """Return the twist that is left of a turn without its swing [rad].

    The swing cancels out of what the twist is read from, unless the bone points nearly behind.
    """
    if turn[2][2] > BEHIND:
        return atan2(turn[0][1] - turn[1][0], turn[0][0] + turn[1][1])
    rest = multiply(transposed(turn_by((x, y, 0.0))), turn)
    return atan2(rest[0][1] - rest[1][0], rest[0][0] + rest[1][1])


@kernel
def _in_ellipse(a: float, b: float, x: float, y: float) -> tuple[float, float, float]:
    """Return the point of an ellipse's inside nearest to a swing, and the distance to its rim.

    Args:
        a: Half axis along x [rad].
        b: Half axis along y [rad].
        x: [rad]
        y: [rad]

    Returns:
        The point, and the distance, negative outside; inf where nothing limits the swing.
    """
    if a < NARROW or b < NARROW:
        # A hinge, or no swing at all: the ellipse is a line.
        left = inf
        if a >= NARROW:
            left = a - abs(x)
        elif b >= NARROW:
            left = b - abs(y)
        off = hypot(x - clamp(x, -a, a), y - clamp(y, -b, b))
        return clamp(x, -a, a), clamp(y, -b, b), -off if off > ROUNDING else left
    if a >= pi and b >= pi:
        return x, y, inf
    if a == b:
        size = hypot(x, y)
        share = min(a / size, 1.0) if size > 0.0 else 1.0
        return x * share, y * share, a - size
    if a > b:
        rim_x, rim_y = _rim(a, b, abs(x), abs(y))
    else:
        rim_y, rim_x = _rim(b, a, abs(y), abs(x))
    rim_x, rim_y = rim_x if x >= 0.0 else -rim_x, rim_y if y >= 0.0 else -rim_y
    left = hypot(rim_x - x, rim_y - y)
    if (x / a) ** 2 + (y / b) ** 2 <= 1.0:
        return x, y, left
    return rim_x, rim_y, -left


@kernel
def _rim(a: float, b: float, x: float, y: float) -> tuple[float, float]:
    """Return the point of an ellipse's rim nearest to a point, both in the first quadrant.

    The normal through the rim's point meets the given one; its parameter is the root of a falling
    convex function (Eberly, Distance from a Point to an Ellipse), to which Newton's steps lead from
    below without ever passing it.

    Args:
        a: The longer half axis, along x.
        b: The shorter half axis.
        x: At least 0.
        y: At least 0.
    """
    if not y > 0.0:
        if a * x < a * a - b * b:
            share = a * x / (a * a - b * b)
            return a * share, b * sqrt(max(1.0 - share * share, 0.0))
        return a, 0.0
    if not x > 0.0:
        return 0.0, b
    ratio = (a / b) ** 2
    u, v = x / a, y / b
    root = max(v, ratio * u - ratio + 1.0)  # either term alone is at most 1 at the root
    for _ in range(ROUNDS):
        along, across = root + ratio - 1.0, v / root
        first, second = (ratio * u / along) ** 2, across * across
        step = 0.5 * (first + second - 1.0) / (first / along + second / root)
        if not step > TINY * root:
            break
        root += step
    return ratio * x / (root + ratio - 1.0), y / root


@hookimpl
def limbik_limits() -> Iterable[Strategy]:
    """Offer `cone`."""
    return [Strategy("cone", cone, Cone, "Swing in an elliptic cone, twist in a range.", check)]
