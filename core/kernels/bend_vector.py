"""The bend vector: strategy, smoothing, forbidden cone (000 §6.3(8)(C), §7.6)."""

from math import acos, atan2, cos, isfinite, nan, sin

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    angle_between,
    copy_vector,
    cross,
    make_perpendicular,
    norm,
    normalize,
    rotate,
    rotate_back,
    turn_about,
)
from limbik.core.rotation import Array
from limbik.core.slots import call_bend_vector


@kernel
def find_bend_vector(
    body: Body, options: Options, plugs: Plugs, goal: Array, memory: Array, pose: Pose
) -> bool:
    """Set the bend vector of a solve in its aim pose.

    The strategy's vector is made perpendicular to the aim, smoothed, turned out of the forbidden
    cone (3D A-16 to A-18, A-22) and kept for the next solve; the stages use its part across the
    aim.

    Args:
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        goal: (3,) [length], world.
        memory: Continuity of the solve before, (n + 4, 3).
        pose: In the aim pose; its bend vectors are set.

    Returns:
        False where the strategy gave something that is not a finite vector.
    """
    previous, vector = pose.vectors[14], pose.vectors[15]
    rotate_back(body.base_rotation, memory[2], previous)
    has_previous = norm(previous) > 0.5
    if options.hold_bend and has_previous:
        copy_vector(previous, vector)
    else:
        if not _ask_strategy(body, options, plugs, goal, previous, vector, pose):
            return False
        if not make_perpendicular(vector, pose.aim):
            _any_perpendicular(options.root, body, pose, vector)
        if has_previous and options.bend_smoothing > 0.0:
            _limit_turn(previous, vector, options.bend_smoothing, pose)
    if options.cone_axis >= 0:
        _leave_cone(options, has_previous, previous, vector, pose)
    rotate(body.base_rotation, vector, pose.bend_world)
    copy_vector(vector, pose.bend)
    if not make_perpendicular(pose.bend, pose.aim):
        _any_perpendicular(options.root, body, pose, pose.bend)
    return True


@kernel
def _ask_strategy(
    body: Body,
    options: Options,
    plugs: Plugs,
    goal: Array,
    previous: Array,
    vector: Array,
    pose: Pose,
) -> bool:
    """Write the strategy's bend vector, IK space, (3,); False where it is not finite."""
    root, end = options.root, body.offsets.shape[0] - 1
    offset, away = pose.vectors[16], pose.vectors[17]
    for column in range(3):
        for i in range(3):
            offset[i] = pose.world[root, i, column]
        rotate_back(body.base_rotation, offset, away)
        for i in range(3):
            pose.matrix[i, column] = away[i]
    for i in range(3):
        away[i] = pose.positions[end, i] - goal[i]
        vector[i] = nan
    rotate_back(body.base_rotation, away, offset)
    bank = pose.angles[root, 2] - body.rest[root, 2]
    call_bend_vector(
        plugs.bend_vector,
        pose.matrix,
        pose.aim,
        offset,
        body.base_rotation,
        bank,
        previous,
        plugs.params[1],
        vector,
    )
    return isfinite(vector[0]) and isfinite(vector[1]) and isfinite(vector[2])


@kernel
def _any_perpendicular(root: int, body: Body, pose: Pose, vector: Array) -> None:
    """Write a unit vector across the aim: the root's Y axis, or X where Y lies along it."""
    axis = pose.vectors[16]
    for column in (1, 0, 2):
        for i in range(3):
            axis[i] = pose.world[root, i, column]
        rotate_back(body.base_rotation, axis, vector)
        if make_perpendicular(vector, pose.aim):
            return


@kernel
def _limit_turn(previous: Array, vector: Array, most: float, pose: Pose) -> None:
    """Let a vector (3,) turn from the previous one by at most an angle [rad] (E-11I)."""
    if angle_between(previous, vector) <= most:
        return
    axis = pose.vectors[16]
    cross(previous, vector, axis)
    if norm(axis) < ZERO_TURN:
        # Opposite: turn in the plane across the aim, where a bend vector lives.
        copy_vector(pose.aim, axis)
    normalize(axis)
    copy_vector(previous, vector)
    turn_about(vector, axis, most, pose.vectors[17])
    normalize(vector)


@kernel
def _leave_cone(
    options: Options, has_previous: bool, previous: Array, vector: Array, pose: Pose
) -> None:
    """Turn a vector (3,) that is inside the forbidden cone out to its rim (3D A-16).

    `stop` turns it toward the previous vector, `go-around` toward itself; a go-around never
    turns farther than the smoothing allows.
    """
    axis, around = pose.vectors[16], pose.vectors[17]
    for i in range(3):
        axis[i] = options.cone_sign if i == options.cone_axis else 0.0
    if angle_between(vector, axis) >= options.cone_angle:
        return
    if has_previous and not options.cone_around:
        copy_vector(previous, around)
    else:
        copy_vector(vector, around)
    if not make_perpendicular(around, axis):
        # Straight on the cone's axis: leave it across the aim, so that the bend stays usable.
        cross(pose.aim, axis, around)
        if not make_perpendicular(around, axis):
            for i in range(3):
                around[i] = 1.0 if i == (options.cone_axis + 1) % 3 else 0.0
    if has_previous and options.cone_around and options.bend_smoothing > 0.0:
        _limit_azimuth(options, previous, axis, around, pose)
    c, s = cos(options.cone_angle), sin(options.cone_angle)
    for i in range(3):
        vector[i] = axis[i] * c + around[i] * s


@kernel
def _limit_azimuth(
    options: Options, previous: Array, axis: Array, around: Array, pose: Pose
) -> None:
    """Turn a rim direction (3,) about the cone's axis so far that smoothing holds.

    On the sphere about the axis, previous at polar angle a and the rim at b with azimuth f apart:
    cos(distance) = cos a cos b + sin a sin b cos f.
    """
    start, side = pose.vectors[18], pose.vectors[19]
    copy_vector(previous, start)
    a, b = angle_between(previous, axis), options.cone_angle
    if not make_perpendicular(start, axis) or sin(a) * sin(b) < ZERO_TURN:
        return
    reach = (cos(options.bend_smoothing) - cos(a) * cos(b)) / (sin(a) * sin(b))
    most = acos(min(max(reach, -1.0), 1.0))
    cross(axis, start, side)
    azimuth = atan2(
        side[0] * around[0] + side[1] * around[1] + side[2] * around[2],
        start[0] * around[0] + start[1] * around[1] + start[2] * around[2],
    )
    if abs(azimuth) <= most:
        return
    turned = most if azimuth > 0.0 else -most
    for i in range(3):
        around[i] = start[i] * cos(turned) + side[i] * sin(turned)
