"""No root control: the bend root's angles stay as they come (000 §6.3(3)(A))."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy

Array = NDArray[np.float64]


def none(
    root: int, has_previous: int, previous: Array, params: NoParams, low: Array, high: Array
) -> None:
    """Leave the limits alone."""


@hookimpl
def limbik_root_controls() -> Iterable[Strategy]:
    """Offer `none`."""
    return [Strategy("none", none, description="The joints' own limits only.")]
