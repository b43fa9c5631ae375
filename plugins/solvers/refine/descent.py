"""A damped Newton descent of the end's pose to a goal, inside the limits.

The step of smallest norm that removes the error to first order (Levenberg-Marquardt on the 6 x 6
side of the problem); hinges at a limit are left out while the step would push them further. What an
arm has to spare beyond six hinges draws it away from its limits.
"""

from math import inf, sqrt
from typing import NamedTuple

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import Matrix, Vector, clamp, norm, subtract
from limbik.core.rotation import Array
from limbik.plugins.solvers.refine.hinges import Hinges
from limbik.plugins.solvers.refine.place import (
    ACTIVE,
    ANGLE,
    MOVES,
    PULLED,
    STEP,
    TRIAL,
    place,
    rotation_vector,
    write_motions,
)

LONGEST_STEP = 1.0  # [rad]; a longer step leaves the range where the first order says something
SLOW = 0.95  # share of the squared error; a step that leaves more than this counts as slow
PATIENCE = 6  # slow steps in a row that end a descent
PULL = 1.0  # away from the limits, over the size of the error


class Goal(NamedTuple):
    """What the end shall reach."""

    place: Vector
    """World [length]."""
    turned: Matrix
    """World rotation; anything where `turning` is False."""
    turning: bool
    size: float
    """Length that counts as much as a radian."""


class Left(NamedTuple):
    """How far the end is from its goal."""

    distance: float
    """[length]"""
    angle: float
    """[rad]; 0 where the orientation does not count."""
    square: float
    """Sum of the squares of both, the distance over `Goal.size`."""


@kernel
def measure(goal: Goal, end: Vector, frame: Matrix, right: Array) -> Left:
    """Return how far a pose of the end is from the goal, and write the error as six numbers."""
    shift = subtract(goal.place, end)
    turn = (0.0, 0.0, 0.0)
    if goal.turning:
        turn = rotation_vector(goal.turned, frame)
    square = 0.0
    for i in range(3):
        right[i] = shift[i] / goal.size
        right[3 + i] = turn[i]
        square += right[i] * right[i] + turn[i] * turn[i]
    return Left(norm(shift), norm(turn), square)


@kernel
def descend(
    goal: Goal, precision: float, steps: int, hinges: Hinges, rows: Array, system: Array
) -> Left:
    """Move the angles of the rows so that the end comes nearer to the goal.

    Args:
        goal: The goal.
        precision: Share of `goal.size` and angle [rad] at which to stop.
        steps: Most steps tried.
        hinges: The chain.
        rows: (k, WIDTH); its ANGLE is changed, inside the limits.
        system: Room for the equations, (9, 6): six rows of the matrix, the error, that of a trial,
            the right side.

    Returns:
        What is left; never more than before.
    """
    end, frame = place(ANGLE, hinges, rows)
    left = measure(goal, end, frame, system[6])
    write_motions(end, goal.size, goal.turning, rows)
    damping, slow = 1e-2, 0
    for _ in range(steps):
        if left.distance <= precision * goal.size and left.angle <= precision:
            break
        _write_pull(PULL * sqrt(left.square), hinges, rows)
        _find_step(damping * min(left.square, 1.0) + 1e-12, hinges, rows, system)
        _try_step(hinges, rows)
        end, frame = place(TRIAL, hinges, rows)
        tried = measure(goal, end, frame, system[7])
        if tried.square < left.square:
            slow = slow + 1 if tried.square > SLOW * left.square else 0
            for k in range(rows.shape[0]):
                rows[k, ANGLE] = rows[k, TRIAL]
            for i in range(6):
                system[6, i] = system[7, i]
            write_motions(end, goal.size, goal.turning, rows)
            left = tried
            damping = max(damping * 0.2, 1e-6)
        else:
            slow += 1
            damping *= 10.0
        if slow > PATIENCE or damping > 1e8:
            break
    return left


@kernel
def _find_step(damping: float, hinges: Hinges, rows: Array, system: Array) -> None:
    """Write every hinge's step; blocked hinges get none, the others take over.

    With a pull p it is p + Jᵀ (J Jᵀ + damping)⁻¹ (error - J p): the part of p that moves the end is
    taken back.
    """
    count = rows.shape[0]
    for k in range(count):
        rows[k, ACTIVE] = 1.0
    for _ in range(count):
        _set_up(damping, rows, system)
        _solve(system)
        blocked = False
        for k in range(count):
            rows[k, STEP] = 0.0
            if rows[k, ACTIVE] == 0.0:
                continue
            step = rows[k, PULLED]
            for i in range(6):
                step += rows[k, MOVES + i] * system[8, i]
            angle = rows[k, ANGLE]
            if (step < 0.0 and angle <= hinges.low[k]) or (step > 0.0 and angle >= hinges.high[k]):
                rows[k, ACTIVE] = 0.0
                blocked = True
            else:
                rows[k, STEP] = step
        if not blocked:
            break


@kernel
def _write_pull(size: float, hinges: Hinges, rows: Array) -> None:
    """Write which way each hinge would go to stand away from its limits [rad]."""
    for k in range(rows.shape[0]):
        low, high = hinges.low[k], hinges.high[k]
        rows[k, PULLED] = 0.0
        if high < inf:
            off = (2.0 * rows[k, ANGLE] - low - high) / (high - low)
            rows[k, PULLED] = -size * off * off * off


@kernel
def _set_up(damping: float, rows: Array, system: Array) -> None:
    """Write J Jᵀ + damping, lower half, and error - J pull, over the active hinges."""
    for i in range(6):
        for j in range(i + 1):
            system[i, j] = 0.0
        system[i, i] = damping
        system[8, i] = system[6, i]
    for k in range(rows.shape[0]):
        if rows[k, ACTIVE] != 0.0:
            for i in range(6):
                system[8, i] -= rows[k, MOVES + i] * rows[k, PULLED]
                for j in range(i + 1):
                    system[i, j] += rows[k, MOVES + i] * rows[k, MOVES + j]


@kernel
def _solve(system: Array) -> None:
    """Solve the 6 x 6 equations by Cholesky's method; row 8 holds the right side, then w."""
    for i in range(6):
        for j in range(i):
            total = system[i, j]
            for k in range(j):
                total -= system[i, k] * system[j, k]
            system[i, j] = total / system[j, j]
        total = system[i, i]
        for k in range(i):
            total -= system[i, k] * system[i, k]
        system[i, i] = sqrt(max(total, 1e-300))
    for i in range(6):
        total = system[8, i]
        for k in range(i):
            total -= system[i, k] * system[8, k]
        system[8, i] = total / system[i, i]
    for i in range(5, -1, -1):
        total = system[8, i]
        for k in range(i + 1, 6):
            total -= system[k, i] * system[8, k]
        system[8, i] = total / system[i, i]


@kernel
def _try_step(hinges: Hinges, rows: Array) -> None:
    """Write the trial angles of a step, shortened if it is long, pulled into the limits."""
    longest = 0.0
    for k in range(rows.shape[0]):
        longest = max(longest, abs(rows[k, STEP]))
    share = min(1.0, LONGEST_STEP / max(longest, 1e-300))
    for k in range(rows.shape[0]):
        angle = rows[k, ANGLE] + share * rows[k, STEP]
        rows[k, TRIAL] = clamp(angle, hinges.low[k], hinges.high[k])
