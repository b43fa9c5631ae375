"""The mix of a solved pose with the FK pose (000 §6.1(5); 3D A-45)."""

from math import inf

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Body, Pose
from limbik.core.kernels.rotation import (
    Vector,
    add,
    clamp,
    near,
    nearest_form,
    scale,
    vector,
    wrap_angle,
)
from limbik.core.rotation import Array


@kernel
def mixed(joint: int, angles: Vector, mix: float, body: Body, fk: Array, pose: Pose) -> Vector:
    """Return a joint's angles mixed with those of the FK pose, within its limits.

    Nearest forms are mixed: a free joint's second HPB form counts, and an axis without limits
    goes the short way round, so that 170° and -170° meet at 180°.

    Args:
        joint: Index.
        angles: Solved, HPB [rad].
        mix: 0 = solved, 1 = FK.
        body: The chain.
        fk: FK offsets of all joints, HPB, (n, 3) [rad].
        pose: Says which joints are free.
    """
    posed = add(vector(body.rest, joint), vector(fk, joint))
    if pose.free[joint]:
        posed = nearest_form(posed, angles)
    else:
        posed = _near_free(posed, angles, vector(body.high, joint))
    between = add(scale(angles, 1.0 - mix), scale(posed, mix))
    return (
        clamp(between[0], body.low[joint, 0], body.high[joint, 0]),
        clamp(between[1], body.low[joint, 1], body.high[joint, 1]),
        clamp(between[2], body.low[joint, 2], body.high[joint, 2]),
    )


@kernel
def _near_free(angles: Vector, reference: Vector, high: Vector) -> Vector:
    """Return angles with those of axes without limits moved by whole turns to a reference."""
    close = near(angles, reference)
    return (
        angles[0] if high[0] < inf else close[0],
        angles[1] if high[1] < inf else close[1],
        angles[2] if high[2] < inf else close[2],
    )


@kernel
def wrap_free(angles: Vector, high: Vector) -> Vector:
    """Return angles [rad] with those of axes without limits wrapped into ±180°."""
    return (
        angles[0] if high[0] < inf else wrap_angle(angles[0]),
        angles[1] if high[1] < inf else wrap_angle(angles[1]),
        angles[2] if high[2] < inf else wrap_angle(angles[2]),
    )
