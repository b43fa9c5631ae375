"""A chain as a row of hinges: every axis that can turn, and what is fixed between two of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain
from limbik.core.rotation import Array, hpb_to_matrix

FIXED = 1e-9  # [rad]; an axis with a smaller range does not turn

PARALLEL = 1e-9  # squared sine of axes that count as parallel


class Hinges(NamedTuple):
    """k hinges, as the kernels take them.

    A hinge stands at `shift`, turned by `before`, in the frame behind the hinge before it; the
    first in the world. The rows k lead from the last hinge to the end.
    """

    axis: NDArray[np.int64]
    """0 heading, 1 pitch, 2 bank, (k,)."""
    shift: Array
    """(k + 1, 3) [length]."""
    before: Array
    """(k + 1, 3, 3)."""
    low: Array
    """(k,) [rad]; -inf where free."""
    high: Array
    """(k,) [rad]."""


class Span(NamedTuple):
    """What the bones, free to fold, can span: a shell about a point that stays.

    A hinge's axis stays in place as it turns, so any point of it will do as its place; those where
    neighbouring axes come nearest make the bones short and the shell tight.
    """

    start: Array
    """On the first hinge's axis, world, (1, 3) [length]."""
    hand: Array
    """On the last hinge's axis, in the end's frame, (1, 3) [length]."""
    bones: Array
    """Sum and longest of the bones between the two, (2,) [length]."""


class Joints(NamedTuple):
    """The chain of n joints that the hinges are part of."""

    joint: NDArray[np.int64]
    """Which joint each hinge is an axis of, (k,)."""
    resting: Array
    """Angles with the fixed axes in their ranges, HPB, (n, 3) [rad]."""
    offsets: Array
    """(n, 3) [length]."""
    frozen: Array
    """(n, 3, 3)."""
    base_position: Array
    """(1, 3) [length]."""
    base_rotation: Array
    """(1, 3, 3)."""


def read_joints(chain: Chain) -> Joints:
    """Lay a chain out for the kernels."""
    return Joints(
        np.nonzero(chain.high - chain.low > FIXED)[0],
        np.clip(chain.rest, chain.low, chain.high),
        chain.offsets.copy(),
        chain.frozen.copy(),
        np.array([chain.base_position], np.float64),
        chain.base_rotation[None].copy(),
    )


def read_hinges(chain: Chain) -> Hinges:
    """Take a chain apart into its hinges; a joint that turns about three axes gives three."""
    resting = np.clip(chain.rest, chain.low, chain.high)
    turns = chain.high - chain.low > FIXED
    shifts, befores = [], []
    shift, before = np.asarray(chain.base_position, np.float64), chain.base_rotation
    for joint in range(len(chain)):
        shift = shift + before @ chain.offsets[joint]
        before = before @ chain.frozen[joint]
        for axis in range(3):
            if turns[joint, axis]:
                shifts.append(shift)
                befores.append(before)
                shift, before = np.zeros(3), np.eye(3)
            else:
                before = before @ hpb_to_matrix(resting[joint, axis] * np.eye(3)[axis])
    return Hinges(
        np.nonzero(turns)[1],
        np.array([*shifts, shift]),
        np.array([*befores, before]),
        chain.low[turns],
        chain.high[turns],
    )


def read_span(hinges: Hinges) -> Span:
    """Find the shell that the bones span."""
    own = np.eye(3)[[1, 0, 2]][hinges.axis]  # heading turns about y, pitch about x
    ways = np.einsum("kij,kj->ki", hinges.before[:-1], own)
    at = np.zeros(len(own))
    for k in range(1, len(own)):
        first, at[k] = _feet(own[k - 1], hinges.shift[k], ways[k], at[k - 1])
        at[0] = first if k == 1 else at[0]
    behind = at[:, None] * own  # the places in the frames behind the hinges
    before = hinges.shift[:-1] + at[:, None] * ways
    bones = np.linalg.norm(before[1:] - behind[:-1], axis=1)
    hand = (behind[-1] - hinges.shift[-1]) @ hinges.before[-1]
    return Span(before[:1].copy(), hand[None], np.array([bones.sum(), bones.max()]))


def _feet(first: Array, origin: Array, second: Array, at: float) -> tuple[float, float]:
    """Return where on two lines their common perpendicular stands.

    Args:
        first: Unit direction of the line through 0.
        origin: A point of the second line.
        second: Its unit direction.
        at: Where on the first line the foot is if they are parallel.
    """
    lean = float(first @ second)
    square = 1.0 - lean * lean
    if square < PARALLEL:
        return at, float((at * first - origin) @ second)
    one, two = float(first @ origin), float(second @ origin)
    return (one - lean * two) / square, (lean * one - two) / square
