"""Exact steps of planar chains: two joints in closed form, and with them the decision itself.

Two joints that move while the others stand still are a triangle. Were a goal reachable at all, it
would be reachable in a pose where every joint but two stands on a limit or has all that follows it
on one line: the angle of the first moving joint, as small as the goal allows, ends on a limit or
where the rest of the chain is stretched toward the goal. There are finitely many such poses, so
trying them all decides (reading A-9).
"""

from math import atan2, cos, hypot, inf, pi, sin, sqrt

from limbik.core.jit import kernel
from limbik.plugins.solvers.planar.clamps import SLACK, excess, nearest_clamp, printed_wrap
from limbik.plugins.solvers.planar.layout import Links, Scratch

SHORT = 1e-12  # share of the chain's length that is rounding
MOST_DECIDED = 6  # links; 3^n poses are tried


@kernel
def _segment(first: int, last: int, links: Links, work: Scratch) -> tuple[float, float, float]:
    """Return the stiff body of links first..last-1 in the frame of the first one.

    Returns:
        Its length, the direction of its far end, and the angle of its last link [rad].
    """
    x, y, angle = links.lengths[first], 0.0, 0.0
    for k in range(first + 1, last):
        angle += work.trial[k]
        x += links.lengths[k] * cos(angle)
        y += links.lengths[k] * sin(angle)
    return hypot(x, y), atan2(y, x), angle


@kernel
def solve_pair(
    i: int, j: int, side: float, links: Links, tx: float, ty: float, work: Scratch
) -> bool:
    """Reach the goal with joints i and j alone, the others as in `work.trial`.

    Args:
        i: The joint nearer to the base.
        j: The other one.
        side: 1 or -1, the side the elbow lies on.
        links: The chain.
        tx: Goal [length].
        ty: Goal [length].
        work: `trial` is changed at i and j where it succeeds or not; `near` decides what the goal
            leaves open.

    Returns:
        Whether the goal is reached within limits.
    """
    n = links.lengths.shape[0]
    ground, x, y, whole = 0.0, 0.0, 0.0, 0.0
    for k in range(n):
        whole += links.lengths[k]
        if k < i:
            ground += work.trial[k]
            x += links.lengths[k] * cos(ground)
            y += links.lengths[k] * sin(ground)
    a, a_way, a_end = _segment(i, j, links, work)
    b, b_way, _ = _segment(j, n, links, work)
    d = hypot(tx - x, ty - y)
    slack = SHORT * whole
    if d > a + b + slack or d < abs(a - b) - slack:
        return False
    aim = atan2(ty - y, tx - x)
    if d <= slack or a <= slack:  # any direction does: keep the one there is
        kept = nearest_clamp(work.near[i], links.low[i], links.high[i])
        a_turn = ground + kept + a_way
        b_turn = aim if a <= slack else a_turn + pi
    else:
        area = (a + b + d) * max(a + b - d, 0.0) * max(d + a - b, 0.0) * max(d + b - a, 0.0)
        root = sqrt(area)
        a_turn = aim - side * atan2(root, a * a + d * d - b * b)
        b_turn = a_turn + side * atan2(root, d * d - a * a - b * b)
    own = a_turn - a_way
    first, second = own - ground, b_turn - b_way - own - a_end
    if b <= slack:
        second = work.near[j]
    work.trial[i] = nearest_clamp(first, links.low[i], links.high[i])
    work.trial[j] = nearest_clamp(second, links.low[j], links.high[j])
    return (
        excess(first, links.low[i], links.high[i]) <= SLACK
        and excess(second, links.low[j], links.high[j]) <= SLACK
    )


@kernel
def _largest_move(work: Scratch) -> float:
    """Return how far the trial is from `near`, at the joint that moves most [rad]."""
    most = 0.0
    for k in range(work.trial.shape[0]):
        most = max(most, abs(printed_wrap(work.trial[k] - work.near[k])))
    return most


@kernel
def finish_by_pairs(links: Links, tx: float, ty: float, work: Scratch) -> bool:
    """Reach the goal exactly by two joints of the working pose, those that then move least.

    Args:
        links: The chain.
        tx: Goal [length].
        ty: Goal [length].
        work: `relative` becomes the pose found.

    Returns:
        Whether two joints can.
    """
    n = links.lengths.shape[0]
    least, best_i, best_j, best_side = inf, 0, 0, 1.0
    for i in range(n - 1):
        for j in range(i + 1, n):
            for turn in range(2):
                side = 1.0 - 2.0 * turn
                for k in range(n):
                    work.trial[k] = work.relative[k]
                if solve_pair(i, j, side, links, tx, ty, work):
                    move = _largest_move(work)
                    if move < least:
                        least, best_i, best_j, best_side = move, i, j, side
    if least < inf:
        for k in range(n):
            work.trial[k] = work.relative[k]
        solve_pair(best_i, best_j, best_side, links, tx, ty, work)
        for k in range(n):
            work.relative[k] = work.trial[k]
    return least < inf


@kernel
def decide(links: Links, tx: float, ty: float, work: Scratch) -> bool:
    """Decide whether a goal can be reached within limits, for up to `MOST_DECIDED` links.

    Args:
        links: The chain, n links.
        tx: Goal [length].
        ty: Goal [length].
        work: `relative` becomes the pose found that is nearest to `near`.

    Returns:
        Whether it can.
    """
    n = links.lengths.shape[0]
    least = inf
    for state in range(3**n):
        free = _hold(state, links, work)
        if free < 2:
            continue
        for line in range(2 ** (free - 2)):
            i, j = _stretch(state, line, links, work)
            if i < 0:
                continue
            for turn in range(2):
                if solve_pair(i, j, 1.0 - 2.0 * turn, links, tx, ty, work):
                    move = _largest_move(work)
                    if move < least:
                        least = move
                        for k in range(n):
                            work.relative[k] = work.trial[k]
    return least < inf


@kernel
def _hold(state: int, links: Links, work: Scratch) -> int:
    """Put the joints a state holds on their limits; a free one has one place to be held at.

    Returns:
        How many joints are left to move; 0 for a state that repeats another.
    """
    free = 0
    for k in range(links.lengths.shape[0]):
        digit, state = state % 3, state // 3
        bound = links.high[k] < inf and links.high[k] - links.low[k] < 2.0 * pi
        if digit == 2:
            free += 1
        elif bound:
            work.trial[k] = links.low[k] if digit == 0 else links.high[k]
        elif digit == 0:
            work.trial[k] = work.near[k]
        else:
            return 0
    return free


@kernel
def _stretch(state: int, line: int, links: Links, work: Scratch) -> tuple[int, int]:
    """Lay the segments behind the second moving joint on one line, forward or folded back.

    Args:
        state: Which joints move, as in `_hold`.
        line: One bit a joint from the third on: folded back.
        links: The chain.
        work: `trial` is filled in.

    Returns:
        The first two moving joints; -1 where a limit forbids the line.
    """
    n = links.lengths.shape[0]
    first, second, before = -1, -1, -1
    rest = state
    for k in range(n):
        digit, rest = rest % 3, rest // 3
        if digit != 2:
            continue
        if first < 0:
            first = k
        elif second < 0:
            second = before = k
        else:
            after, left = n, rest
            for m in range(k + 1, n):
                if left % 3 == 2:
                    after = m
                    break
                left //= 3
            _, way, end = _segment(before, k, links, work)
            _, next_way, _ = _segment(k, after, links, work)
            wanted = way - end - next_way + (pi if line % 2 == 1 else 0.0)
            line //= 2
            if excess(wanted, links.low[k], links.high[k]) > SLACK:
                return -1, -1
            work.trial[k] = nearest_clamp(wanted, links.low[k], links.high[k])
            before = k
    return first, second
