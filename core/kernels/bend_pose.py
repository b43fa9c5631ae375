"""The initial bend pose: angles of the strategy, reference axis, FK offsets (000 §6.3(8)(D))."""

from math import acos, atan2, cos, inf, isfinite, nan, pi, sin

from limbik.core.jit import kernel
from limbik.core.kernels.frames import add_offsets, place, place_from, renew_angles
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.rotation import (
    ZERO_LENGTH,
    ZERO_TURN,
    copy_vector,
    cross,
    hpb_to_matrix,
    norm,
    rotate,
    rotate_back,
    turn_about,
    wrap_angle,
)
from limbik.core.kernels.turn import turn_joint
from limbik.core.rotation import Array
from limbik.core.slots import call_initial_bend


@kernel
def find_bend_angles(
    body: Body, options: Options, plugs: Plugs, distance: float, pose: Pose
) -> bool:
    """Ask the initial-bend method for the angle of every bone from the root on.

    Args:
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        distance: Root to goal [length].
        pose: Its `bones` are set: lengths, weights, angles.

    Returns:
        False where the strategy gave something that is not finite.
    """
    root, n = options.root, body.offsets.shape[0]
    count = n - 1 - root
    ratio = distance / options.root_to_end
    bend_angle = acos(min(ratio, 1.0))
    # 000 §6.1(12)
    base = options.coefficient_base
    coefficient = (1.0 - bend_angle / (0.5 * pi)) * (1.0 - base) + base
    # 000 §6.1(13); the apex stays on the chain and C in 0..1 (3D A-43)
    apex = min(max(ratio, 0.5), 1.0)
    spread = options.weight_max - options.weight_min
    for bone in range(count):
        at = (body.along[root + bone] - body.along[root]) / options.root_to_end
        c = min(max(1.0 - abs(apex - at), 0.0), 1.0)
        weight = 1.0 + options.weight_min + c * c * c * spread
        pose.bones[0, bone] = (
            body.along[root + bone + 1] - body.along[root + bone]
        ) / options.root_to_end
        pose.bones[1, bone] = weight * coefficient
        pose.bones[2, bone] = nan
    call_initial_bend(
        plugs.initial_bend,
        pose.bones[0, :count],
        ratio,
        pose.bones[1, :count],
        plugs.params[0],
        pose.bones[2, :count],
    )
    for bone in range(count):
        if not isfinite(pose.bones[2, bone]):
            return False
    return True


@kernel
def bend_pose(body: Body, options: Options, plugs: Plugs, fk: Array, pose: Pose) -> None:
    """Bend the chain from its aim pose (000 §7.6, initial bend pose).

    Joints held from either end stay as they are when the options say so (3D A-23).
    """
    n, root = body.offsets.shape[0], options.root
    reference = root + 1
    if n - 1 - reference <= 0:
        place_from(0, body, pose)  # one bone after the root: nothing to bend
        return
    first = options.bend_held_base
    last = n - 1 - options.bend_held_end
    if last < reference:
        for joint in range(first, last):
            add_offsets(joint, fk, pose, options)
        place_from(0, body, pose)
        return
    if first <= root:
        for joint in range(first, root):
            add_offsets(joint, fk, pose, options)
            place(joint, body, pose)
        place(root, body, pose)
        _bend_joint(root, body, options, plugs, pose)
        place(root, body, pose)
        if last > reference:
            turn_reference_axis(body, options, fk, pose)
        first = reference
    place_from(min(first, reference), body, pose)
    for joint in range(first, last):
        place(joint, body, pose)
        _bend_joint(joint, body, options, plugs, pose)
        add_offsets(joint, fk, pose, options)
        place(joint, body, pose)
    place_from(min(first, last), body, pose)


@kernel
def _bend_joint(joint: int, body: Body, options: Options, plugs: Plugs, pose: Pose) -> None:
    """Turn a joint's operating vector to its bend direction, within limits."""
    angle = pose.bones[2, joint - options.root]
    wanted, world, target = pose.vectors[14], pose.vectors[15], pose.vectors[16]
    if options.off_axis:
        # Each joint's own end direction of the aim pose is turned (3D A-28).
        copy_vector(pose.directions[joint], world)
        cross(pose.aim, pose.bend, wanted)
        rotate(body.base_rotation, wanted, target)
        turn_about(world, target, angle, pose.vectors[17])
    else:
        for i in range(3):
            wanted[i] = pose.aim[i] * cos(angle) + pose.bend[i] * sin(angle)
        rotate(body.base_rotation, wanted, world)
    rotate_back(pose.parent[joint], world, target)
    operating = pose.vectors[18]
    copy_vector(body.operating[joint], operating)
    if norm(operating) > 0.5:
        turn_joint(joint, operating, target, 1.0, False, pose, options, plugs)


@kernel
def turn_reference_axis(body: Body, options: Options, fk: Array, pose: Pose) -> None:
    """Turn the root about its Z axis until the reference axis faces the bend vector.

    The twist is added (3D A-25) and the sum stays in the root's bank limits; then the root's FK
    offsets apply (000 §7.6). Axis and bend vector are compared across the root's Z (3D A-26).
    """
    root = options.root
    place(root, body, pose)
    angle = options.twist
    if options.axis_x != 0.0 or options.axis_y != 0.0:
        angle += _axis_angle(body, options, pose)
    renew_angles(root, pose)
    bank = pose.angles[root, 2]
    if pose.high[root, 2] < inf:
        turned = wrap_angle(bank + angle)
        if not pose.low[root, 2] <= turned <= pose.high[root, 2]:
            angle = wrap_angle(angle)
            turned = min(max(bank + angle, pose.low[root, 2]), pose.high[root, 2])
    else:
        turned = wrap_angle(bank + angle)
    if abs(turned - bank) > ZERO_TURN:
        pose.angles[root, 2] = turned
        hpb_to_matrix(pose.angles[root], pose.relative[root])
    add_offsets(root, fk, pose, options)
    place(root, body, pose)


@kernel
def _axis_angle(body: Body, options: Options, pose: Pose) -> float:
    """Return the angle about the root's Z from the reference axis to the bend vector [rad]."""
    root, reference = options.root, options.root + 1
    place(reference, body, pose)
    axis, bend, world = pose.vectors[14], pose.vectors[15], pose.vectors[16]
    for i in range(3):
        world[i] = (
            options.axis_x * pose.world[reference, i, 0]
            + options.axis_y * pose.world[reference, i, 1]
        )
    rotate_back(pose.world[root], world, axis)
    rotate(body.base_rotation, pose.bend, world)
    rotate_back(pose.world[root], world, bend)
    if axis[0] ** 2 + axis[1] ** 2 < ZERO_LENGTH or bend[0] ** 2 + bend[1] ** 2 < ZERO_LENGTH:
        return 0.0
    # RZ(a) carries (0, 1) to (sin a, cos a): angles run from Y toward X.
    return atan2(bend[0], bend[1]) - atan2(axis[0], axis[1])
