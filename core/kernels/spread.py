"""Poses spread over the ranges of a chain's axes, in a fixed order that looks like chance."""

from math import inf, pi

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import wrap_angle

STATES = 2147483648  # a power of two; the generator passes through all of them


@kernel
def first_state(number: int) -> int:
    """Return the state of the sequence for a pose, by its number from 0 on."""
    return number * 7919 + 1


@kernel
def next_state(state: int) -> int:
    """Return the state after another (a linear congruential generator)."""
    return (state * 1103515245 + 12345) % STATES


@kernel
def spread_angle(state: int, low: float, high: float) -> float:
    """Return the angle of a range at the share a state stands for, of the circle if free [rad]."""
    share = state / STATES
    return low + share * (high - low) if high < inf else wrap_angle(2.0 * pi * share)
