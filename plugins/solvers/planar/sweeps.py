"""One sweep of planar CCD or FABRIK, with the article's variants and the repaired ones (001)."""

from math import atan2, cos, hypot, inf, sin

from limbik.core.jit import kernel
from limbik.plugins.solvers.planar.clamps import nearest_clamp, printed_clamp, printed_wrap
from limbik.plugins.solvers.planar.layout import (
    CCD,
    CCD_CHASE,
    CCD_NEAREST,
    FABRIK,
    FABRIK_BOTH,
    FABRIK_CHILD,
    FABRIK_FORWARD,
    FABRIK_LIMIT,
    Links,
    Scratch,
)

NO_DIRECTION = 1e-12  # share of the length; nearer to a pivot there is no direction to turn to


@kernel
def place_links(links: Links, work: Scratch) -> None:
    """Make ground angles and places of the relative angles."""
    total = 0.0
    work.x[0], work.y[0] = 0.0, 0.0
    for i in range(links.lengths.shape[0]):
        total += work.relative[i]
        work.angle[i] = total
        work.x[i + 1] = work.x[i] + links.lengths[i] * cos(total)
        work.y[i + 1] = work.y[i] + links.lengths[i] * sin(total)


@kernel
def tip_error(tx: float, ty: float, work: Scratch) -> float:
    """Return the distance of the tip from the goal [length]."""
    n = work.angle.shape[0]
    return hypot(work.x[n] - tx, work.y[n] - ty)


@kernel
def sweep(method: int, links: Links, tx: float, ty: float, work: Scratch) -> None:
    """Run one sweep over all links.

    Args:
        method: Number of the method, see `layout.METHODS`.
        links: The chain.
        tx: Goal [length].
        ty: Goal [length].
        work: The pose, changed in place; `relative` rules.
    """
    place_links(links, work)
    if method <= CCD_CHASE or method == CCD_NEAREST:
        for i in range(links.lengths.shape[0] - 1, -1, -1):
            if method == CCD_CHASE:
                _chase(i, links, tx, ty, work)
            else:
                _turn(method, i, links, tx, ty, work)
            place_links(links, work)
    else:
        _backward(method, links, tx, ty, work)
        _forward(method, links, work)
        place_links(links, work)


@kernel
def _turn(method: int, i: int, links: Links, tx: float, ty: float, work: Scratch) -> None:
    """Turn link i and all beyond it as one body (reading A-3)."""
    n = work.angle.shape[0]
    to_x, to_y = tx - work.x[i], ty - work.y[i]
    tip_x, tip_y = work.x[n] - work.x[i], work.y[n] - work.y[i]
    if method == CCD_NEAREST:  # on the pivot rounding alone would choose the turn (reading A-10)
        shortest = NO_DIRECTION * links.lengths[i]
        if hypot(to_x, to_y) < shortest or hypot(tip_x, tip_y) < shortest:
            return
    wanted = work.relative[i] + atan2(to_y, to_x) - atan2(tip_y, tip_x)
    if method == CCD:
        work.relative[i] = printed_wrap(wanted)
    elif method == CCD_NEAREST:
        work.relative[i] = nearest_clamp(wanted, links.low[i], links.high[i])
    else:
        work.relative[i] = printed_clamp(wanted, links.low[i], links.high[i])


@kernel
def _chase(i: int, links: Links, tx: float, ty: float, work: Scratch) -> None:
    """Turn link i; each link beyond aims at where the turn without limits would have put it."""
    n = work.angle.shape[0]
    pivot_x, pivot_y = work.x[i], work.y[i]
    turn = atan2(ty - pivot_y, tx - pivot_x) - atan2(work.y[n] - pivot_y, work.x[n] - pivot_x)
    c, s = cos(turn), sin(turn)
    before = work.angle[i - 1] if i > 0 else 0.0
    at_x, at_y = pivot_x, pivot_y
    for k in range(i, n):
        away_x, away_y = work.x[k + 1] - pivot_x, work.y[k + 1] - pivot_y
        aim_x, aim_y = pivot_x + c * away_x - s * away_y, pivot_y + s * away_x + c * away_y
        wanted = atan2(aim_y - at_y, aim_x - at_x) - before
        work.relative[k] = printed_clamp(wanted, links.low[k], links.high[k])
        before += work.relative[k]
        at_x += links.lengths[k] * cos(before)
        at_y += links.lengths[k] * sin(before)


@kernel
def _backward(method: int, links: Links, tx: float, ty: float, work: Scratch) -> None:
    """Pull the links to the goal, tip first; `x`, `y` end as where each link's far end was put."""
    n = work.angle.shape[0]
    to_x, to_y = tx, ty
    after = 0.0
    for i in range(n - 1, -1, -1):
        angle = atan2(to_y - work.y[i], to_x - work.x[i])
        if method == FABRIK_LIMIT:
            before = work.angle[i - 1] if i > 0 else 0.0
            angle = before + printed_clamp(angle - before, links.low[i], links.high[i])
        elif method == FABRIK_CHILD:
            angle = after + printed_clamp(angle - after, links.low[i], links.high[i])
        elif method == FABRIK_BOTH and i < n - 1 and links.high[i + 1] < inf:
            angle = after - nearest_clamp(after - angle, links.low[i + 1], links.high[i + 1])
        work.angle[i] = angle
        after = angle
        work.x[i + 1], work.y[i + 1] = to_x, to_y
        to_x -= links.lengths[i] * cos(angle)
        to_y -= links.lengths[i] * sin(angle)


@kernel
def _forward(method: int, links: Links, work: Scratch) -> None:
    """Put the links back on the base, each aiming at where its far end was put (reading A-5)."""
    before, at_x, at_y = 0.0, 0.0, 0.0
    for i in range(work.angle.shape[0]):
        wanted = atan2(work.y[i + 1] - at_y, work.x[i + 1] - at_x) - before
        if method == FABRIK:
            work.relative[i] = printed_wrap(wanted)
        elif method in (FABRIK_LIMIT, FABRIK_FORWARD, FABRIK_CHILD):
            work.relative[i] = printed_clamp(wanted, links.low[i], links.high[i])
        else:
            work.relative[i] = nearest_clamp(wanted, links.low[i], links.high[i])
        before += work.relative[i]
        at_x += links.lengths[i] * cos(before)
        at_y += links.lengths[i] * sin(before)
