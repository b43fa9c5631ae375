"""Re-aim after a clamp: our design for the source's unpublished phases (DECISIONS A-33, A-51)."""

from math import atan2, inf, pi, sqrt

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Matrix,
    Trig,
    Vector,
    trig,
    trig_to_matrix,
    wrap_angle,
)

FIXED = 1e-9  # [rad]; a range this narrow is a fixed axis
BLIND = 1e-6  # an axis that moves the operating vector less than this is left alone (3D A-65)
CYCLES = 3  # passes over the free axes
SAME = 1e-15  # [rad]; angles this near have the same sine and cosine


@kernel
def re_aim(
    angles: Vector, low: Vector, high: Vector, operating: Vector, aim: Vector
) -> tuple[Vector, Matrix]:
    """Turn axis after axis to where it brings the operating vector nearest to an aim.

    On one axis the cosine of the angle left is c + a cos x + b sin x, so the best x is
    atan2(b, a) or an end of the range: no step makes the angle larger (3D A-51). Sines and
    cosines follow from a and b, without a call for each.

    Args:
        angles: HPB inside low..high [rad].
        low: [rad], -inf where free.
        high: [rad].
        operating: Unit vector in the joint's frame.
        aim: Unit vector in the joint's parent frame.

    Returns:
        The better angles [rad] and the rotation they make.
    """
    h, p, b = trig(angles[0]), trig(angles[1]), trig(angles[2])
    turns_h, turns_p, turns_b = (
        high[0] - low[0] > FIXED,
        high[1] - low[1] > FIXED,
        high[2] - low[2] > FIXED,
    )
    cycles = CYCLES if int(turns_h) + int(turns_p) + int(turns_b) > 1 else 1
    for _ in range(cycles):
        before = (h[0], p[0], b[0])
        if turns_h:
            u = turn_x(turn_z(operating, b), p)
            h = _best(
                u[0] * aim[0] + u[2] * aim[2], u[0] * aim[2] - u[2] * aim[0], h, low[0], high[0]
            )
        if turns_p or turns_b:
            w = turn_y(aim, opposite(h))
            if turns_p:
                u = turn_z(operating, b)
                p = _best(u[1] * w[1] + u[2] * w[2], u[2] * w[1] - u[1] * w[2], p, low[1], high[1])
            if turns_b:
                w = turn_x(w, opposite(p))
                v = operating
                b = _best(v[0] * w[0] + v[1] * w[1], v[1] * w[0] - v[0] * w[1], b, low[2], high[2])
        if max(abs(h[0] - before[0]), abs(p[0] - before[1]), abs(b[0] - before[2])) < ZERO_TURN:
            break
    return (h[0], p[0], b[0]), trig_to_matrix(h, p, b)


@kernel
def _best(a: float, b: float, current: Trig, low: float, high: float) -> Trig:
    """Return the angle of a range where a cos x + b sin x is largest."""
    square = a * a + b * b
    if square < BLIND * BLIND:
        return current
    best = atan2(b, a)
    found = nearest_in_range(best, current[0], low, high)
    if abs(wrap_angle(found - best)) < SAME:
        radius = sqrt(square)
        return found, b / radius, a / radius
    return trig(found)


@kernel
def nearest_in_range(best: float, current: float, low: float, high: float) -> float:
    """Return the angle of a range that lies nearest to a wanted one on the circle.

    Args:
        best: Wanted angle in (-π, π] [rad].
        current: Angle now [rad]; decides between equals and how a free axis winds.
        low: [rad], -inf when free.
        high: [rad].
    """
    if not high < inf:
        return current + wrap_angle(best - current)
    if low <= best <= high:
        return best
    if best < low and best + 2.0 * pi <= high:
        return best + 2.0 * pi
    to_low = abs(wrap_angle(best - low))
    to_high = abs(wrap_angle(best - high))
    if abs(to_low - to_high) < ZERO_TURN:
        return low if abs(current - low) < abs(current - high) else high
    return low if to_low < to_high else high


@kernel
def opposite(angle: Trig) -> Trig:
    """Return the angle of the turn back."""
    return -angle[0], -angle[1], angle[2]


@kernel
def turn_x(v: Vector, angle: Trig) -> Vector:
    """Return RX(angle) v."""
    _, s, c = angle
    return v[0], c * v[1] + s * v[2], c * v[2] - s * v[1]


@kernel
def turn_y(v: Vector, angle: Trig) -> Vector:
    """Return RY(angle) v."""
    _, s, c = angle
    return c * v[0] - s * v[2], v[1], s * v[0] + c * v[2]


@kernel
def turn_z(v: Vector, angle: Trig) -> Vector:
    """Return RZ(angle) v."""
    _, s, c = angle
    return c * v[0] + s * v[1], c * v[1] - s * v[0], v[2]
