"""Closed-form inverse of the leg, compiled (002; readings B-1 to B-13).

Right-handed, Z up: x right, y forward, z up, the hip at the origin of the torso's frame. The leg
is Ry(-j1) Rx(-j2) Rz(-j3), thigh, Rx(-j4), shin, Rx(-j5) Ry(-j6), links along (0, 0, -l).
"""

from math import atan2, cos, inf, pi, sin, sqrt

from limbik.core.jit import entry, kernel
from limbik.core.kernels.rotation import clamp, wrap_angle
from limbik.core.rotation import Array

OK, TOO_FAR, TOO_NEAR, BEYOND_LIMITS = 0, 1, 2, 3
HIP_GIMBAL, KNEE_STRAIGHT, KNEE_FOLDED, ON_ANKLE_AXIS = 1, 2, 4, 8
SLACK = 1e-9  # share of the leg's length that counts as on the border of its reach
ANGLE_SLACK = 1e-9  # [rad] past a limit that is rounding
MERGED = 1e-8  # [rad] or share of a length; nearer than this two branches are one
BRANCHES = 8


@kernel
def find_branches(
    thigh: float, shin: float, pose: Array, hint: Array, bends: tuple[float, float], out: Array
) -> tuple[int, int, int]:
    """Find all joint angles that put the ankle and the foot where they shall be.

    The ankle seen from the foot is Ry(j6) Rx(j5) w with w known from the knee alone, which gives
    j6 and j5; what is left of the foot's rotation is the hip's. A pose out of reach is solved for
    the nearest ankle position in reach.

    Args:
        thigh: Length l1 [length].
        shin: Length l2 [length].
        pose: Ankle position and the rows of the foot's rotation, torso's frame, (4, 3).
        hint: j1 to j6 that undetermined angles keep, (6,) [rad].
        bends: Range of j4 [rad]. Where it holds one of the two knee angles only, the four branches
            of the other are not made.
        out: OUT: (8, 8): j1 to j6 [rad], flags of what is not determined, 1 if it repeats another
            branch; knee forward first, then foot below the shin, then thigh down.

    Returns:
        `OK`, `TOO_FAR` or `TOO_NEAR`, and the first row made and the row behind the last.
    """
    px, py, pz = pose[0, 0], pose[0, 1], pose[0, 2]
    distance = sqrt(px * px + py * py + pz * pz)
    outer, inner = thigh + shin, abs(thigh - shin)
    state = OK
    if distance > outer * (1.0 + SLACK):
        state = TOO_FAR
    elif distance < inner - outer * SLACK:
        state = TOO_NEAR
    reach = clamp(distance, inner, outer)
    if state != OK:
        if distance > 0.0:
            px, py, pz = px * reach / distance, py * reach / distance, pz * reach / distance
        else:
            pz = -reach
    span = (outer - reach) * (outer + reach) * (reach - inner) * (reach + inner)
    sine = sqrt(max(span, 0.0)) / (2.0 * thigh * shin)
    cosine = (reach * reach - thigh * thigh - shin * shin) / (2.0 * thigh * shin)
    scale = _long(sine, cosine)
    sine, cosine = sine / scale, cosine / scale
    qx = pose[1, 0] * px + pose[2, 0] * py + pose[3, 0] * pz
    qy = pose[1, 1] * px + pose[2, 1] * py + pose[3, 1] * pz
    qz = pose[1, 2] * px + pose[2, 2] * py + pose[3, 2] * pz
    bend = atan2(sine, cosine)
    ahead = bends[0] - ANGLE_SLACK <= bend <= bends[1] + ANGLE_SLACK
    behind = bends[0] - ANGLE_SLACK <= -bend <= bends[1] + ANGLE_SLACK
    first = 1 if behind and not ahead else 0
    last = 1 if ahead and not behind else 2
    for knee in range(first, last):
        forward = knee == 0
        _ankle_branches(
            (thigh, shin),
            (bend if forward else -bend, sine if forward else -sine, cosine),
            (qx, qy, qz),
            pose,
            hint,
            out,
            4 * knee,
        )
    return state, 4 * first, 4 * last


@kernel
def _long(a: float, b: float) -> float:
    """Return the length of a plane vector; faster than hypot, whose care large numbers need."""
    return sqrt(a * a + b * b)


@kernel
def _opposite(angle: float) -> float:
    """Return an angle in [-π, π] turned by half a turn, in (-π, π] [rad]."""
    return angle - pi if angle > 0.0 else angle + pi


@kernel
def _ankle_branches(
    lengths: tuple[float, float],
    knee: tuple[float, float, float],
    ankle: tuple[float, float, float],
    pose: Array,
    hint: Array,
    out: Array,
    row: int,
) -> None:
    """Fill the four branches of one knee angle, from a row on.

    Args:
        lengths: Thigh and shin [length].
        knee: j4 [rad], its sine and cosine.
        ankle: The ankle from the hip, in the foot's frame [length].
        pose: As in `find_branches`.
        hint: As in `find_branches`.
        out: As in `find_branches`.
        row: First row to fill.
    """
    thigh, shin = lengths
    j4, s4, c4 = knee
    wy, wz = thigh * s4, -thigh * c4 - shin
    across = _long(ankle[0], ankle[2])
    length = _long(wy, wz)
    flags, repeats = 0, 0.0
    if abs(s4) < MERGED:
        flags += KNEE_STRAIGHT if c4 > 0.0 else KNEE_FOLDED
        repeats = 1.0 if row > 0 else 0.0
    s6, c6 = 0.0, 1.0
    on_axis = across <= MERGED * (thigh + shin)
    if on_axis:
        flags += ON_ANKLE_AXIS
        s6, c6 = sin(hint[5]), cos(hint[5])
    else:
        s6, c6 = -ankle[0] / across, -ankle[2] / across
    j6 = hint[5] if on_axis else atan2(s6, c6)
    for side in range(2):
        if side == 1:
            s6, c6, j6 = -s6, -c6, _opposite(j6)
        upward = across if side == 1 else -across
        s5, c5 = 0.0, 1.0
        if length > MERGED * (thigh + shin):
            whole = _long(ankle[1], upward) * length
            c5 = (wy * ankle[1] + wz * upward) / whole
            s5 = (wy * upward - wz * ankle[1]) / whole
        j5 = atan2(s5, c5)
        s45, c45 = s4 * c5 + c4 * s5, c4 * c5 - s4 * s5
        twice = 1.0 if on_axis and side == 1 else repeats
        _hip_branches((j4, j5, j6), (s45, c45, s6, c6), pose, hint, out, row, flags, twice)
        row += 2


@kernel
def _hip_branches(
    lower: tuple[float, float, float],
    turns: tuple[float, float, float, float],
    pose: Array,
    hint: Array,
    out: Array,
    row: int,
    flags: int,
    repeats: float,
) -> None:
    """Fill the two hip branches of known j4, j5, j6.

    Args:
        lower: j4, j5, j6 [rad].
        turns: Sine and cosine of j4 + j5, then of j6.
        pose: As in `find_branches`.
        hint: As in `find_branches`.
        out: As in `find_branches`.
        row: First row to fill.
        flags: What is not determined so far.
        repeats: 1 if these repeat another branch.
    """
    s45, c45, s6, c6 = turns
    # The hip's rotation m is foot x Ry(j6) Rx(j4 + j5).
    x0, x2 = pose[1, 0] * c6 - pose[1, 2] * s6, pose[1, 0] * s6 + pose[1, 2] * c6
    z0, z2 = pose[3, 0] * c6 - pose[3, 2] * s6, pose[3, 0] * s6 + pose[3, 2] * c6
    y2 = pose[2, 0] * s6 + pose[2, 2] * c6
    m01, m02 = pose[1, 1] * c45 + x2 * s45, x2 * c45 - pose[1, 1] * s45
    m21, m22 = pose[3, 1] * c45 + z2 * s45, z2 * c45 - pose[3, 1] * s45
    m12 = y2 * c45 - pose[2, 1] * s45
    level = _long(m02, m22)
    if level < MERGED:
        _gimbal(lower, (x0, z0, m12), hint, out, row, flags, repeats)
        return
    j1, j2 = atan2(-m02, m22), atan2(m12, level)
    # Taken behind j1, so that with a thigh almost level j3 makes good what j1 lacks in digits.
    j3 = atan2(m01 * m22 - m21 * m02, x0 * m22 - z0 * m02)
    for side in range(2):
        other = side == 1
        out[row + side, 0] = _opposite(j1) if other else j1
        out[row + side, 1] = _opposite(-j2) if other else j2
        out[row + side, 2] = _opposite(j3) if other else j3
        out[row + side, 3], out[row + side, 4], out[row + side, 5] = lower
        out[row + side, 6] = flags
        out[row + side, 7] = repeats


@kernel
def _gimbal(
    lower: tuple[float, float, float],
    hip: tuple[float, float, float],
    hint: Array,
    out: Array,
    row: int,
    flags: int,
    repeats: float,
) -> None:
    """Fill the one branch of a level thigh: j1 and j3 turn about one axis, j3 keeps its value.

    Args:
        lower: j4, j5, j6 [rad].
        hip: First and last entry of the first column of the hip's rotation, and the sine of j2.
        hint: As in `find_branches`.
        out: As in `find_branches`.
        row: Row to fill; the next repeats it.
        flags: What is not determined so far.
        repeats: 1 if these repeat another branch.
    """
    x0, z0, m12 = hip
    up = 1.0 if m12 > 0.0 else -1.0
    # With j2 at ±90° that column is (cos s, 0, sin s), s = j1 ± j3.
    total = atan2(z0, x0)
    for side in range(2):
        out[row + side, 0] = wrap_angle(total - up * hint[2])
        out[row + side, 1] = up * pi / 2.0
        out[row + side, 2] = hint[2]
        out[row + side, 3], out[row + side, 4], out[row + side, 5] = lower
        out[row + side, 6] = flags + HIP_GIMBAL
        out[row + side, 7] = 1.0 if side == 1 else repeats


@kernel
def choose(
    found: Array, rows: tuple[int, int], near: Array, low: Array, high: Array
) -> tuple[int, float]:
    """Pick the branch within limits that is nearest to a pose.

    Args:
        found: Branches as `find_branches` fills them.
        rows: First of them and the one behind the last.
        near: The pose, (6,) [rad].
        low: Limits, (6,) [rad]; -inf where free.
        high: Limits, (6,) [rad].

    Returns:
        Its index and by how much it breaks the limits [rad]; if all do, that which does least.
    """
    best, least, shortest = rows[0], inf, inf
    for branch in range(rows[0], rows[1]):
        excess, way = 0.0, 0.0
        for joint in range(6):
            angle = found[branch, joint]
            past = max(low[joint] - angle, angle - high[joint])
            if past > ANGLE_SLACK:
                excess += past
            turn = abs(angle - near[joint])
            if turn > pi:  # both within a turn around zero, as a rule: no division needed
                turn = 2.0 * pi - turn if turn <= 2.0 * pi else wrap_angle(turn)
            way += turn * turn
        if excess < least - ANGLE_SLACK or (excess <= least and way < shortest - ANGLE_SLACK):
            best, least, shortest = branch, excess, way
    return best, least


@entry
def branches(thigh: float, shin: float, pose: Array, hint: Array, out: Array) -> int:
    """As `find_branches`, for Python."""
    return find_branches(thigh, shin, pose, hint, (-inf, inf), out)[0]


@entry
def solve_poses(
    lengths: tuple[float, float],
    low: Array,
    high: Array,
    near: Array,
    poses: Array,
    chained: bool,
    found: Array,
    angles: Array,
    codes: Array,
) -> None:
    """Solve many poses.

    Args:
        lengths: Thigh and shin [length].
        low: Limits of j1 to j6, (6,) [rad]; -inf where free.
        high: As `low`.
        near: Pose the answers shall be near to, (6,) [rad]; with `chained` it becomes the last.
        poses: As in `find_branches`, (m, 4, 3).
        chained: Whether each pose is solved near the one before.
        found: Scratch, (8, 8).
        angles: OUT: (m, 6) [rad], within the limits.
        codes: OUT: `OK`, `TOO_FAR`, `TOO_NEAR` or `BEYOND_LIMITS`, then flags, (m, 2).
    """
    for row in range(poses.shape[0]):
        state, first, last = find_branches(
            lengths[0], lengths[1], poses[row], near, (low[3], high[3]), found
        )
        branch, excess = choose(found, (first, last), near, low, high)
        if state == OK and excess > 0.0:
            state = BEYOND_LIMITS
        for joint in range(6):
            angles[row, joint] = clamp(found[branch, joint], low[joint], high[joint])
            if chained:
                near[joint] = angles[row, joint]
        codes[row, 0] = state
        codes[row, 1] = int(found[branch, 6])
