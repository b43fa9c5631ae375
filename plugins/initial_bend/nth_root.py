"""Initial bend by the n-th root (000 §6.1(11)(A), §7.6)."""

from collections.abc import Iterable
from math import acos

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def nth_root(
    lengths: Array, reach_ratio: float, weights: Array, params: NoParams, angles: Array
) -> None:
    """Let the bones turn from P to -P, where P is the bend angle acos(reach ratio).

    Bone k of m has the angle P (2 - 3^(k / (m-1))) times its weight: the first leaves the line
    root→goal by P, the last comes back to it by P. A single bone stays on the line, it cannot
    bend. A goal out of reach gives P = 0.
    """
    bones = angles.shape[0]
    bend = acos(min(max(reach_ratio, 0.0), 1.0)) if bones > 1 else 0.0
    root = 3.0 ** (1.0 / (bones - 1)) if bones > 1 else 1.0
    power = 1.0
    for bone in range(bones):
        angles[bone] = bend * (2.0 - power) * weights[bone]
        power *= root


@hookimpl
def limbik_initial_bends() -> Iterable[Strategy]:
    """Offer `nth-root`."""
    return [
        Strategy("nth-root", nth_root, description="Angles from P to -P by the n-th root of 3.")
    ]
