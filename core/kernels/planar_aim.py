"""From the rest pose to the aim pose of a 2D solve, in the IK space (000 §6.2(8), §7.5).

While these stages run, `world` and `positions` of the working pose are in the IK space.
"""

from math import atan2, pi

from limbik.core.jit import kernel
from limbik.core.kernels.frames import base_rotation, place_from
from limbik.core.kernels.layout import Body, Options, Pose
from limbik.core.kernels.planar_layout import Planar
from limbik.core.kernels.plane import along_x, shortest_turn
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    angle_between,
    clamp,
    column,
    has_direction,
    hpb_to_matrix,
    matrix,
    multiply,
    scale,
    store_matrix,
    store_vector,
    transposed,
    turn_about,
    unit,
    vector,
)
from limbik.core.rotation import Array

X_AXIS = (1.0, 0.0, 0.0)
ROLL_KEPT = 58.0 * pi / 180.0  # [rad], from the resting end to the goal
ROLL_GONE = 90.0 * pi / 180.0  # [rad]


@kernel
def put_initial_pose(frame: Matrix, body: Body, planar: Planar, pose: Pose) -> None:
    """Place the rest pose in the IK space.

    With a reference axis the base starts from the IK space's own axes, so that the pose depends
    on goal and pole alone; with none it keeps its turn in the world.
    """
    for joint in range(body.offsets.shape[0]):
        store_matrix(hpb_to_matrix(vector(body.rest, joint)), pose.relative, joint)
    own = multiply(matrix(body.frozen, 0), matrix(pose.relative, 0))
    if planar.axis_free:
        own = multiply(multiply(transposed(frame), base_rotation(body)), own)
    store_vector((0.0, 0.0, 0.0), pose.positions, 0)
    set_base(own, body, pose)


@kernel
def set_base(turn: Matrix, body: Body, pose: Pose) -> None:
    """Give the base a rotation in the IK space and place all joints after it."""
    store_matrix(turn, pose.world, 0)
    place_from(1, body, pose)


@kernel
def turn_base(turn: Matrix, body: Body, pose: Pose) -> None:
    """Turn the whole chain about the base."""
    set_base(multiply(turn, matrix(pose.world, 0)), body, pose)


@kernel
def aim_end(body: Body, planar: Planar, pose: Pose) -> None:
    """Turn the chain about the base until its end lies on the X axis.

    About Y and then Z, as in the source. Without a reference axis the roll this leaves stays, and
    it spins where the end is near Y: from `ROLL_KEPT` on it fades into that of the shortest turn.
    """
    end = unit(vector(pose.positions, body.offsets.shape[0] - 1))
    if not has_direction(end):
        return
    turn = along_x(end)
    if planar.axis_free:
        shortest = shortest_turn(end, X_AXIS)
        between = multiply(turn, transposed(shortest))
        share = clamp((ROLL_GONE - angle_between(end, X_AXIS)) / (ROLL_GONE - ROLL_KEPT), 0.0, 1.0)
        roll = atan2(between[2][1], between[1][1]) * share * share * (3.0 - 2.0 * share)
        turn = multiply(turn_about(X_AXIS, roll), shortest)
    turn_base(turn, body, pose)


@kernel
def face_pole(body: Body, options: Options, planar: Planar, pose: Pose) -> None:
    """Turn the chain about X until the reference axis faces the pole, then by the twist."""
    angle = options.twist
    if not planar.axis_free:
        frame = matrix(pose.world, planar.reference)
        axis = scale(column(frame, 0), options.axis_x)
        if options.axis_x == 0.0:
            axis = scale(column(frame, 1), options.axis_y)
        angle += atan2(axis[2], axis[1])
    if angle != 0.0:
        turn_base(turn_about(X_AXIS, -angle), body, pose)


@kernel
def apply_offsets(body: Body, options: Options, fk: Array, pose: Pose) -> None:
    """Apply FK offsets: each turns its own bone and is taken back for the joints after it.

    A joint's rotation is frozen⁻¹ · HPB(previous)⁻¹ · frozen · HPB(initial) · HPB(own), exact
    whatever the frozen rotation (2D 12, 13).
    """
    strength = options.fk_strength
    store_matrix(
        multiply(matrix(pose.world, 0), offset_turn(0, fk, strength)),
        pose.world,
        0,
    )
    for joint in range(1, body.offsets.shape[0]):
        frozen = matrix(body.frozen, joint)
        undone = multiply(transposed(offset_turn(joint - 1, fk, strength)), frozen)
        own = multiply(hpb_to_matrix(vector(body.rest, joint)), offset_turn(joint, fk, strength))
        store_matrix(multiply(multiply(transposed(frozen), undone), own), pose.relative, joint)
    place_from(1, body, pose)


@kernel
def offset_turn(joint: int, fk: Array, strength: float) -> Matrix:
    """Return the rotation of a joint's FK offset at a strength."""
    return hpb_to_matrix(scale(vector(fk, joint), strength))


@kernel
def any_offset(fk: Array) -> bool:
    """Return whether any FK offset is not zero."""
    for joint in range(fk.shape[0]):
        angles: Vector = vector(fk, joint)
        if angles[0] != 0.0 or angles[1] != 0.0 or angles[2] != 0.0:
            return True
    return False
