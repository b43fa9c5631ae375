"""No bank suppression (the default of 000 table 7-16: angle 0)."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def none(
    target: Array, current: Array, pitch: float, in_ccd: int, params: NoParams, delta: Array
) -> None:
    """Leave the change of angles alone."""


@hookimpl
def limbik_bank_suppressions() -> Iterable[Strategy]:
    """Offer `none`."""
    return [Strategy("none", none, description="Let every bank pass.")]
