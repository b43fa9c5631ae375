"""Turn one joint toward a target within its limits (000 §7.6, unpublished parts: DECISIONS A-33).

All directions here are in the joint's parent frame (parent world x frozen): the operating
vector v of the joint stands at `M(angles) v` there and is to move to a wanted direction.
"""

from math import atan2, cos, inf, pi, sin, sqrt

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Options, Plugs, Pose
from limbik.core.kernels.limit import slowed, turn_inside
from limbik.core.kernels.own import LIMIT
from limbik.core.kernels.re_aim import re_aim
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Matrix,
    Vector,
    across,
    add,
    axis_trig_to_matrix,
    clamp,
    clamp_vector,
    cross,
    dot,
    has_direction,
    hpb_to_matrix,
    matrix,
    matrix_to_hpb,
    multiply,
    near,
    nearest_form,
    norm,
    other_form,
    rotate,
    rotate_back,
    store_matrix,
    store_vector,
    subtract,
    unit,
    vector,
    wrap_angle,
)
from limbik.core.slots import call_bank_suppression


@kernel
def turn_joint(
    joint: int,
    operating: Vector,
    target: Vector,
    strength: float,
    in_ccd: bool,
    pose: Pose,
    options: Options,
    plugs: Plugs,
) -> bool:
    """Turn a joint so that its operating vector moves toward a target direction.

    Args:
        joint: Index.
        operating: Unit vector in the joint's frame.
        target: Unit vector in the joint's parent frame.
        strength: Share of the angle to make, 0..1.
        in_ccd: Whether a CCD round asks (bank suppression may act only there).
        pose: Changed in place: angles, relative, violations.
        options: Of the solve.
        plugs: Of the solve.

    Returns:
        Whether the joint moved.
    """
    relative = matrix(pose.relative, joint)
    current = rotate(relative, operating)
    side = cross(current, target)
    s, c = norm(side), dot(current, target)
    if strength < 1.0:
        angle = atan2(s, c) * strength
        s, c = sin(angle), cos(angle)
    else:
        # Not quite unit vectors would make the turn scale, and many turns scale without bound.
        size = sqrt(s * s + c * c)
        s, c = s / size, c / size
    if not (s > ZERO_TURN or c < 0.0):
        return False
    axis = unit(side)
    if not has_direction(axis):
        axis = _replacement_axis(relative, operating)
    aim = target if strength >= 1.0 else rotate(axis_trig_to_matrix(axis, s, c), current)
    zone = options.limit_ease if in_ccd else 0.0
    locked = options.bank_lock and joint > options.root
    watched = locked or plugs.bank_suppression != 0
    if pose.free[joint] and not watched:
        wanted = multiply(axis_trig_to_matrix(axis, s, c), relative)
        if pose.own[joint, LIMIT] != 0.0:
            turned = (pose.angles, pose.relative, pose.own[joint])
            return turn_inside(joint, operating, target, wanted, zone, *turned)
        store_matrix(wanted, pose.relative, joint)
        return True
    if pose.hinged[joint] and not options.plain_clamp and not options.max_violations:
        return _turn_hinged(
            joint, operating, target, aim, relative, zone, locked, in_ccd, pose, plugs
        )
    full = multiply(axis_trig_to_matrix(axis, s, c), relative)
    return _turn_limited(
        joint, operating, target, aim, relative, full, zone, locked, in_ccd, pose, options, plugs
    )


@kernel
def _replacement_axis(relative: Matrix, operating: Vector) -> Vector:
    """Return an axis for a target exactly behind: the joint's X across the operating vector.

    Y where X lies along it (3D A-31).
    """
    side = across((1.0, 0.0, 0.0), operating)
    if not has_direction(side):
        side = across((0.0, 1.0, 0.0), operating)
    return rotate(relative, side)


@kernel
def _move(
    joint: int, before: Vector, angles: Vector, turn: Matrix, zone: float, pose: Pose
) -> bool:
    """Give a joint new angles and their rotation; return whether they differ from before.

    Where there is a limit ease, of width `zone` [rad], less of the way is gone.
    """
    if zone > 0.0 or pose.own[joint, LIMIT] != 0.0:
        low, high = vector(pose.low, joint), vector(pose.high, joint)
        angles = slowed(before, angles, low, high, zone, pose.own[joint])
        turn = hpb_to_matrix(angles)
    change = subtract(angles, before)
    store_vector(angles, pose.angles, joint)
    store_matrix(turn, pose.relative, joint)
    return max(abs(change[0]), abs(change[1]), abs(change[2])) > ZERO_TURN


@kernel
def _turn_hinged(
    joint: int,
    operating: Vector,
    target: Vector,
    aim: Vector,
    relative: Matrix,
    zone: float,
    locked: bool,
    in_ccd: bool,
    pose: Pose,
    plugs: Plugs,
) -> bool:
    """Turn a joint with a fixed axis: it can seldom make the whole turn, so take the best at once.

    Arguments and result as in `_turn_limited`. What the bank suppression judges is the change that
    the joint can make.
    """
    before = vector(pose.angles, joint)
    low, high = vector(pose.low, joint), vector(pose.high, joint)
    if locked:
        low, high = (low[0], low[1], before[2]), (high[0], high[1], before[2])
    angles, turn = re_aim(before, low, high, operating, aim)
    if plugs.bank_suppression != 0:
        delta = subtract(angles, before)
        toward = rotate_back(relative, target)
        steered = _suppress(joint, delta, toward, operating, before, in_ccd, pose, plugs)
        if steered != delta:
            low, high = _decided(angles, add(before, steered), low, high)
            angles, turn = re_aim(clamp_vector(before, low, high), low, high, operating, aim)
    return _move(joint, before, angles, turn, zone, pose)


@kernel
def _turn_limited(
    joint: int,
    operating: Vector,
    target: Vector,
    aim: Vector,
    relative: Matrix,
    full: Matrix,
    zone: float,
    locked: bool,
    in_ccd: bool,
    pose: Pose,
    options: Options,
    plugs: Plugs,
) -> bool:
    """Turn a joint whose angles matter: limits, bank lock or bank suppression.

    Args:
        joint: Index.
        operating: Unit vector in the joint's frame.
        target: Where it is to go, parent frame.
        aim: Where this turn alone would bring it, parent frame.
        relative: The joint's rotation now.
        full: The rotation that the turn alone would make.
        zone: Of the limit ease [rad]; 0 = off.
        locked: Whether the bank stays as it is.
        in_ccd: Whether a CCD round asks.
        pose: Changed in place.
        options: Of the solve.
        plugs: Of the solve.

    Returns:
        Whether the joint moved.
    """
    before = vector(pose.angles, joint)
    if pose.free[joint]:
        # A free joint's matrix is the truth; its angles may be old.
        before = nearest_form(matrix_to_hpb(relative, before[2]), before)
    low, high = vector(pose.low, joint), vector(pose.high, joint)
    asked = matrix_to_hpb(full, before[2])
    if low[1] >= -0.5 * pi and high[1] <= 0.5 * pi:
        # The form with |pitch| ≤ 90° is the only one that such limits can leave uncut.
        wanted = _wrap_limited(near(asked, before), low, high)
        if _cut(wanted, low, high) > ZERO_TURN:
            wanted = _least_clamped_form(nearest_form(asked, before), before, low, high)
    else:
        wanted = _least_clamped_form(nearest_form(asked, before), before, low, high)
    if locked:
        wanted = (wanted[0], wanted[1], before[2])
        low, high = (low[0], low[1], before[2]), (high[0], high[1], before[2])
    if plugs.bank_suppression != 0:
        toward = rotate_back(relative, target)
        steered = _suppress(
            joint, subtract(wanted, before), toward, operating, before, in_ccd, pose, plugs
        )
        moved_to = add(before, steered)
        low, high = _decided(wanted, moved_to, low, high)
        wanted = moved_to
    cut = clamp_vector(wanted, low, high)
    gap = angle_gap(cut, wanted)
    exceeded = gap > ZERO_TURN
    pose.violations[joint] = pose.violations[joint] + 1 if exceeded else 0
    if exceeded and not options.plain_clamp:
        angles, turn = re_aim(clamp_vector(before, low, high), low, high, operating, aim)
        return _move(joint, before, angles, turn, zone, pose)
    if gap == 0.0 and not locked and plugs.bank_suppression == 0:
        return _move(joint, before, wanted, full, zone, pose)
    return _move(joint, before, cut, hpb_to_matrix(cut), zone, pose)


@kernel
def angle_gap(a: Vector, b: Vector) -> float:
    """Return the largest difference of two triples of angles [rad]."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2]))


@kernel
def _least_clamped_form(wanted: Vector, before: Vector, low: Vector, high: Vector) -> Vector:
    """Return the HPB form of wanted angles that the limits cut least (3D A-33).

    Limited axes are wrapped to their ranges, so that the long way round is taken
    when the short one runs into a limit (3D A-68).
    """
    first = _wrap_limited(wanted, low, high)
    second = _wrap_limited(near(other_form(wanted), before), low, high)
    if _cut(second, low, high) < _cut(first, low, high) - ZERO_TURN:
        return second
    return first


@kernel
def _wrap_limited(angles: Vector, low: Vector, high: Vector) -> Vector:
    """Return angles with those of limited axes moved by whole turns to where their ranges are."""
    return (
        _wrap_to_range(angles[0], low[0], high[0]) if high[0] < inf else angles[0],
        _wrap_to_range(angles[1], low[1], high[1]) if high[1] < inf else angles[1],
        _wrap_to_range(angles[2], low[2], high[2]) if high[2] < inf else angles[2],
    )


@kernel
def _wrap_to_range(angle: float, low: float, high: float) -> float:
    """Return an angle within a half turn of a range's middle, so that a clamp cuts it least."""
    turned = wrap_angle(angle)
    off = turned - 0.5 * (low + high)
    if off > pi:
        return turned - 2.0 * pi
    if off < -pi:
        return turned + 2.0 * pi
    return turned


@kernel
def _cut(angles: Vector, low: Vector, high: Vector) -> float:
    """Return by how much limits cut angles, summed over the axes [rad]."""
    return (
        abs(clamp(angles[0], low[0], high[0]) - angles[0])
        + abs(clamp(angles[1], low[1], high[1]) - angles[1])
        + abs(clamp(angles[2], low[2], high[2]) - angles[2])
    )


@kernel
def _suppress(
    joint: int,
    delta: Vector,
    toward: Vector,
    operating: Vector,
    before: Vector,
    in_ccd: bool,
    pose: Pose,
    plugs: Plugs,
) -> Vector:
    """Return the change of angles the bank suppression leaves of a wanted one [rad]."""
    scratch = pose.scratch
    store_vector(toward, scratch, 0)
    store_vector(operating, scratch, 1)
    store_vector(delta, scratch, 2)
    call_bank_suppression(
        plugs.bank_suppression,
        scratch[0],
        scratch[1],
        before[1],
        int(in_ccd),
        plugs.params[3],
        scratch[2],
    )
    return vector(scratch, 2)


@kernel
def _decided(wanted: Vector, steered: Vector, low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """Return limits that keep the axes a strategy has changed where it put them.

    Neither the clamp nor a re-aim may undo what the strategy decided.
    """
    fixed = clamp_vector(steered, low, high)
    return (
        (
            low[0] if steered[0] == wanted[0] else fixed[0],
            low[1] if steered[1] == wanted[1] else fixed[1],
            low[2] if steered[2] == wanted[2] else fixed[2],
        ),
        (
            high[0] if steered[0] == wanted[0] else fixed[0],
            high[1] if steered[1] == wanted[1] else fixed[1],
            high[2] if steered[2] == wanted[2] else fixed[2],
        ),
    )
