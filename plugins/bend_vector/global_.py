"""Bend vector given in the world (000 §6.3(2)(C), §7.6; 3D A-13)."""

from collections.abc import Iterable
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.strategy import Sided, Strategy

Array = NDArray[np.float64]


class Global(NamedTuple):
    """Parameters of `global`."""

    direction: Annotated[
        tuple[float, float, float], Field(description="vector in the world, of any length"), Sided
    ] = (0.0, 1.0, 0.0)


def global_vector(
    frame: Array,
    aim: Array,
    end_offset: Array,
    to_world: Array,
    bank: float,
    previous: Array,
    params: Global,
    out: Array,
) -> None:
    """Bring the direction into IK space, by the transpose of IK space's axes in the world."""
    x, y, z = params.direction
    for axis in range(3):
        out[axis] = to_world[0, axis] * x + to_world[1, axis] * y + to_world[2, axis] * z


def check(params: Global) -> None:
    """Refuse a direction without length."""
    if max(abs(part) for part in params.direction) == 0.0:
        raise ValueError("direction is (0, 0, 0); it must point somewhere, such as (0, 1, 0)")


@hookimpl
def limbik_bend_vectors() -> Iterable[Strategy]:
    """Offer `global`."""
    return [Strategy("global", global_vector, Global, "Along a direction of the world.", check)]
