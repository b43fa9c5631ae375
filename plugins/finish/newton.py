"""The default finish: a limited Newton descent, with retries from elsewhere when limits block.

Our own design, beyond the source (DECISIONS, "one more stage"). The descent starts from the CCD
pose, so where that is near the goal it only closes the gap. Where limits stop it, other folds of
the chain are tried in a fixed order: mirrored inside the ranges, the ranges' middles, then spread
evenly over the ranges. The first that reaches the goal is the answer; if none does, the nearest.
"""

from collections.abc import Iterable
from math import inf, pi
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.jit import kernel
from limbik.core.kernels.rotation import Vector, wrap_angle
from limbik.core.strategy import Strategy
from limbik.plugins.finish.descent import descend
from limbik.plugins.finish.linkage import (
    ANGLES,
    BEST,
    START,
    Linkage,
    copy_columns,
    pulled,
    read,
    write,
)
from limbik.plugins.finish.sweep import sweep

Array = NDArray[np.float64]
Counts = NDArray[np.int64]


FULL_EFFORT_JOINTS = 8  # chains up to this long get all retries
LEAST_RETRIES = 4
STEADINESS = 0.002  # share of the length by which a later start must be nearer


class Newton(NamedTuple):
    """Parameters of the Newton finish."""

    precision: Annotated[
        float, Field(gt=0.0, le=1e-2, description="distance aimed at, over the chain length [-]")
    ] = 1e-9
    steps: Annotated[int, Field(ge=1, le=1000, description="most steps of a descent")] = 40
    retries: Annotated[int, Field(ge=0, le=10000, description="most other starts")] = 160


def newton(
    goal: Array,
    tolerance: float,
    length: float,
    offsets: Array,
    frozen: Array,
    base_position: Array,
    base_rotation: Array,
    low: Array,
    high: Array,
    limits: Counts,
    limit_params: Array,
    reachable: int,
    params: Newton,
    angles: Array,
    scratch: Array,
    verdict: Array,
) -> None:
    """End a solve at its goal within the limits, or as near as there is a way to."""
    body = (offsets, frozen, base_position, base_rotation, low, high)
    chain = Linkage(*body, limits, limit_params)
    point = (goal[0], goal[1], goal[2])
    aimed = min(params.precision * length, 0.5 * tolerance)
    for joint in range(angles.shape[0]):
        write((angles[joint, 0], angles[joint, 1], angles[joint, 2]), scratch, joint, ANGLES)
    copy_columns(ANGLES, START, scratch)
    nearest = descend(point, aimed, params.steps, chain, scratch)
    copy_columns(ANGLES, BEST, scratch)
    verdict[0] = 0.0
    if nearest >= tolerance:
        retries = _affordable(params.retries, angles.shape[0]) if reachable else 2
        margin = STEADINESS * length
        nearest = _search(
            point, aimed, tolerance, margin, nearest, retries, params.steps, chain, scratch
        )
        verdict[0] = 1.0
    for joint in range(angles.shape[0]):
        for axis in range(3):
            angles[joint, axis] = scratch[joint, BEST + axis]


@kernel
def _affordable(retries: int, joints: int) -> int:
    """Return how many retries a chain gets: a long one fewer, so that a verdict stays in time.

    Long chains have many folds near any goal and need them least.
    """
    return min(retries, max(LEAST_RETRIES, retries * FULL_EFFORT_JOINTS // joints))


@kernel
def _search(
    goal: Vector,
    aimed: float,
    tolerance: float,
    margin: float,
    nearest: float,
    retries: int,
    steps: int,
    chain: Linkage,
    scratch: Array,
) -> float:
    """Try other starts until one reaches the goal; leave the nearest pose in BEST.

    Where none does, many folds end about equally near. An earlier start stays the answer until a
    later one is nearer by a margin, so that the pose does not jump between equals along a path.
    """
    for attempt in range(retries):
        _start(attempt, chain, scratch)
        for _ in range(2):
            sweep(goal, chain, scratch)
        distance = descend(goal, aimed, steps, chain, scratch)
        if distance < tolerance or distance < nearest - margin:
            nearest = distance
            copy_columns(ANGLES, BEST, scratch)
        if nearest < tolerance:
            break
    return nearest


@kernel
def _start(attempt: int, chain: Linkage, scratch: Array) -> None:
    """Write the angles of a start: the pose it began with, its mirror, middles, then spread."""
    state = attempt * 7919 + 1
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            low, high = chain.low[joint, axis], chain.high[joint, axis]
            angle = scratch[joint, START + axis]
            state = (state * 1103515245 + 12345) % 2147483648
            share = state / 2147483648.0
            limited = high < inf
            if attempt == 1:
                angle = low + high - angle if limited else angle
            elif attempt == 2:
                angle = 0.5 * (low + high) if limited else angle
            elif attempt > 2:
                angle = low + share * (high - low) if limited else wrap_angle(2.0 * pi * share)
            scratch[joint, ANGLES + axis] = angle
        if chain.limits[joint] != 0:
            write(
                pulled(joint, read(scratch, joint, ANGLES), chain, scratch), scratch, joint, ANGLES
            )


@hookimpl
def limbik_finishes() -> Iterable[Strategy]:
    """Offer `newton`."""
    return [Strategy("newton", newton, Newton, "Limited Newton steps, then other starts.")]
