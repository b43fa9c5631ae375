"""Initial bend by the n-th root with an amplitude that reaches the goal.

Fills the place the source leaves open (000 §6.1(11)(B)): the shape is that of `nth-root`, the
amplitude is found instead of taken from two bones of equal length.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from limbik.core.hooks import hookimpl
from limbik.core.strategy import NoParams, Strategy
from limbik.plugins.initial_bend.arc import bend_to, even_weights

Array = NDArray[np.float64]


def solved_arc(
    lengths: Array, reach_ratio: float, weights: Array, params: NoParams, angles: Array
) -> None:
    """Bend by `A (2 - 3^(k / (m-1))) x weight`, with A such that the end lies on the goal.

    The arc bends more toward its end. A factor common to all weights changes nothing: the
    amplitude makes up for it. A single bone stays on the line.
    """
    bones = angles.shape[0]
    root = 3.0 ** (1.0 / (bones - 1)) if bones > 1 else 1.0
    more = even_weights(weights)
    power = 1.0
    for bone in range(bones):
        angles[bone] = (2.0 - power) * (weights[bone] + more)
        power *= root
    bend_to(lengths, reach_ratio, angles)


@hookimpl
def limbik_initial_bends() -> Iterable[Strategy]:
    """Offer `solved-arc`."""
    text = "The arc of nth-root, as strong as it takes to end on the goal."
    return [Strategy("solved-arc", solved_arc, description=text)]
