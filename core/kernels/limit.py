"""Joints' own limits: what a strategy of the slot `limit` allows (M-08).

A joint with one has no ranges of heading, pitch and bank; wherever it is turned, what it is turned
to is pulled inside.
"""

from math import inf, isnan

from limbik.core.jit import kernel, late
from limbik.core.kernels.ease import eased_gap
from limbik.core.kernels.layout import Plugs, Pose
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Matrix,
    Vector,
    angle_between,
    hpb_to_matrix,
    matrix,
    matrix_to_hpb,
    multiply,
    rotate,
    rotation_vector,
    scale,
    store_matrix,
    store_vector,
    transposed,
    turn_by,
    vector,
)
from limbik.core.rotation import Array

TURN, MARGIN = 4, 5  # rows of `Pose.scratch`

TRIES = 4  # sizes of a turn that are tried before a joint is left alone

call_limit = late("limbik.core.callers", "call_limit")


@kernel
def pulled_inside(
    address: int, angles: Vector, params: Array, turn: Array, margin: Array
) -> Vector:
    """Return a joint's angles pulled into its own limit; for finishes too.

    Args:
        address: One of a finish's `limits`, not 0.
        angles: HPB from the joint's zero pose [rad].
        params: The row of `limit_params`, (16,).
        turn: To work in, (3,).
        margin: OUT: the angle that was left, (1,) [rad].

    Returns:
        Allowed angles; those given where they are allowed.
    """
    sign = 1.0 if address > 0 else -1.0
    turn[0], turn[1], turn[2] = sign * angles[0], angles[1], sign * angles[2]
    call_limit(abs(address), turn, params, margin)
    return sign * turn[0], turn[1], sign * turn[2]


@kernel
def load_limits(plugs: Plugs, pose: Pose) -> None:
    """Give a working pose the limits of the solve's joints."""
    for joint in range(plugs.limits.shape[0]):
        pose.limits[joint] = plugs.limits[joint]
        for number in range(plugs.limit_params.shape[1]):
            pose.limit_params[joint, number] = plugs.limit_params[joint, number]


@kernel
def inside(joint: int, angles: Vector, pose: Pose) -> Vector:
    """Return angles pulled into a joint's own limit, which it must have."""
    return pulled_inside(
        pose.limits[joint],
        angles,
        pose.limit_params[joint],
        pose.scratch[TURN],
        pose.scratch[MARGIN],
    )


@kernel
def limits_failed(pose: Pose) -> bool:
    """Return whether a joint with a limit of its own has angles that are no numbers."""
    failed = False
    for joint in range(pose.angles.shape[0]):
        angles = vector(pose.angles, joint)
        if pose.limits[joint] != 0 and isnan(angles[0] + angles[1] + angles[2]):
            failed = True
    return failed


@kernel
def turn_inside(
    joint: int, operating: Vector, target: Vector, wanted: Matrix, zone: float, pose: Pose
) -> bool:
    """Turn a joint as far toward a wanted rotation as its own limit lets it.

    A turn that, pulled inside, leads away from the target is halved a few times, then left out.

    Args:
        joint: Index.
        operating: Unit vector in the joint's frame.
        target: Unit vector in the joint's parent frame, to which the operating vector is to go.
        wanted: Rotation that would bring it nearer.
        zone: Of the limit ease [rad]; 0 = off.
        pose: Changed in place: angles, relative.

    Returns:
        Whether the joint came nearer to the target.
    """
    relative, bank = matrix(pose.relative, joint), pose.angles[joint, 2]
    before = angle_between(rotate(relative, operating), target)
    way = rotation_vector(multiply(wanted, transposed(relative)))
    if zone > 0.0:
        gap = margin(joint, matrix_to_hpb(relative, bank), pose)
        step = gap - margin(joint, matrix_to_hpb(wanted, bank), pose)
        if gap < inf and 0.0 < step < inf:
            way = scale(way, (gap - eased_gap(max(gap, 0.0), step, zone)) / step)
    for _ in range(TRIES):
        turned = multiply(turn_by(way), relative)
        angles = inside(joint, matrix_to_hpb(turned, bank), pose)
        rotation = hpb_to_matrix(angles)
        after = angle_between(rotate(rotation, operating), target)
        if after < before or isnan(after):  # what is no number is kept, to be found and told
            store_vector(angles, pose.angles, joint)
            store_matrix(rotation, pose.relative, joint)
            return before - after > ZERO_TURN
        way = scale(way, 0.5)
    return False


@kernel
def margin(joint: int, angles: Vector, pose: Pose) -> float:
    """Return the angle a joint has left to the end of its own limit [rad]."""
    inside(joint, angles, pose)
    return float(pose.scratch[MARGIN, 0])
