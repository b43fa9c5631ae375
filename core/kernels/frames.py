"""Forward kinematics of the working pose: parent frames, world frames, positions (000 §4)."""

from math import inf

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.layout import Body, Options, Pose
from limbik.core.kernels.limit import pulled_inside
from limbik.core.kernels.own import LIMIT, WIDTH
from limbik.core.kernels.re_aim import FIXED
from limbik.core.kernels.rotation import (
    Vector,
    add,
    clamp,
    clamp_vector,
    hpb_to_matrix,
    matrix,
    matrix_to_hpb,
    multiply,
    nearest_form,
    norm,
    rotate,
    store_matrix,
    store_vector,
    subtract,
    vector,
    wrap_angle,
)
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
        np.zeros(n, np.int64),
        np.zeros((3, n)),
        np.zeros((n, 3)),
        np.zeros((n, WIDTH)),
        np.zeros((8, 3)),
        np.zeros((n, 72)),
        np.zeros(2),
    )


@kernel
def base_rotation(body: Body) -> tuple[Vector, Vector, Vector]:
    """Return the axes of the IK space in the world."""
    return (
        vector(body.base_rotation, 0),
        vector(body.base_rotation, 1),
        vector(body.base_rotation, 2),
    )


@kernel
def place(joint: int, body: Body, pose: Pose) -> None:
    """Renew position, parent frame and world frame of a joint from the joint before it."""
    offset, frozen = vector(body.offsets, joint), matrix(body.frozen, joint)
    if joint == 0:
        frame = base_rotation(body)
        origin = (body.base_position[0], body.base_position[1], body.base_position[2])
    else:
        frame = matrix(pose.world, joint - 1)
        origin = vector(pose.positions, joint - 1)
    parent = multiply(frame, frozen)
    store_vector(add(origin, rotate(frame, offset)), pose.positions, joint)
    store_matrix(parent, pose.parent, joint)
    store_matrix(multiply(parent, matrix(pose.relative, joint)), pose.world, joint)


@kernel
def place_from(first: int, body: Body, pose: Pose) -> None:
    """Renew all joints from `first` to the end."""
    for joint in range(first, body.offsets.shape[0]):
        place(joint, body, pose)


@kernel
def set_angles(joint: int, angles: Vector, pose: Pose) -> None:
    """Give a joint angles [rad], pulled into its own limit, and the rotation they make."""
    if pose.own[joint, LIMIT] != 0.0:
        angles = pulled_inside(angles, pose.own[joint])
    store_vector(angles, pose.angles, joint)
    store_matrix(hpb_to_matrix(angles), pose.relative, joint)


@kernel
def renew_angles(joint: int, pose: Pose) -> None:
    """Read a free joint's angles from its matrix, in the form nearest to the old ones."""
    if pose.free[joint]:
        old = vector(pose.angles, joint)
        found = matrix_to_hpb(matrix(pose.relative, joint), old[2])
        set_angles(joint, nearest_form(found, old), pose)


@kernel
def clamp_angles(joint: int, angles: Vector, pose: Pose) -> Vector:
    """Return angles [rad] pulled into a joint's effective limits."""
    return clamp_vector(angles, vector(pose.low, joint), vector(pose.high, joint))


@kernel
def mark_limits(pose: Pose) -> None:
    """Note which joints are free of limits now, which can move at all, which are hinges."""
    for joint in range(pose.angles.shape[0]):
        bounded = 0
        moving = 0
        for axis in range(3):
            low, high = pose.low[joint, axis], pose.high[joint, axis]
            if low > -inf or high < inf:
                bounded += 1
            if high - low > FIXED:
                moving += 1
        pose.free[joint] = int(bounded == 0)
        pose.moves[joint] = int(moving > 0)
        pose.hinged[joint] = int(0 < moving < 3)


@kernel
def add_offsets(joint: int, fk: Array, pose: Pose, options: Options) -> None:
    """Add a joint's FK offsets to its angles within the limits (000 §6.1(4), (6)).

    Args:
        joint: Index.
        fk: FK offsets of all joints, HPB, (n, 3) [rad].
        pose: Changed in place.
        options: Of the solve.
    """
    offset = vector(fk, joint)
    if offset[0] == 0.0 and offset[1] == 0.0 and offset[2] == 0.0:
        return
    renew_angles(joint, pose)
    for axis in range(3):
        angle = pose.angles[joint, axis] + fk[joint, axis] * options.fk_strength
        if pose.high[joint, axis] == inf:
            angle = wrap_angle(angle)
        pose.angles[joint, axis] = clamp(angle, pose.low[joint, axis], pose.high[joint, axis])
    set_angles(joint, vector(pose.angles, joint), pose)


@kernel
def distance_to(goal: Vector, pose: Pose) -> float:
    """Return the distance of the end from a goal [length]."""
    return norm(subtract(goal, vector(pose.positions, pose.positions.shape[0] - 1)))
