"""Let the bend root flip over its pitch of 90° (000 §6.3(3)(C), §7.6)."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def prefer_flip(
    root: int, has_previous: int, previous: Array, params: NoParams, low: Array, high: Array
) -> None:
    """Hold everything that could turn instead of the root's pitch, as long as this is chosen.

    Held at the previous pose are all angles of the joints before the root, and the root's heading.
    An angle outside its joint's limits is held at the nearer limit. Without a previous pose
    nothing is held.
    """
    if has_previous == 0:
        return
    for joint in range(root + 1):
        axes = 1 if joint == root else 3
        for axis in range(axes):
            held = min(max(previous[joint, axis], low[joint, axis]), high[joint, axis])
            low[joint, axis] = held
            high[joint, axis] = held


@hookimpl
def limbik_root_controls() -> Iterable[Strategy]:
    """Offer `prefer-flip`."""
    text = "Base to bend root's heading held as before, so that the root's pitch can pass 90°."
    return [Strategy("prefer-flip", prefer_flip, description=text)]
