"""The end joint takes over the goal's orientation, by a share and within its limits (M-05).

Turning the end moves no position, so this is the last step of a solve and cannot undo the others.
"""

from math import atan2, inf

from limbik.core.jit import kernel
from limbik.core.kernels.frames import place, set_angles
from limbik.core.kernels.layout import Body, Pose
from limbik.core.kernels.re_aim import nearest_in_range
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Matrix,
    Vector,
    dot,
    hpb_to_matrix,
    matrix,
    matrix_to_hpb,
    multiply,
    near,
    nearest_form,
    other_form,
    rotation_vector,
    scale,
    transposed,
    turn_by,
    vector,
    wrap_angle,
)

CYCLES = 50  # most passes over the axes of an end whose limits cut the orientation
ROUNDING = 1e-12  # [rad]
EQUAL = 1e-12  # difference of traces that is rounding


@kernel
def orient_end(turn: Vector, share: float, body: Body, pose: Pose) -> None:
    """Turn the end joint toward an orientation as far as its limits let it.

    Args:
        turn: Orientation of the goal in the world, HPB [rad].
        share: How much of the way to it, 0..1.
        body: The chain.
        pose: After the finish; its end joint is changed.
    """
    last = body.offsets.shape[0] - 1
    place(last, body, pose)
    parent = matrix(pose.parent, last)
    target = multiply(transposed(parent), hpb_to_matrix(turn))
    if share < 1.0:
        now = matrix(pose.relative, last)
        way = rotation_vector(multiply(target, transposed(now)))
        target = multiply(turn_by(scale(way, share)), now)
    before = vector(pose.angles, last)
    low, high = vector(body.low, last), vector(body.high, last)
    set_angles(last, nearest_turn(target, before, low, high), pose)
    place(last, body, pose)


@kernel
def nearest_turn(target: Matrix, before: Vector, low: Vector, high: Vector) -> Vector:
    """Return the angles inside limits whose rotation is nearest to a wanted one.

    Where neither form of the wanted angles fits, axis after axis is turned to its best: the trace
    of targetᵀ · rotation, which grows as the angle left falls, is c + a cos x + b sin x on one
    axis. It is done from both forms and from all corners of the limits, since one start may end on
    the wrong side of a limit.

    Args:
        target: In the joint's parent frame.
        before: Angles now, HPB [rad]; decide between equals.
        low: [rad], -inf where free.
        high: [rad], inf where free.
    """
    wanted = nearest_form(matrix_to_hpb(target, before[2]), before)
    first = _inside(wanted, low, high)
    if _apart(first, wanted) < ROUNDING:
        return first
    second = _inside(near(other_form(wanted), before), low, high)
    if _apart(second, near(other_form(wanted), before)) < ROUNDING:
        return second
    best = _improved(first, target, low, high)
    for start in range(9):
        angles = second if start == 8 else _corner(start, first, low, high)
        tried = _improved(angles, target, low, high)
        if _agreement(tried, target) > _agreement(best, target) + EQUAL:
            best = tried
    return best


@kernel
def _inside(angles: Vector, low: Vector, high: Vector) -> Vector:
    """Return angles pulled into limits, each to the end nearest on the circle."""
    return (
        nearest_in_range(wrap_angle(angles[0]), angles[0], low[0], high[0]),
        nearest_in_range(wrap_angle(angles[1]), angles[1], low[1], high[1]),
        nearest_in_range(wrap_angle(angles[2]), angles[2], low[2], high[2]),
    )


@kernel
def _corner(which: int, angles: Vector, low: Vector, high: Vector) -> Vector:
    """Return angles with those of limited axes at a corner of their ranges, 0..7."""
    return (
        angles[0] if not high[0] < inf else (high[0] if which & 1 else low[0]),
        angles[1] if not high[1] < inf else (high[1] if which & 2 else low[1]),
        angles[2] if not high[2] < inf else (high[2] if which & 4 else low[2]),
    )


@kernel
def _apart(first: Vector, second: Vector) -> float:
    """Return the largest difference of two triples of angles, whole turns left out [rad]."""
    return max(
        abs(wrap_angle(first[0] - second[0])),
        abs(wrap_angle(first[1] - second[1])),
        abs(wrap_angle(first[2] - second[2])),
    )


@kernel
def _agreement(angles: Vector, target: Matrix) -> float:
    """Return the trace of targetᵀ · rotation: 3 where they are the same, -1 a half turn apart."""
    found = hpb_to_matrix(angles)
    return dot(found[0], target[0]) + dot(found[1], target[1]) + dot(found[2], target[2])


@kernel
def _improved(angles: Vector, target: Matrix, low: Vector, high: Vector) -> Vector:
    """Turn axis after axis of limited angles to where the rotation agrees best with a target."""
    h, p, b = angles
    back = transposed(target)
    for _ in range(CYCLES):
        before = (h, p, b)
        m = multiply(multiply(turn_matrix(1, p), turn_matrix(2, b)), back)
        h = _best(m[0][0] + m[2][2], m[0][2] - m[2][0], h, low[0], high[0])
        m = multiply(multiply(turn_matrix(2, b), back), turn_matrix(0, h))
        p = _best(m[1][1] + m[2][2], m[2][1] - m[1][2], p, low[1], high[1])
        m = multiply(multiply(back, turn_matrix(0, h)), turn_matrix(1, p))
        b = _best(m[0][0] + m[1][1], m[1][0] - m[0][1], b, low[2], high[2])
        if max(abs(h - before[0]), abs(p - before[1]), abs(b - before[2])) < ZERO_TURN:
            break
    return h, p, b


@kernel
def turn_matrix(axis: int, angle: float) -> Matrix:
    """Return RY, RX or RZ of an angle: axis 0, 1, 2 for heading, pitch, bank."""
    return hpb_to_matrix(
        (
            angle if axis == 0 else 0.0,
            angle if axis == 1 else 0.0,
            angle if axis == 2 else 0.0,
        )
    )


@kernel
def _best(a: float, b: float, current: float, low: float, high: float) -> float:
    """Return the angle of a range where a cos x + b sin x is largest [rad]."""
    if a * a + b * b < EQUAL:
        return current
    return nearest_in_range(atan2(b, a), current, low, high)
