"""Turn one joint toward a target within its limits (000 §7.6, unpublished parts: DECISIONS A-33).

All directions here are in the joint's parent frame (parent world x frozen): the operating
vector v of the joint stands at `M(angles) v` there and is to move to a wanted direction.
"""

from math import atan2, cos, inf, pi, sin

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Options, Plugs, Pose
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    angle_between,
    copy_matrix,
    copy_vector,
    cross,
    hpb_to_matrix,
    matrix_to_hpb,
    nearest_form,
    norm,
    normalize,
    other_angle,
    rotate,
    rotate_back,
    turn_about,
    turn_matrix,
    wrap_angle,
)
from limbik.core.rotation import Array
from limbik.core.slots import call_bank_suppression

FIXED = 1e-9  # [rad]; a range this narrow is a fixed axis
BLIND = 1e-6  # an axis that moves the operating vector less than this is left alone (3D A-65)
CYCLES = 3  # passes over the free axes when re-aiming after a clamp


@kernel
def turn_joint(
    joint: int,
    operating: Array,
    target: Array,
    strength: float,
    in_ccd: bool,
    pose: Pose,
    options: Options,
    plugs: Plugs,
) -> bool:
    """Turn a joint so that its operating vector moves toward a target direction.

    Args:
        joint: Index.
        operating: Unit vector in the joint's frame, (3,).
        target: Unit vector in the joint's parent frame, (3,).
        strength: Share of the angle to make, 0..1.
        in_ccd: Whether a CCD round asks (bank suppression may act only there).
        pose: Changed in place: angles, relative, violations.
        options: Of the solve.
        plugs: Of the solve.

    Returns:
        Whether the joint moved.
    """
    relative = pose.relative[joint]
    current, axis = pose.vectors[0], pose.vectors[1]
    rotate(relative, operating, current)
    angle = angle_between(current, target) * strength
    if not angle > ZERO_TURN:
        return False
    cross(current, target, axis)
    if norm(axis) < 1e-9 * strength:
        _replacement_axis(relative, operating, axis)
    normalize(axis)
    locked = options.bank_lock and joint > options.root
    if pose.free[joint] and not locked and plugs.bank_suppression == 0:
        turn_matrix(relative, axis, angle)
        return True
    return _turn_limited(
        joint, operating, target, axis, angle, locked, in_ccd, pose, options, plugs
    )


@kernel
def _replacement_axis(relative: Array, operating: Array, axis: Array) -> None:
    """Write an axis for a target exactly behind: the joint's X across the operating vector.

    Y where X lies along it (3D A-31).
    """
    first = 0 if abs(operating[0]) < 0.9 else 1
    for row in range(3):
        axis[row] = relative[row, first] - operating[first] * (
            relative[row, 0] * operating[0]
            + relative[row, 1] * operating[1]
            + relative[row, 2] * operating[2]
        )


@kernel
def _turn_limited(
    joint: int,
    operating: Array,
    target: Array,
    axis: Array,
    angle: float,
    locked: bool,
    in_ccd: bool,
    pose: Pose,
    options: Options,
    plugs: Plugs,
) -> bool:
    """Turn a joint whose angles matter: limits, bank lock or bank suppression."""
    angles, low, high = pose.angles[joint], pose.vectors[2], pose.vectors[3]
    wanted, delta, asked = pose.vectors[4], pose.vectors[5], pose.vectors[6]
    if pose.free[joint]:
        # A free joint's matrix is the truth; its angles may be old.
        matrix_to_hpb(pose.relative[joint], angles[2], asked)
        nearest_form(asked, angles)
        copy_vector(asked, angles)
    for i in range(3):
        low[i] = pose.low[joint, i]
        high[i] = pose.high[joint, i]
    copy_matrix(pose.relative[joint], pose.matrix)
    turn_matrix(pose.matrix, axis, angle)
    matrix_to_hpb(pose.matrix, angles[2], wanted)
    nearest_form(wanted, angles)
    _least_clamped_form(wanted, angles, low, high)
    for i in range(3):
        delta[i] = wanted[i] - angles[i]
        asked[i] = delta[i]
    if locked:
        delta[2] = 0.0
    if plugs.bank_suppression != 0:
        toward = pose.vectors[7]
        rotate_back(pose.relative[joint], target, toward)
        call_bank_suppression(
            plugs.bank_suppression,
            toward,
            operating,
            angles[1],
            int(in_ccd),
            plugs.params[3],
            delta,
        )
    steered = False
    for i in range(3):
        if delta[i] != asked[i]:
            # The strategy decided this axis: neither the clamp nor a re-aim may undo it.
            steered = True
            decided = min(max(angles[i] + delta[i], low[i]), high[i])
            low[i] = decided
            high[i] = decided
        wanted[i] = angles[i] + delta[i]
    return _settle(joint, operating, target, axis, angle, steered, pose, options)


@kernel
def _least_clamped_form(wanted: Array, angles: Array, low: Array, high: Array) -> None:
    """Turn wanted angles (3,) into the HPB form that the limits cut least (3D A-33).

    Limited axes are wrapped into ±180°, where ranges live, so that the long way round is taken
    when the short one runs into a limit (3D A-68).
    """
    first = 0.0
    second = 0.0
    for i in range(3):
        if high[i] < inf:
            wanted[i] = wrap_angle(wanted[i])
        other = wrap_angle(other_angle(wanted[i], i))
        first += max(low[i] - wanted[i], 0.0) + max(wanted[i] - high[i], 0.0)
        second += max(low[i] - other, 0.0) + max(other - high[i], 0.0)
    if second < first - ZERO_TURN:
        for i in range(3):
            other = wrap_angle(other_angle(wanted[i], i))
            wanted[i] = other if high[i] < inf else angles[i] + wrap_angle(other - angles[i])


@kernel
def _settle(
    joint: int,
    operating: Array,
    target: Array,
    axis: Array,
    angle: float,
    steered: bool,
    pose: Pose,
    options: Options,
) -> bool:
    """Give a joint its wanted angles, or the nearest the limits allow; count violations."""
    angles, wanted = pose.angles[joint], pose.vectors[4]
    low, high, before = pose.vectors[2], pose.vectors[3], pose.vectors[8]
    copy_vector(angles, before)
    exceeded = False
    violated = False
    for i in range(3):
        cut = min(max(wanted[i], low[i]), high[i])
        if abs(cut - wanted[i]) > ZERO_TURN:
            exceeded = True
            if pose.high[joint, i] - pose.low[joint, i] > FIXED:
                violated = True
        angles[i] = cut
    pose.violations[joint] = pose.violations[joint] + 1 if violated else 0
    if exceeded and not options.plain_clamp:
        aim = pose.vectors[9]
        rotate(pose.relative[joint], operating, aim)
        turn_about(aim, axis, angle, pose.vectors[10])
        for i in range(3):
            angles[i] = min(max(before[i], low[i]), high[i])
        re_aim(angles, low, high, operating, aim, pose.vectors[10], pose.vectors[11])
    hpb_to_matrix(angles, pose.relative[joint])
    moved = False
    for i in range(3):
        moved = moved or abs(angles[i] - before[i]) > ZERO_TURN
    return moved


@kernel
def re_aim(
    angles: Array, low: Array, high: Array, operating: Array, aim: Array, u: Array, w: Array
) -> None:
    """Turn axis after axis to where it brings the operating vector nearest to an aim.

    On one axis the cosine of the angle left is c + a cos x + b sin x, so the best x is
    atan2(b, a) or an end of the range: no step makes the angle larger (3D A-33, A-51).

    Args:
        angles: HPB inside low..high, changed in place, (3,) [rad].
        low: (3,) [rad].
        high: (3,) [rad].
        operating: Unit vector in the joint's frame, (3,).
        aim: Unit vector in the joint's parent frame, (3,).
        u: Scratch, (3,).
        w: Scratch, (3,).
    """
    open_axes = 0
    for i in range(3):
        if high[i] - low[i] > FIXED:
            open_axes += 1
    for _ in range(CYCLES if open_axes > 1 else open_axes):
        most = 0.0
        for i in range(3):
            if not high[i] - low[i] > FIXED:
                continue
            a, b = _swing(i, angles, operating, aim, u, w)
            if a * a + b * b < BLIND * BLIND:
                continue
            best = nearest_in_range(atan2(b, a), angles[i], low[i], high[i])
            most = max(most, abs(best - angles[i]))
            angles[i] = best
        if most < ZERO_TURN:
            return


@kernel
def _swing(
    axis: int, angles: Array, operating: Array, aim: Array, u: Array, w: Array
) -> tuple[float, float]:
    """Return a, b of the cosine c + a cos x + b sin x that one axis makes of M v · aim."""
    # u: the operating vector after the axes inside this one; w: the aim before those outside it.
    copy_vector(operating, u)
    copy_vector(aim, w)
    if axis < 2:
        _turn_z(u, angles[2])
    if axis == 0:
        _turn_x(u, angles[1])
        return u[0] * w[0] + u[2] * w[2], u[0] * w[2] - u[2] * w[0]
    _turn_y(w, -angles[0])
    if axis == 1:
        return u[1] * w[1] + u[2] * w[2], u[2] * w[1] - u[1] * w[2]
    _turn_x(w, -angles[1])
    return u[0] * w[0] + u[1] * w[1], u[1] * w[0] - u[0] * w[1]


@kernel
def _turn_x(vector: Array, angle: float) -> None:
    """Apply RX(angle) to a vector (3,) in place."""
    s, c = sin(angle), cos(angle)
    y, z = vector[1], vector[2]
    vector[1] = c * y + s * z
    vector[2] = c * z - s * y


@kernel
def _turn_y(vector: Array, angle: float) -> None:
    """Apply RY(angle) to a vector (3,) in place."""
    s, c = sin(angle), cos(angle)
    x, z = vector[0], vector[2]
    vector[0] = c * x - s * z
    vector[2] = s * x + c * z


@kernel
def _turn_z(vector: Array, angle: float) -> None:
    """Apply RZ(angle) to a vector (3,) in place."""
    s, c = sin(angle), cos(angle)
    x, y = vector[0], vector[1]
    vector[0] = c * x + s * y
    vector[1] = c * y - s * x


@kernel
def nearest_in_range(best: float, current: float, low: float, high: float) -> float:
    """Return the angle of a range that lies nearest to a wanted one on the circle.

    Args:
        best: Wanted angle [rad].
        current: Angle now [rad]; decides between equals and how a free axis winds.
        low: [rad], -inf when free.
        high: [rad].
    """
    if not high < inf:
        return current + wrap_angle(best - current)
    best = wrap_angle(best)
    if low <= best <= high:
        return best
    if best < low and best + 2.0 * pi <= high:
        return best + 2.0 * pi
    if best > high and best - 2.0 * pi >= low:
        return best - 2.0 * pi
    to_low = abs(wrap_angle(best - low))
    to_high = abs(wrap_angle(best - high))
    if abs(to_low - to_high) < ZERO_TURN:
        return low if abs(current - low) < abs(current - high) else high
    return low if to_low < to_high else high
