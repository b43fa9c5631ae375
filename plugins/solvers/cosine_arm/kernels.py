"""Closed form of the cosine arm, compiled (004; readings C-1 to C-7).

Right-handed, Z up. D1 turns about z from +x, D2 leans from the vertical toward the goal, D3 bends
on from there; all zero is straight up.
"""

from math import atan2, hypot, inf, pi, sqrt

from limbik.core.jit import entry, kernel
from limbik.core.kernels.rotation import clamp, wrap_angle
from limbik.core.rotation import Array

OK, TOO_FAR, TOO_NEAR, BEYOND_LIMITS = 0, 1, 2, 3
ON_AXIS, STRAIGHT, FOLDED = 1, 2, 4
SLACK = 1e-9  # share of the reach that counts as on its border
ANGLE_SLACK = 1e-9  # [rad] past a limit that is rounding
MERGED = 1e-7  # [rad]; elbows this near to straight or folded are one pose


@kernel
def find_branches(
    size: tuple[float, float, float],
    point: tuple[float, float, float],
    yaw: float,
    out: Array,
) -> tuple[int, int]:
    """Find all poses that reach a point, the source's own first.

    Args:
        size: Height of the shoulder, length of upper arm and forearm [length].
        point: The goal [length]; one out of reach is first moved to the nearest point in reach.
        yaw: D1 to keep where the goal is above the shoulder [rad].
        out: OUT: D1, D2, D3 of front up, front down, back up, back down, (4, 3) [rad].

    Returns:
        `OK`, `TOO_FAR` or `TOO_NEAR`, and the sum of `ON_AXIS`, `STRAIGHT`, `FOLDED`.
    """
    height, upper, fore = size
    rho, rise = hypot(point[0], point[1]), point[2] - height
    outer, inner = upper + fore, abs(upper - fore)
    distance = hypot(rho, rise)
    state = OK
    if distance > outer * (1.0 + SLACK):
        state = TOO_FAR
    elif distance < inner - outer * SLACK:
        state = TOO_NEAR
    distance = clamp(distance, inner, outer)
    flags = 0
    turn = atan2(point[1], point[0])
    if rho <= outer * SLACK:
        flags = ON_AXIS
        turn = wrap_angle(yaw)
        rho = 0.0
    # Products of differences keep their digits at both borders, where 1 - cos² has none left.
    span = (outer - distance) * (outer + distance) * (distance - inner) * (distance + inner)
    sine = sqrt(max(span, 0.0)) / (2.0 * upper * fore)
    cosine = (distance * distance - upper * upper - fore * fore) / (2.0 * upper * fore)
    bend = atan2(sine, cosine)
    if bend < MERGED:
        flags += STRAIGHT
    elif bend > pi - MERGED:
        flags += FOLDED
    inside = atan2(fore * sine, upper + fore * cosine)
    for branch in range(4):
        back, down = branch >= 2, branch % 2 == 1
        lean = atan2(-rho if back else rho, rise)
        out[branch, 0] = wrap_angle(turn + pi) if back else turn
        out[branch, 1] = wrap_angle(lean + inside if down else lean - inside)
        out[branch, 2] = -bend if down else bend
    return state, flags


@entry
def branches(
    size: tuple[float, float, float],
    point: tuple[float, float, float],
    yaw: float,
    out: Array,
) -> tuple[int, int]:
    """As `find_branches`, for Python."""
    return find_branches(size, point, yaw, out)


@kernel
def choose(found: Array, near: Array, low: Array, high: Array) -> tuple[int, float]:
    """Pick the branch within limits that is nearest to a pose.

    Args:
        found: Branches, (k, j) [rad].
        near: The pose, (j,) [rad].
        low: Limits, (j,) [rad]; -inf where free.
        high: Limits, (j,) [rad].

    Returns:
        Its index and by how much it breaks the limits [rad]; if all do, that which does least.
    """
    best, least, shortest = 0, inf, inf
    for branch in range(found.shape[0]):
        excess, way = 0.0, 0.0
        for joint in range(found.shape[1]):
            angle = found[branch, joint]
            past = max(low[joint] - angle, angle - high[joint], 0.0)
            if past > ANGLE_SLACK:
                excess += past
            way += wrap_angle(angle - near[joint]) ** 2
        if excess < least - ANGLE_SLACK or (excess <= least and way < shortest - ANGLE_SLACK):
            best, least, shortest = branch, excess, way
    return best, least


@entry
def solve_goals(
    size: tuple[float, float, float],
    low: Array,
    high: Array,
    near: Array,
    goals: Array,
    chained: bool,
    found: Array,
    angles: Array,
    codes: Array,
) -> None:
    """Solve many goals.

    Args:
        size: As in `find_branches`.
        low: Limits of D1, D2, D3, (3,) [rad]; -inf where free.
        high: As `low`.
        near: Pose the answer shall be near to, (3,) [rad]; with `chained` it becomes the last.
        goals: (m, 3) [length].
        chained: Whether each goal is solved near the pose of the one before.
        found: Scratch, (4, 3).
        angles: OUT: (m, 3) [rad], within the limits.
        codes: OUT: `OK`, `TOO_FAR`, `TOO_NEAR` or `BEYOND_LIMITS`, then flags, (m, 2).
    """
    for row in range(goals.shape[0]):
        point = (goals[row, 0], goals[row, 1], goals[row, 2])
        state, flags = find_branches(size, point, near[0], found)
        branch, excess = choose(found, near, low, high)
        if state == OK and excess > 0.0:
            state = BEYOND_LIMITS
        for joint in range(3):
            angles[row, joint] = clamp(found[branch, joint], low[joint], high[joint])
            if chained:
                near[joint] = angles[row, joint]
        codes[row, 0] = state
        codes[row, 1] = flags
