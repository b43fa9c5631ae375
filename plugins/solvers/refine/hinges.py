"""A chain as a row of hinges: every axis that can turn, and what is fixed between two of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain
from limbik.core.rotation import Array, hpb_to_matrix

FIXED = 1e-9  # [rad]; an axis with a smaller range does not turn


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


class Layout(NamedTuple):
    """Where the hinges are in the chain.

    Attributes:
        hinges: The hinges.
        joints, axes: Joint and axis of each, (k,).
        resting: Angles of the whole chain, fixed axes in their range, HPB, (n, 3) [rad].
    """

    hinges: Hinges
    joints: NDArray[np.int64]
    axes: NDArray[np.int64]
    resting: Array

    def pick(self, angles: Array) -> Array:
        """Return the hinges' angles out of poses, (..., n, 3) to (..., k) [rad]."""
        return np.ascontiguousarray(angles[..., self.joints, self.axes])

    def spread(self, values: Array) -> Array:
        """Return poses with the hinges at given angles, (m, k) to (m, n, 3) [rad]."""
        angles = np.repeat(self.resting[None], len(values), axis=0)
        angles[:, self.joints, self.axes] = values
        return angles


def read_hinges(chain: Chain) -> Layout:
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
    joints, axes = np.nonzero(turns)
    hinges = Hinges(
        axes.copy(),
        np.array([*shifts, shift]),
        np.array([*befores, before]),
        chain.low[turns],
        chain.high[turns],
    )
    return Layout(hinges, joints, axes, resting)
