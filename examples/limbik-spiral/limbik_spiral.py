"""A limbik plug-in: an initial bend that curls more and more toward the tip."""

from collections.abc import Iterable
from math import acos
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

import limbik

Array = NDArray[np.float64]


class Spiral(NamedTuple):
    """Parameters of `spiral`: what a scene may write beside `use: spiral`."""

    growth: Annotated[
        float,
        Field(ge=0.25, le=4.0, description="1 = an arc, above it the tip curls most [-]"),
    ] = 2.0


def spiral(
    lengths: Array, reach_ratio: float, weights: Array, params: Spiral, angles: Array
) -> None:
    """Turn the bones from P to -P, by steps that grow toward the tip.

    P is the bend angle acos(reach ratio). At a share s of the length (middle of the bone) the
    angle is P (1 - 2 s^growth), times the bone's weight.
    """
    bend = acos(min(max(reach_ratio, 0.0), 1.0))
    share = 0.0
    for bone in range(angles.shape[0]):
        middle = share + 0.5 * lengths[bone]
        share += lengths[bone]
        angles[bone] = bend * (1.0 - 2.0 * middle**params.growth) * weights[bone]


@limbik.hookimpl
def limbik_initial_bends() -> Iterable[limbik.Strategy]:
    """Offer `spiral`."""
    return [limbik.Strategy("spiral", spiral, Spiral, "Curl more and more toward the tip.")]
