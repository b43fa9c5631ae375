"""The bend vector: strategy, smoothing, forbidden cone (000 §6.3(8)(C), §7.6).

All vectors here are in the IK space.
"""

from math import acos, atan2, cos, isfinite, nan, sin

from limbik.core.jit import kernel
from limbik.core.kernels.frames import base_rotation
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.memory import BEND
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Vector,
    across,
    add,
    angle_between,
    clamp,
    column,
    cross,
    dot,
    has_direction,
    matrix,
    rotate_back,
    scale,
    store_vector,
    subtract,
    turned,
    unit,
    vector,
)
from limbik.core.rotation import Array
from limbik.core.slots import call_bend_vector


@kernel
def find_bend_vector(
    aim: Vector, goal: Vector, body: Body, options: Options, plugs: Plugs, memory: Array, pose: Pose
) -> Vector:
    """Return the bend vector of a solve in its aim pose, a unit vector.

    The strategy's vector is made perpendicular to the aim, smoothed and turned out of the
    forbidden cone (3D A-16 to A-18, A-22). The stages use its part across the aim (`usable`).

    Args:
        aim: Unit vector root to goal.
        goal: World [length].
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        memory: Continuity of the solve before, (n + 4, 3).
        pose: In the aim pose.

    Returns:
        The vector; NaN where the strategy gave something that is not finite.
    """
    previous = unit(rotate_back(base_rotation(body), vector(memory, BEND)))
    known = has_direction(previous)
    if options.hold_bend and known:
        found = previous
    else:
        asked = _ask_strategy(aim, goal, previous, body, options, plugs, pose)
        if not isfinite(asked[0] + asked[1] + asked[2]):
            return nan, nan, nan
        found = usable(asked, aim, body, options, pose)
        if known and options.bend_smoothing > 0.0:
            found = _limit_turn(previous, found, options.bend_smoothing, aim)
    if options.cone_axis >= 0:
        found = _leave_cone(found, previous, aim, options)
    return found


@kernel
def usable(bend: Vector, aim: Vector, body: Body, options: Options, pose: Pose) -> Vector:
    """Return the unit vector of a bend vector's part across the aim.

    Where nothing is left, the root's Y axis across the aim stands for it, then X, then Z.
    """
    found = across(bend, aim)
    if has_direction(found):
        return found
    frame, base = matrix(pose.world, options.root), base_rotation(body)
    found = across(rotate_back(base, column(frame, 1)), aim)
    if not has_direction(found):
        found = across(rotate_back(base, column(frame, 0)), aim)
    if not has_direction(found):
        found = across(rotate_back(base, column(frame, 2)), aim)
    return found


@kernel
def _ask_strategy(
    aim: Vector,
    goal: Vector,
    previous: Vector,
    body: Body,
    options: Options,
    plugs: Plugs,
    pose: Pose,
) -> Vector:
    """Return the strategy's bend vector."""
    root, end = options.root, body.offsets.shape[0] - 1
    frame, base, scratch = matrix(pose.world, root), base_rotation(body), pose.scratch
    for axis in range(3):
        local = rotate_back(base, (frame[0][axis], frame[1][axis], frame[2][axis]))
        scratch[0, axis], scratch[1, axis], scratch[2, axis] = local
    store_vector(aim, scratch, 3)
    store_vector(rotate_back(base, subtract(vector(pose.positions, end), goal)), scratch, 4)
    store_vector(previous, scratch, 5)
    store_vector((nan, nan, nan), scratch, 6)
    call_bend_vector(
        plugs.bend_vector,
        scratch[0:3],
        scratch[3],
        scratch[4],
        body.base_rotation,
        pose.angles[root, 2] - body.rest[root, 2],
        scratch[5],
        plugs.params[1],
        scratch[6],
    )
    return vector(scratch, 6)


@kernel
def _limit_turn(previous: Vector, found: Vector, most: float, aim: Vector) -> Vector:
    """Return the bend vector turned from the previous one by at most an angle [rad] (E-11I)."""
    if angle_between(previous, found) <= most:
        return found
    axis = unit(cross(previous, found))
    if not has_direction(axis):
        # Opposite: turn in the plane across the aim, where a bend vector lives.
        axis = aim
    return unit(turned(previous, axis, most))


@kernel
def _leave_cone(found: Vector, previous: Vector, aim: Vector, options: Options) -> Vector:
    """Return the bend vector, turned out to the rim where it is in the forbidden cone (3D A-16).

    `stop` turns it toward the previous vector, `go-around` toward itself; neither turns farther
    from the previous vector than the smoothing allows.
    """
    axis = (
        options.cone_sign if options.cone_axis == 0 else 0.0,
        options.cone_sign if options.cone_axis == 1 else 0.0,
        options.cone_sign if options.cone_axis == 2 else 0.0,
    )
    if angle_between(found, axis) >= options.cone_angle:
        return found
    known = has_direction(previous)
    side = across(previous if known and not options.cone_around else found, axis)
    if not has_direction(side):
        # Straight on the cone's axis: leave it across the aim, so that the bend stays usable.
        side = across(cross(aim, axis), axis)
    if not has_direction(side):
        side = across((axis[1], axis[2], axis[0]), axis)
    if known and options.cone_around and options.bend_smoothing > 0.0:
        side = _limit_azimuth(side, previous, axis, options)
    # A hair outside, so that rounding cannot put it back in.
    angle = options.cone_angle + ZERO_TURN
    return unit(add(scale(axis, cos(angle)), scale(side, sin(angle))))


@kernel
def _limit_azimuth(side: Vector, previous: Vector, axis: Vector, options: Options) -> Vector:
    """Return a rim direction turned about the cone's axis so far that smoothing holds.

    On the sphere about the axis, previous at polar angle a and the rim at b with azimuth f apart:
    cos(distance) = cos a cos b + sin a sin b cos f.
    """
    start = across(previous, axis)
    a, b = angle_between(previous, axis), options.cone_angle
    if not has_direction(start) or sin(a) * sin(b) < ZERO_TURN:
        return side
    reach = (cos(options.bend_smoothing) - cos(a) * cos(b)) / (sin(a) * sin(b))
    most = acos(clamp(reach, -1.0, 1.0))
    beside = cross(axis, start)
    azimuth = atan2(dot(beside, side), dot(start, side))
    if abs(azimuth) <= most:
        return side
    angle = most if azimuth > 0.0 else -most
    return add(scale(start, cos(angle)), scale(beside, sin(angle)))
