"""Planar solves: the article's loop as it is, and one that reaches what can be reached (001)."""

from math import atan2, hypot, inf, pi

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.rotation import clamp
from limbik.core.rotation import Array
from limbik.plugins.solvers.planar.clamps import nearest_clamp, printed_clamp, printed_wrap
from limbik.plugins.solvers.planar.layout import CCD_NEAREST, FABRIK_BOTH, Links, Scratch
from limbik.plugins.solvers.planar.pairs import MOST_DECIDED, decide, finish_by_pairs
from limbik.plugins.solvers.planar.sweeps import place_links, sweep, tip_error

REACHED, STOPPED, OUT_OF_REACH = 0, 1, 2
STARTS = 16
STARTS_UNDECIDED = 96  # of long chains, whose goals nothing proves out of reach
STARTS_OUT_OF_REACH = 6  # enough to find a near pose when it is known that none reaches
WAYS = 24  # poses at the first goal from which a path with bounded steps is followed
LEAN = 0.05  # share of the way to the middle of a range
GAIN = 1e-3  # a sweep that gains a smaller share of the error is stuck
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


@entry
def new_scratch(n: int) -> Scratch:
    """Allocate the working pose of n links."""
    return Scratch(
        np.zeros(n),
        np.zeros(n),
        np.zeros(n + 1),
        np.zeros(n + 1),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
    )


@entry
def run_sweeps(
    method: int, links: Links, tx: float, ty: float, tolerance: float, most: int, start: Array
) -> tuple[int, float]:
    """Run a method as the article does: sweep until it reaches or the sweeps are used up.

    Args:
        method: Number of the method, see `layout.METHODS`.
        links: The chain.
        tx: Goal [length].
        ty: Goal [length].
        tolerance: Distance that counts as reached [length].
        most: Sweeps at most.
        start: IN/OUT: relative angles, (n,) [rad].

    Returns:
        Sweeps used and the distance left [length].
    """
    work = new_scratch(links.lengths.shape[0])
    work.relative[:] = start
    place_links(links, work)
    used = 0
    while used < most and not tip_error(tx, ty, work) <= tolerance:
        sweep(method, links, tx, ty, work)
        used += 1
    start[:] = work.relative
    return used, tip_error(tx, ty, work)


@entry
def is_reachable(links: Links, tx: float, ty: float, pose: Array) -> bool:
    """Decide whether a goal can be reached within limits, for up to `MOST_DECIDED` links.

    Args:
        links: The chain.
        tx: Goal [length].
        ty: Goal [length].
        pose: IN/OUT: relative angles to stay near, then a pose that reaches, (n,) [rad].
    """
    work = new_scratch(links.lengths.shape[0])
    work.near[:] = pose
    found = decide(links, tx, ty, work)
    if found:
        pose[:] = work.relative
    return found


@entry
def clamped(angle: float, low: float, high: float, printed: bool) -> float:
    """Clamp one relative angle, the article's way or on the circle [rad]."""
    return printed_clamp(angle, low, high) if printed else nearest_clamp(angle, low, high)


@entry
def wrapped(angle: float) -> float:
    """Return an angle as the article's convTheta does [rad]."""
    return printed_wrap(angle)


@kernel
def _halton(index: int, prime: int) -> float:
    """Return an entry of the van der Corput sequence of a prime, in (0, 1)."""
    value, share = 0.0, 1.0
    while index > 0:
        share /= prime
        value += share * (index % prime)
        index //= prime
    return value


@kernel
def _set_start(number: int, links: Links, tx: float, ty: float, work: Scratch) -> None:
    """Put the links into one of the fixed starting poses (reading A-8).

    0: the given pose; 1: its mirror at the line from base to tip; 2 and 3: arcs toward the goal;
    then points spread evenly over the ranges. All are clamped.
    """
    n = links.lengths.shape[0]
    if number == 1:
        for k in range(n):
            work.relative[k] = work.near[k]
        place_links(links, work)
        line = atan2(work.y[n], work.x[n])
        for k in range(n):
            work.relative[k] = -work.near[k] + (2.0 * line if k == 0 else 0.0)
    for k in range(n):
        angle = work.relative[k]
        bound = links.high[k] < inf and links.high[k] - links.low[k] < 2.0 * pi
        if number == 0:
            angle = work.near[k]
        elif number == 2 or number == 3:
            bend = 1.5 / n if number == 2 else -1.5 / n
            angle = atan2(ty, tx) - bend * (n - 1) / 2.0 if k == 0 else bend
        elif number > 3:
            low = links.low[k] if bound else -pi
            high = links.high[k] if bound else pi
            index = number - 3 + k // len(PRIMES)
            angle = low + (high - low) * _halton(index, PRIMES[k % len(PRIMES)])
        work.relative[k] = nearest_clamp(angle, links.low[k], links.high[k])


@kernel
def _keep_best(least: float, tx: float, ty: float, links: Links, work: Scratch) -> float:
    """Note the working pose if it is the nearest so far; return the least distance [length]."""
    place_links(links, work)
    error = tip_error(tx, ty, work)
    if not error < least:
        return least
    for k in range(work.best.shape[0]):
        work.best[k] = work.relative[k]
    return error


@kernel
def _run(
    method: int, links: Links, tx: float, ty: float, tolerance: float, most: int, work: Scratch
) -> int:
    """Sweep until the goal is reached or a sweep gains too little; return the sweeps used."""
    place_links(links, work)
    before = tip_error(tx, ty, work)
    for used in range(most):
        if before <= tolerance:
            return used
        sweep(method, links, tx, ty, work)
        if method == FABRIK_BOTH:  # turning each link frees those that pulled each other stuck
            sweep(CCD_NEAREST, links, tx, ty, work)
        error = tip_error(tx, ty, work)
        if error > before * (1.0 - GAIN):
            return used + 1
        before = error
    return most


@kernel
def _solve(
    method: int, links: Links, tx: float, ty: float, tolerance: float, most: int, work: Scratch
) -> tuple[int, int]:
    """Solve one goal from `work.near`; `work.best` becomes the pose.

    Returns:
        `REACHED`, `STOPPED` or `OUT_OF_REACH`, and the sweeps used.
    """
    n = links.lengths.shape[0]
    least, total = inf, 0
    starts = STARTS if n <= MOST_DECIDED else STARTS_UNDECIDED
    known_out = False
    for number in range(STARTS_UNDECIDED):
        if number >= starts:
            break
        _set_start(number, links, tx, ty, work)
        # Where one kind of sweep is stuck the other often is not.
        kind = CCD_NEAREST if number % 2 == 1 else method
        total += _run(kind, links, tx, ty, tolerance, most, work)
        least = _keep_best(least, tx, ty, links, work)
        if least <= tolerance:
            return REACHED, total
        if not known_out and finish_by_pairs(links, tx, ty, work):
            least = _keep_best(least, tx, ty, links, work)
            if least <= tolerance:
                return REACHED, total
        if number == 0 and n <= MOST_DECIDED:
            known_out = not decide(links, tx, ty, work)
        elif number == 0:
            known_out = hypot(tx, ty) > float(links.lengths.sum()) + tolerance
        if known_out:
            starts = STARTS_OUT_OF_REACH
    if known_out:
        return OUT_OF_REACH, total
    if n <= MOST_DECIDED and decide(links, tx, ty, work):
        least = _keep_best(least, tx, ty, links, work)
    return (REACHED if least <= tolerance else STOPPED), total


@entry
def solve_goals(
    method: int,
    links: Links,
    goals: Array,
    tolerance: float,
    most: int,
    step: float,
    chained: bool,
    continued: bool,
    start: Array,
    angles: Array,
    numbers: Array,
) -> None:
    """Solve many goals, each from a starting pose or, chained, from the pose before.

    A path with bounded steps can run into a limit it should have gone around: it is followed
    from other poses at its first goal too, until one way reaches all goals; else the way with
    the least largest distance is kept.

    Args:
        method: `CCD_NEAREST` or `FABRIK_BOTH`.
        links: The chain, n links.
        goals: (m, 2) [length].
        tolerance: Distance that counts as reached [length].
        most: Sweeps at most from each starting pose.
        step: Largest turn of a joint from goal to goal [rad]; 0 = unbounded. Only when chained.
        chained: Whether the goals are a path.
        continued: Whether the path comes from `start`: its first step is bounded too, and no other
            pose is tried at its first goal.
        start: Relative angles, (n,) [rad].
        angles: OUT: relative angles, (m, n) [rad], within limits.
        numbers: OUT: status, sweeps, distance [length], (m, 3).
    """
    work = new_scratch(links.lengths.shape[0])
    box = Links(links.lengths, links.low.copy(), links.high.copy())
    bounded = chained and step > 0.0
    poses, counts = np.empty_like(angles), np.empty_like(numbers)
    least = inf
    for way in range(WAYS if bounded and not continued else 1):
        for k in range(start.shape[0]):
            work.near[k] = nearest_clamp(start[k], links.low[k], links.high[k])
        if way > 0:
            _set_start(way, links, goals[0, 0], goals[0, 1], work)
            for k in range(start.shape[0]):
                work.near[k] = work.relative[k]
        _follow(
            method,
            links,
            box,
            goals,
            tolerance,
            most,
            step if bounded else 0.0,
            chained,
            continued,
            work,
            poses,
            counts,
        )
        worst = 0.0
        for row in range(goals.shape[0]):
            worst = max(worst, counts[row, 2])
        if worst < least or way == 0:
            least = worst
            angles[:] = poses
            numbers[:] = counts
        if worst <= tolerance:
            break


@kernel
def _follow(
    method: int,
    links: Links,
    box: Links,
    goals: Array,
    tolerance: float,
    most: int,
    step: float,
    chained: bool,
    continued: bool,
    work: Scratch,
    angles: Array,
    numbers: Array,
) -> None:
    """Solve goals in order; the arguments are those of `solve_goals`, `box` holds the steps."""
    n = links.lengths.shape[0]
    for k in range(n):
        box.low[k], box.high[k] = links.low[k], links.high[k]
    for row in range(goals.shape[0]):
        if step > 0.0 and (row > 0 or continued):
            _bound_steps(links, box, step, work)
        tx, ty = goals[row, 0], goals[row, 1]
        state, sweeps = _solve(method, box, tx, ty, tolerance, most, work)
        for k in range(n):
            angle = work.best[k]
            if links.high[k] < inf:
                angle = clamp(angle, links.low[k], links.high[k])
            angles[row, k] = work.relative[k] = angle
            if chained:
                work.near[k] = angle
        place_links(links, work)
        numbers[row, 0], numbers[row, 1] = state, sweeps
        numbers[row, 2] = tip_error(tx, ty, work)


@kernel
def _bound_steps(links: Links, box: Links, step: float, work: Scratch) -> None:
    """Narrow the ranges to one step around the last pose, and lean it toward the middle.

    Leaning uses what freedom a goal leaves to stay clear of the limits ahead.
    """
    for k in range(links.lengths.shape[0]):
        last = work.near[k]
        box.low[k] = max(links.low[k], last - step)
        box.high[k] = min(links.high[k], last + step)
        if links.high[k] < inf:
            middle = (links.low[k] + links.high[k]) / 2.0
            work.near[k] = last + clamp(LEAN * (middle - last), -step, step)
