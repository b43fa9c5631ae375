"""Solving pose goals: descents from the pose before, then from starts spread over the ranges."""

from math import inf, isnan, pi, sqrt
from typing import NamedTuple

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.rotation import (
    add,
    clamp,
    matrix,
    norm,
    rotate,
    store_vector,
    subtract,
    vector,
    wrap_angle,
)
from limbik.core.rotation import Array
from limbik.plugins.solvers.refine.descent import Goal, Left, descend, measure
from limbik.plugins.solvers.refine.hinges import Hinges, Joints, Span
from limbik.plugins.solvers.refine.place import (
    ANGLE,
    BEST,
    NEAR,
    WIDTH,
    Poses,
    place,
    place_joints,
)

# Numbers of `limbik.core.solution.Status`.
REACHED, STOPPED, OUT_OF_REACH, BLOCKED = 0, 1, 2, 3
STEADINESS = 0.002  # share of the error by which a later start must be nearer
BESIDE, BESIDE_STARTS = 0.4, 8  # how far [rad] and how many starts beside the pose before
LEAP = 0.5  # [rad]; a pose this near to the one before is taken at once
STEEP = 20.0  # turn over the step of the goal, with `Goal.size` as a radian, that is a jump
COMPARED = 8  # folds found on a path before the nearest to the pose before is taken
FEW_STARTS = 2  # toward a goal that the bones do not span
UNLIMITED_STARTS = 24  # to find out whether limits are the reason


class Effort(NamedTuple):
    """How exactly and how long to search."""

    tolerance: float
    """Distance that counts as reached [length]."""
    angle: float
    """Angle that counts as reached [rad]."""
    precision: float
    """Share of the size and angle [rad] aimed at."""
    size: float
    """Length that counts as much as a radian."""
    steps: int
    starts: int


@kernel
def _is_met(left: Left, effort: Effort) -> bool:
    return left.distance < effort.tolerance and left.angle < effort.angle


@kernel
def _copy(source: int, out: int, rows: Array) -> None:
    for k in range(rows.shape[0]):
        rows[k, out] = rows[k, source]


@kernel
def _beside(attempt: int, spacing: Array, hinges: Hinges, rows: Array) -> None:
    """Write the angles of a start beside the pose before, a little farther each time."""
    radius = BESIDE * (attempt + 1.0) / BESIDE_STARTS
    for k in range(rows.shape[0]):
        share = (0.5 + (attempt + 1) * spacing[k]) % 1.0
        angle = rows[k, NEAR] + radius * (2.0 * share - 1.0)
        rows[k, ANGLE] = clamp(angle, hinges.low[k], hinges.high[k])


@kernel
def _spread(attempt: int, spacing: Array, hinges: Hinges, rows: Array) -> None:
    """Write the angles of a start: evenly spread over the ranges, the middles first."""
    for k in range(rows.shape[0]):
        low, high = hinges.low[k], hinges.high[k]
        share = (0.5 + attempt * spacing[k]) % 1.0
        rows[k, ANGLE] = low + share * (high - low) if high < inf else 2.0 * pi * (share - 0.5)


@kernel
def _way(rows: Array) -> float:
    """Return the largest turn from the pose before [rad]."""
    way = 0.0
    for k in range(rows.shape[0]):
        way = max(way, abs(rows[k, ANGLE] - rows[k, NEAR]))
    return way


@kernel
def _search(
    goal: Goal,
    effort: Effort,
    hinges: Hinges,
    spacing: Array,
    chained: bool,
    rows: Array,
    system: Array,
) -> tuple[Left, int]:
    """Leave the best pose in BEST: the first that reaches the goal, or the nearest of several.

    Args:
        goal: The goal.
        effort: How exactly and how long to search.
        hinges: k hinges.
        spacing: Steps of the spread starts, (k,).
        chained: Whether the answer shall be near the pose in NEAR, from which the search begins.
        rows: (k, WIDTH).
        system: Room for the equations.

    Returns:
        What is left, and the number of starts used; 0 if the pose before led to the goal.
    """
    _copy(NEAR, ANGLE, rows)
    best = descend(goal, effort.precision, effort.steps, hinges, rows, system)
    _copy(ANGLE, BEST, rows)
    if _is_met(best, effort):
        return best, 0
    found, shortest = 0, inf
    beside = min(effort.starts, BESIDE_STARTS) if chained else 0
    for attempt in range(beside + effort.starts):
        if attempt < beside:
            _beside(attempt, spacing, hinges, rows)
        else:
            _spread(attempt - beside, spacing, hinges, rows)
        left = descend(goal, effort.precision, effort.steps, hinges, rows, system)
        if _is_met(left, effort):
            found += 1
            way = _way(rows)
            if found == 1 or way < shortest:
                best, shortest = left, way
                _copy(ANGLE, BEST, rows)
            if not chained or way < LEAP or found >= COMPARED:
                return best, attempt + 1
        # Where none reaches it, an early one stays the answer until a later is clearly nearer.
        elif found == 0 and left.square < best.square * (1.0 - STEADINESS):
            best = left
            _copy(ANGLE, BEST, rows)
    return best, beside + effort.starts


@kernel
def _spans(goal: Goal, effort: Effort, span: Span) -> bool:
    """Return whether the bones, were they free to fold, span the way to the goal.

    Behind the last hinge nothing moves, so a pose of the end says where that hinge must be.
    """
    hand = vector(span.hand, 0)
    total, longest = span.bones[0], span.bones[1]
    target, slack = goal.place, effort.tolerance
    if goal.turning:
        target = add(target, rotate(goal.turned, hand))
        slack += effort.angle * norm(hand)
    else:
        total += norm(hand)
        longest = max(longest, norm(hand))
    distance = norm(subtract(target, vector(span.start, 0)))
    return bool(2.0 * longest - total - slack <= distance <= total + slack)


@kernel
def _with_starts(effort: Effort, starts: int) -> Effort:
    return Effort(
        effort.tolerance, effort.angle, effort.precision, effort.size, effort.steps, starts
    )


@entry
def solve_goals(
    hinges: Hinges,
    joints: Joints,
    span: Span,
    effort: Effort,
    spacing: Array,
    goals: Array,
    rotations: Array,
    chained: bool,
    near: Array,
    poses: Poses,
    numbers: Array,
) -> None:
    """Solve many goals.

    Args:
        hinges: k hinges.
        joints: The chain they are part of.
        span: What their bones can span.
        effort: How exactly and how long to search.
        spacing: Steps of the spread starts, (k,), shares of the ranges.
        goals: World positions, (m, 3) [length].
        rotations: World rotations, (m, 3, 3); NaN where the orientation does not count.
        chained: Whether each goal is solved from the pose of the one before.
        near: The pose to start from, (k,) [rad]; with `chained` it becomes the last.
        poses: OUT: m poses, within the limits.
        numbers: OUT: status, starts used beside the pose before, distance, angle, and whether the
            pose jumped away from the one before, (m, 5).
    """
    count = near.shape[0]
    rows, system = np.zeros((count, WIDTH)), np.zeros((9, 6))
    free = np.full(count, inf)
    unlimited = Hinges(hinges.axis, hinges.shift, hinges.before, -free, free)
    for row in range(goals.shape[0]):
        turned = matrix(rotations, row)
        goal = Goal(vector(goals, row), turned, not isnan(turned[0][0]), effort.size)
        for k in range(count):
            rows[k, NEAR] = near[k]
        spanned = _spans(goal, effort, span)
        tried = effort if spanned else _with_starts(effort, min(effort.starts, FEW_STARTS))
        end, frame = place(NEAR, hinges, rows)
        step = sqrt(measure(goal, end, frame, system[7]).square)
        left, used = _search(goal, tried, hinges, spacing, chained, rows, system)
        way = 0.0
        for joint in range(joints.resting.shape[0]):
            store_vector(vector(joints.resting, joint), poses.angles[row], joint)
        for k in range(count):
            angle = rows[k, BEST]
            if hinges.high[k] == inf:
                angle = near[k] + wrap_angle(angle - near[k])
            poses.angles[row, joints.joint[k], hinges.axis[k]] = angle
            way = max(way, abs(angle - near[k]))
            if chained:
                near[k] = angle
        place_joints(row, joints, poses)
        last = joints.resting.shape[0] - 1
        end, frame = vector(poses.positions[row], last), matrix(poses.rotations[row], last)
        left = measure(goal, end, frame, system[7])
        status = REACHED if _is_met(left, effort) else OUT_OF_REACH
        if status != REACHED and spanned:
            tried = _with_starts(effort, UNLIMITED_STARTS)
            ideal, _ = _search(goal, tried, unlimited, spacing, False, rows, system)
            status = BLOCKED if _is_met(ideal, effort) else STOPPED
        # Far, and not on the way from the pose before or farther than the goal's step explains.
        jumped = way > LEAP and (used > BESIDE_STARTS or way > STEEP * step)
        numbers[row, 0], numbers[row, 1] = status, used
        numbers[row, 2], numbers[row, 3] = left.distance, left.angle
        numbers[row, 4] = 1.0 if chained and row > 0 and status == REACHED and jumped else 0.0
