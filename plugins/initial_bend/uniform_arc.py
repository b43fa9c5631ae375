"""Initial bend with the same bend in every joint, as strong as it takes to end on the goal."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy
from limbik.plugins.initial_bend.arc import bend_to, even_weights

Array = NDArray[np.float64]


def uniform_arc(
    lengths: Array, reach_ratio: float, weights: Array, params: NoParams, angles: Array
) -> None:
    """Bend by `A (1 - 2 k / (m-1)) x weight`, with A such that the end lies on the goal.

    With equal weights every joint bends by the same angle: equal bones lie on a circle. A factor
    common to all weights changes nothing. A single bone stays on the line.
    """
    bones = angles.shape[0]
    more = even_weights(weights)
    for bone in range(bones):
        fall = 2.0 * bone / (bones - 1) if bones > 1 else 0.0
        angles[bone] = (1.0 - fall) * (weights[bone] + more)
    bend_to(lengths, reach_ratio, angles)


@hookimpl
def limbik_initial_bends() -> Iterable[Strategy]:
    """Offer `uniform-arc`."""
    text = "Equal bends in all joints, as strong as it takes to end on the goal."
    return [Strategy("uniform-arc", uniform_arc, description=text)]
