"""The limit ease: in CCD a joint slows down as it nears a limit (M-09).

Within the zone before a limit a step that would lead on by d leaves gap · exp(-d / zone) of the
gap: the first part of a step into the zone passes whole, and no step comes to the limit. A step
back is not slowed.
"""

from math import exp, inf

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import Vector


@kernel
def eased_gap(gap: float, step: float, zone: float) -> float:
    """Return what a step toward a limit leaves of the gap to it [rad].

    Args:
        gap: Before the step, at least 0 [rad].
        step: Toward the limit, at most the gap [rad].
        zone: Width of the zone before the limit, above 0 [rad].
    """
    left = gap - step
    if not step > 0.0 or left >= zone:
        return left
    start = min(gap, zone)
    return start * exp(-(step - (gap - start)) / zone)


@kernel
def eased(before: Vector, after: Vector, low: Vector, high: Vector, zone: float) -> Vector:
    """Return the angles of a turn with each axis slowed that nears an end of its range.

    Args:
        before: HPB inside low..high [rad].
        after: HPB inside low..high [rad].
        low: [rad], -inf where free.
        high: [rad], inf where free.
        zone: Width of the zones [rad]; in a narrow range at most half of it. 0 = off.
    """
    return (
        _eased_axis(before[0], after[0], low[0], high[0], zone),
        _eased_axis(before[1], after[1], low[1], high[1], zone),
        _eased_axis(before[2], after[2], low[2], high[2], zone),
    )


@kernel
def _eased_axis(before: float, after: float, low: float, high: float, zone: float) -> float:
    if not zone > 0.0 or not high < inf or not high > low or not low <= before <= high:
        return after
    width = min(zone, 0.5 * (high - low))
    if after > before:
        return high - eased_gap(high - before, after - before, width)
    if after < before:
        return low + eased_gap(before - low, before - after, width)
    return after
