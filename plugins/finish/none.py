"""No finish: the bare document, which ends with its CCD rounds (000 §7.6)."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def none(
    goal: Array,
    tolerance: float,
    length: float,
    offsets: Array,
    frozen: Array,
    base_position: Array,
    base_rotation: Array,
    low: Array,
    high: Array,
    own: Array,
    reachable: int,
    params: NoParams,
    angles: Array,
    scratch: Array,
    verdict: Array,
) -> None:
    """Leave the pose alone and claim nothing."""
    verdict[0] = 0.0


@hookimpl
def limbik_finishes() -> Iterable[Strategy]:
    """Offer `none`."""
    return [Strategy("none", none, description="End with the CCD rounds.")]
