"""Where a descent starts again when limits have stopped it."""

from math import inf

from limbik.core.jit import kernel
from limbik.core.kernels.spread import first_state, next_state, spread_angle
from limbik.core.rotation import Array
from limbik.plugins.finish.linkage import ANGLES, HOME, Linkage, has_limit, pull_inside

PUSH = 0.1  # [rad]


@kernel
def off_home(chain: Linkage, scratch: Array) -> None:
    """Write HOME into ANGLES, every axis pushed by a little, up where its range allows."""
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            low, high = chain.low[joint, axis], chain.high[joint, axis]
            angle = scratch[joint, HOME + axis]
            up, down = angle + PUSH, max(angle - PUSH, low)
            scratch[joint, ANGLES + axis] = up if up <= high else down
        pull_inside(ANGLES, joint, scratch)


@kernel
def other_fold(number: int, chain: Linkage, scratch: Array) -> None:
    """Write another start into ANGLES: HOME, its mirror image, middles of ranges, then spread.

    The middle of a joint's own limit is taken to be its zero pose.

    Args:
        number: From 0; the same number gives the same start.
        chain: The chain.
        scratch: (n, WIDTH).
    """
    state = first_state(number)
    for joint in range(chain.offsets.shape[0]):
        own = has_limit(joint, scratch)
        for axis in range(3):
            low, high = chain.low[joint, axis], chain.high[joint, axis]
            angle = scratch[joint, HOME + axis]
            state = next_state(state)
            limited = high < inf
            if own and 0 < number < 3:
                angle = -angle if number == 1 else 0.0
            elif number == 1:
                angle = low + high - angle if limited else angle
            elif number == 2:
                angle = 0.5 * (low + high) if limited else angle
            elif number > 2:
                angle = spread_angle(state, low, high)
            scratch[joint, ANGLES + axis] = angle
        pull_inside(ANGLES, joint, scratch)
