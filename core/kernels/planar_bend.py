"""Planar joints and their initial bend within limits (000 §6.2(8)(C), §7.5)."""

from math import atan2, cos, hypot, inf, sin

from limbik.core.jit import kernel
from limbik.core.kernels.bend_pose import bone_angles
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.planar_aim import offset_turn
from limbik.core.kernels.planar_layout import Planar, PlanarPose
from limbik.core.kernels.rotation import (
    ZERO_LENGTH,
    clamp,
    hpb_to_matrix,
    matrix,
    multiply,
    rotate,
    transposed,
    vector,
    wrap_angle,
)
from limbik.core.rotation import Array


@kernel
def find_planar_joints(pose: Pose, flat: PlanarPose) -> None:
    """Project the joints of the aim pose onto the IK plane (000 §7.5, 2D data)."""
    last = flat.before.shape[0] - 1
    angle, total = 0.0, 0.0
    for joint in range(last + 1):
        for axis in range(3):
            flat.places[joint, axis] = pose.positions[joint, axis]
        flat.along[joint] = total
        flat.lengths[joint] = 0.0
        if joint < last:
            x = pose.positions[joint + 1, 0] - pose.positions[joint, 0]
            y = pose.positions[joint + 1, 1] - pose.positions[joint, 1]
            flat.lengths[joint] = hypot(x, y)
            # A bone seen from its end has no direction: it takes the one before it.
            if flat.lengths[joint] > ZERO_LENGTH:
                angle = atan2(y, x)
        flat.before[joint] = angle
        total += flat.lengths[joint]
    carried = 0.0
    for joint in range(last + 1):
        flat.relative[joint] = wrap_angle(flat.before[joint] - carried)
        carried = flat.before[joint]
    place_planar(0, flat)


@kernel
def place_planar(first: int, flat: PlanarPose) -> None:
    """Renew angles and positions of the planar joints from `first` to the end."""
    angle = 0.0 if first == 0 else flat.after[first - 1]
    for joint in range(first, flat.after.shape[0]):
        if joint > 0:
            flat.places[joint, 0] = flat.places[joint - 1, 0] + flat.lengths[joint - 1] * cos(angle)
            flat.places[joint, 1] = flat.places[joint - 1, 1] + flat.lengths[joint - 1] * sin(angle)
        angle += flat.relative[joint]
        flat.after[joint] = angle


@kernel
def bend_planar(
    distance: float,
    body: Body,
    options: Options,
    planar: Planar,
    plugs: Plugs,
    fk: Array,
    pose: Pose,
    flat: PlanarPose,
) -> bool:
    """Bend the planar joints toward the pole, within their limits.

    Args:
        distance: Base to goal [length].
        body: The chain.
        options: Of the solve.
        planar: Of the solve.
        plugs: Of the solve.
        fk: FK offsets, HPB, (n, 3) [rad].
        pose: In the aim pose, IK space.
        flat: Changed in place.

    Returns:
        False where the initial-bend method gave something that is not finite.
    """
    support, end = planar.support, flat.after.shape[0] - 1
    good = True
    if 0 <= support < end - 1:
        _settle_locked(planar, flat)
        away = (distance - flat.places[support, 0], -flat.places[support, 1])
        reach = flat.along[end] - flat.along[support]
        if reach > ZERO_LENGTH:
            good = bone_angles(
                hypot(away[0], away[1]), flat.along, support, reach, options, plugs, pose.bones
            )
            lean = atan2(away[1], away[0]) - flat.after[support - 1] if support > 0 else 0.0
            if not planar.keeps_shape:
                _find_offsets(body, options, fk, pose, flat)
            _add_bend(lean, options, planar, pose, flat)
    if planar.limited:
        place_planar(0, flat)
        tip = (flat.places[end, 0], flat.places[end, 1])
        if _limit_bend(planar, flat):
            place_planar(0, flat)
            _aim_again(tip, planar, flat)
    place_planar(0, flat)
    return good


@kernel
def _settle_locked(planar: Planar, flat: PlanarPose) -> None:
    """Put the joints before the support, which cannot turn, where their limits hold them."""
    if planar.support > 0:
        for joint in range(planar.support):
            flat.relative[joint] = planar.low[joint]
        place_planar(0, flat)


@kernel
def _add_bend(lean: float, options: Options, planar: Planar, pose: Pose, flat: PlanarPose) -> None:
    """Give the planar joints the bones' angles from the line support to goal.

    A straight chain adds them to what it has; a bent one takes them instead, so that chains of
    the same planar lengths agree, and FK offsets are added again (2D 43).

    Args:
        lean: Angle of that line from the bone before the support [rad].
        options: Of the solve.
        planar: Of the solve.
        pose: Holds the bones' angles.
        flat: Changed in place.
    """
    support = planar.support
    carried = -lean
    for joint in range(
        max(support, options.bend_held_base), flat.after.shape[0] - 1 - options.bend_held_end
    ):
        angle = planar.side * pose.bones[2, joint - support] - planar.bound[joint]
        kept = flat.relative[joint] if planar.keeps_shape else flat.offsets[joint]
        flat.relative[joint] = kept + (angle - carried)
        carried = angle


@kernel
def _find_offsets(body: Body, options: Options, fk: Array, pose: Pose, flat: PlanarPose) -> None:
    """Find what FK offsets turn the planar bones by, beside the same pose without them (2DFK)."""
    turn = multiply(matrix(pose.world, 0), transposed(offset_turn(0, fk, options.fk_strength)))
    carried = 0.0
    for joint in range(flat.after.shape[0] - 1):
        bone = rotate(turn, vector(body.offsets, joint + 1))
        flat.offsets[joint] = 0.0
        if hypot(bone[0], bone[1]) > ZERO_LENGTH and flat.lengths[joint] > ZERO_LENGTH:
            angle = wrap_angle(flat.before[joint] - atan2(bone[1], bone[0]))
            flat.offsets[joint] = angle - carried
            carried = angle
        own = hpb_to_matrix(vector(body.rest, joint + 1))
        turn = multiply(multiply(turn, matrix(body.frozen, joint + 1)), own)


@kernel
def _limit_bend(planar: Planar, flat: PlanarPose) -> bool:
    """Pull the planar joints into their limits, from the end toward the base (2D 26).

    What a joint may not turn, the one before it does.

    Returns:
        Whether a joint was outside.
    """
    outside = False
    for joint in range(flat.after.shape[0] - 2, -1, -1):
        if planar.high[joint] == inf:
            continue
        angle = wrap_angle(flat.relative[joint])
        kept = clamp(angle, planar.low[joint], planar.high[joint])
        flat.relative[joint] = kept
        if kept != angle:
            outside = True
            flat.violations[joint] += 1
            if joint > 0:
                flat.relative[joint - 1] += angle - kept
    return outside


@kernel
def _aim_again(tip: tuple[float, float], planar: Planar, flat: PlanarPose) -> None:
    """Turn the support, within its limits, until the end is seen from it where it was.

    Not onto the goal at once: the pose would jump when a joint first meets its limit.

    Args:
        tip: Where the end was without limits.
        planar: Of the solve.
        flat: Changed in place.
    """
    support, end = planar.support, flat.after.shape[0] - 1
    if support < 0:
        return
    x, y = flat.places[support, 0], flat.places[support, 1]
    now = (flat.places[end, 0] - x, flat.places[end, 1] - y)
    wanted = (tip[0] - x, tip[1] - y)
    if hypot(now[0], now[1]) < ZERO_LENGTH or hypot(wanted[0], wanted[1]) < ZERO_LENGTH:
        return
    flat.relative[support] = clamp(
        wrap_angle(flat.relative[support] + signed_angle(now, wanted)),
        planar.low[support],
        planar.high[support],
    )


@kernel
def signed_angle(start: tuple[float, float], target: tuple[float, float]) -> float:
    """Return the angle from one planar vector to another [rad], positive from X toward Y."""
    return atan2(
        start[0] * target[1] - start[1] * target[0], start[0] * target[0] + start[1] * target[1]
    )
