"""The initial bend pose: angles of the strategy, reference axis, FK offsets (000 §6.3(8)(D))."""

from math import acos, atan2, cos, inf, isfinite, nan, pi, sin

from limbik.core.jit import kernel
from limbik.core.kernels.frames import (
    add_offsets,
    base_rotation,
    place,
    place_from,
    renew_angles,
    set_angles,
)
from limbik.core.kernels.layout import Bend, Body, Options, Plugs, Pose
from limbik.core.kernels.rotation import (
    ZERO_LENGTH,
    ZERO_TURN,
    add,
    clamp,
    column,
    cross,
    has_direction,
    matrix,
    rotate,
    rotate_back,
    scale,
    turned,
    vector,
    wrap_angle,
)
from limbik.core.kernels.turn import turn_joint
from limbik.core.rotation import Array
from limbik.core.slots import call_initial_bend


@kernel
def find_bend_angles(
    distance: float, body: Body, options: Options, plugs: Plugs, pose: Pose
) -> bool:
    """Ask the initial-bend method for the angle of every bone from the root on.

    Args:
        distance: Root to goal [length].
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        pose: Its `bones` are set: lengths, weights, angles.

    Returns:
        False where the strategy gave something that is not finite.
    """
    return bone_angles(
        distance, body.along, options.root, options.root_to_end, options, plugs, pose.bones
    )


@kernel
def bone_angles(
    distance: float,
    along: Array,
    root: int,
    reach: float,
    options: Options,
    plugs: Plugs,
    bones: Array,
) -> bool:
    """Ask the initial-bend method for the angle of every bone from a joint on, in 2D and 3D.

    Args:
        distance: Root to goal [length].
        along: Length from joint 0 to each joint, (n,) [length].
        root: Joint where the bend starts.
        reach: Length from the root to the end [length].
        options: Of the solve.
        plugs: Of the solve.
        bones: OUT: (3, n): lengths, weights, angles [rad] of the bones from the root on.

    Returns:
        False where the strategy gave something that is not finite.
    """
    count = along.shape[0] - 1 - root
    ratio = distance / reach
    # 000 §6.1(12)
    base = options.coefficient_base
    coefficient = (1.0 - acos(min(ratio, 1.0)) / (0.5 * pi)) * (1.0 - base) + base
    # 000 §6.1(13); the apex stays on the chain and C in 0..1 (3D A-43)
    apex = clamp(ratio, 0.5, 1.0)
    spread = options.weight_max - options.weight_min
    for bone in range(count):
        at = (along[root + bone] - along[root]) / reach
        c = clamp(1.0 - abs(apex - at), 0.0, 1.0)
        weight = 1.0 + options.weight_min + c * c * c * spread
        length = along[root + bone + 1] - along[root + bone]
        bones[0, bone] = length / reach
        bones[1, bone] = weight * coefficient
        bones[2, bone] = nan
    call_initial_bend(
        plugs.initial_bend,
        bones[0, :count],
        ratio,
        bones[1, :count],
        plugs.params[0],
        bones[2, :count],
    )
    total = 0.0
    for bone in range(count):
        total += bones[2, bone]
    return isfinite(total)


@kernel
def bend_pose(
    bend: Bend, body: Body, options: Options, plugs: Plugs, fk: Array, pose: Pose
) -> None:
    """Bend the chain from its aim pose (000 §7.6, initial bend pose).

    Joints held from either end stay as they are when the options say so (3D A-23).
    """
    n, root = body.offsets.shape[0], options.root
    reference = root + 1
    if n - 1 - reference <= 0:
        return  # one bone after the root: nothing to bend
    first = options.bend_held_base
    last = n - 1 - options.bend_held_end
    start = first
    if last < reference:
        for joint in range(first, last):
            add_offsets(joint, fk, pose, options)
        place_from(first, body, pose)
        return
    if first <= root:
        for joint in range(first, root):
            add_offsets(joint, fk, pose, options)
            place(joint, body, pose)
        place(root, body, pose)
        _bend_joint(root, bend, body, options, plugs, pose)
        place(root, body, pose)
        if last > reference:
            turn_reference_axis(bend, body, options, fk, pose)
        start = reference
    for joint in range(start, last):
        place(joint, body, pose)
        _bend_joint(joint, bend, body, options, plugs, pose)
        add_offsets(joint, fk, pose, options)
        place(joint, body, pose)
    place_from(last, body, pose)


@kernel
def _bend_joint(
    joint: int, bend: Bend, body: Body, options: Options, plugs: Plugs, pose: Pose
) -> None:
    """Turn a joint's operating vector to its bend direction, within limits."""
    angle = pose.bones[2, joint - options.root]
    base = base_rotation(body)
    if options.off_axis:
        # Each joint's own end direction of the aim pose is turned (3D A-28).
        axis = rotate(base, cross(bend.aim, bend.vector))
        world = turned(vector(pose.directions, joint), axis, angle)
    else:
        world = rotate(base, add(scale(bend.aim, cos(angle)), scale(bend.vector, sin(angle))))
    operating = vector(body.operating, joint)
    if has_direction(operating):
        target = rotate_back(matrix(pose.parent, joint), world)
        turn_joint(joint, operating, target, 1.0, False, pose, options, plugs)


@kernel
def turn_reference_axis(bend: Bend, body: Body, options: Options, fk: Array, pose: Pose) -> None:
    """Turn the root about its Z axis until the reference axis faces the bend vector.

    The twist is added (3D A-25) and the sum stays in the root's bank limits; then the root's FK
    offsets apply (000 §7.6). Axis and bend vector are compared across the root's Z (3D A-26).
    """
    root = options.root
    place(root, body, pose)
    angle = options.twist
    if options.axis_x != 0.0 or options.axis_y != 0.0:
        angle += _axis_angle(bend, body, options, pose)
    renew_angles(root, pose)
    angles = vector(pose.angles, root)
    low, high = pose.low[root, 2], pose.high[root, 2]
    bank = wrap_angle(angles[2] + angle)
    if high < inf and not low <= bank <= high:
        bank = clamp(angles[2] + wrap_angle(angle), low, high)
    if abs(bank - angles[2]) > ZERO_TURN:
        set_angles(root, (angles[0], angles[1], bank), pose)
    add_offsets(root, fk, pose, options)
    place(root, body, pose)


@kernel
def _axis_angle(bend: Bend, body: Body, options: Options, pose: Pose) -> float:
    """Return the angle about the root's Z from the reference axis to the bend vector [rad]."""
    root, reference = options.root, options.root + 1
    place(reference, body, pose)
    frame, rotation = matrix(pose.world, root), matrix(pose.world, reference)
    axis = rotate_back(
        frame,
        add(scale(column(rotation, 0), options.axis_x), scale(column(rotation, 1), options.axis_y)),
    )
    bent = rotate_back(frame, rotate(base_rotation(body), bend.vector))
    if axis[0] ** 2 + axis[1] ** 2 < ZERO_LENGTH or bent[0] ** 2 + bent[1] ** 2 < ZERO_LENGTH:
        return 0.0
    # RZ(a) carries (0, 1) to (sin a, cos a): angles run from Y toward X.
    return atan2(bent[0], bent[1]) - atan2(axis[0], axis[1])
