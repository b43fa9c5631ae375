"""How near bones that can fold freely let a chain's end come to its start."""

from limbik.core.jit import kernel


@kernel
def least_reach(total: float, longest: float) -> float:
    """Return the least distance of a chain's end from its start [length].

    It is what the longest bone has over all others together, laid back along it.

    Args:
        total: Sum of all bones [length].
        longest: The longest of them [length].
    """
    return max(2.0 * longest - total, 0.0)
