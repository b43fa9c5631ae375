"""Keep the bend root from flipping over (000 §6.3(3)(B); 3D A-27, A-54)."""

from collections.abc import Iterable
from math import pi

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def suppress_flip(
    root: int, has_previous: int, previous: Array, params: NoParams, low: Array, high: Array
) -> None:
    """Narrow the root's pitch limits to ±90°; only the pitch stops there, the rest keeps moving.

    Limits that lie wholly beyond ±90° are left as they are: the joint could not keep both.
    """
    lowest = max(low[root, 1], -0.5 * pi)
    highest = min(high[root, 1], 0.5 * pi)
    if lowest <= highest:
        low[root, 1] = lowest
        high[root, 1] = highest


@hookimpl
def limbik_root_controls() -> Iterable[Strategy]:
    """Offer `suppress-flip`."""
    text = "Pitch of the bend root within ±90°."
    return [Strategy("suppress-flip", suppress_flip, description=text)]
