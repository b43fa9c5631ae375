"""Limits of planar chains: the article's clamp and the circular one (001; readings A-2, A-6)."""

from math import inf, pi

from limbik.core.jit import kernel

SLACK = 1e-9  # [rad] past a limit that is rounding


@kernel
def printed_wrap(angle: float) -> float:
    """Return an angle as the article's convTheta does, in (-π, π] [rad]."""
    angle = angle % (2.0 * pi)
    return angle - 2.0 * pi if angle > pi else angle


@kernel
def printed_clamp(angle: float, low: float, high: float) -> float:
    """Clamp as the article prints it: the limits are wrapped, and the angle jumps to the low one.

    Args:
        angle: Relative angle [rad].
        low: [rad]; -inf where free, which the article does not have.
        high: [rad].
    """
    if not high - low < inf:
        return printed_wrap(angle)
    angle, low, high = printed_wrap(angle), printed_wrap(low), printed_wrap(high)
    if angle < low:
        return low
    return high if angle > high else angle


@kernel
def nearest_clamp(angle: float, low: float, high: float) -> float:
    """Clamp to the end of the range that is nearer on the circle; a whole turn is no limit.

    Args:
        angle: Relative angle [rad].
        low: [rad]; -inf where free.
        high: [rad].
    """
    if not high - low < inf:
        return printed_wrap(angle)
    middle = (low + high) / 2.0
    # The form in the turn around the middle of the range: the far side is cut fairly in two.
    angle = middle + printed_wrap(angle - middle)
    if high - low >= 2.0 * pi:
        return angle
    return min(max(angle, low), high)


@kernel
def excess(angle: float, low: float, high: float) -> float:
    """Return by how much an angle breaks its limits on the circle [rad]."""
    return abs(printed_wrap(angle - nearest_clamp(angle, low, high)))
