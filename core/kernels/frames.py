"""Forward kinematics of the working pose: parent frames, world frames, positions (000 §4)."""

from math import inf

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.layout import Body, Options, Pose
from limbik.core.kernels.rotation import (
    copy_vector,
    hpb_to_matrix,
    matrix_to_hpb,
    multiply,
    nearest_form,
    rotate,
    wrap_angle,
)
from limbik.core.kernels.turn import FIXED
from limbik.core.rotation import Array


@entry
def new_pose(n: int) -> Pose:
    """Allocate the working pose of n joints."""
    return Pose(
        np.zeros((n, 3)),
        np.zeros((n, 3, 3)),
        np.zeros((n, 3, 3)),
        np.zeros((n, 3, 3)),
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.zeros(n, np.int64),
        np.zeros(n, np.int64),
        np.zeros(n, np.int64),
        np.zeros((3, n)),
        np.zeros(3),
        np.zeros(3),
        np.zeros(3),
        np.zeros((n, 3)),
        np.zeros((24, 3)),
        np.zeros((3, 3)),
    )


@kernel
def place(joint: int, body: Body, pose: Pose) -> None:
    """Renew position, parent frame and world frame of a joint from the joint before it."""
    offset = pose.vectors[12]
    if joint == 0:
        rotate(body.base_rotation, body.offsets[0], offset)
        multiply(body.base_rotation, body.frozen[0], pose.parent[0])
        for i in range(3):
            pose.positions[0, i] = body.base_position[i] + offset[i]
    else:
        rotate(pose.world[joint - 1], body.offsets[joint], offset)
        multiply(pose.world[joint - 1], body.frozen[joint], pose.parent[joint])
        for i in range(3):
            pose.positions[joint, i] = pose.positions[joint - 1, i] + offset[i]
    multiply(pose.parent[joint], pose.relative[joint], pose.world[joint])


@kernel
def place_from(first: int, body: Body, pose: Pose) -> None:
    """Renew all joints from `first` to the end."""
    for joint in range(first, body.offsets.shape[0]):
        place(joint, body, pose)


@kernel
def renew_angles(joint: int, pose: Pose) -> None:
    """Read a free joint's angles from its matrix, in the form nearest to the old ones."""
    if not pose.free[joint]:
        return
    found = pose.vectors[13]
    matrix_to_hpb(pose.relative[joint], pose.angles[joint, 2], found)
    nearest_form(found, pose.angles[joint])
    copy_vector(found, pose.angles[joint])
    hpb_to_matrix(pose.angles[joint], pose.relative[joint])


@kernel
def mark_limits(pose: Pose) -> None:
    """Note which joints are free of limits now and which can move at all."""
    for joint in range(pose.angles.shape[0]):
        free = 1
        moves = 0
        for i in range(3):
            if pose.low[joint, i] > -inf or pose.high[joint, i] < inf:
                free = 0
            if pose.high[joint, i] - pose.low[joint, i] > FIXED:
                moves = 1
        pose.free[joint] = free
        pose.moves[joint] = moves


@kernel
def add_offsets(joint: int, fk: Array, pose: Pose, options: Options) -> None:
    """Add a joint's FK offsets to its angles within the limits (000 §6.1(4), (6)).

    Args:
        joint: Index.
        fk: FK offsets of all joints, HPB, (n, 3) [rad].
        pose: Changed in place.
        options: Of the solve.
    """
    if fk[joint, 0] == 0.0 and fk[joint, 1] == 0.0 and fk[joint, 2] == 0.0:
        return
    renew_angles(joint, pose)
    for i in range(3):
        angle = pose.angles[joint, i] + fk[joint, i] * options.fk_strength
        if pose.high[joint, i] == inf:
            angle = wrap_angle(angle)
        pose.angles[joint, i] = min(max(angle, pose.low[joint, i]), pose.high[joint, i])
    hpb_to_matrix(pose.angles[joint], pose.relative[joint])
