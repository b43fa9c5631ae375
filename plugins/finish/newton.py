"""The default finish: a limited Newton descent, with other folds of the chain when limits block.

Our own design, beyond the source (DECISIONS, "one more stage"). The descent starts from the CCD
pose, so where that is near the goal it only closes the gap. Where limits stop it, three things
follow in a fixed order:

* The pose is pushed a little off where it stands and descends again. A limb pressed together in
  a plane buckles out of it so, always to the same side.
* Other folds are tried: the mirrored one, the ranges' middles, then starts spread over the ranges.
  The first that reaches the goal is the answer; one that does not only if it is nearer by far.
* In its own fold the pose settles next to the CCD pose, so that goals near each other get poses
  near each other. Another fold does not settle: it lies on the far side of limits, where the way
  to the CCD pose leads from one neighbour here and from the next there.
"""

from collections.abc import Iterable
from enum import IntEnum
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from limbik.core.hooks import hookimpl
from limbik.core.jit import kernel
from limbik.core.kernels.layout import IN_VAIN, LEAST_FOUND
from limbik.core.kernels.rotation import Vector
from limbik.core.strategy import Strategy
from limbik.plugins.finish.descent import descend
from limbik.plugins.finish.linkage import (
    ANGLES,
    BEST,
    HOME,
    Linkage,
    beyond_reach,
    copy_columns,
    end_at,
    load_own,
    write,
)
from limbik.plugins.finish.settling import settle
from limbik.plugins.finish.starts import off_home, other_fold
from limbik.plugins.finish.sweep import sweep

Array = NDArray[np.float64]

FULL_EFFORT_JOINTS = 8  # chains up to this long get all retries
LEAST_RETRIES = 4
OUT_RETRIES = 40  # for goals that no fold reaches, limits or not
NEARER_BY_FAR = 0.007  # share of the length by which another fold that misses too must be nearer
NEARER = 1e-5  # the same for the fold it is in
THOROUGH = 1e-9  # a step that gains a smaller share of the distance is the last
COARSE = (
    1e-3  # the same on the way from a start that may lead nowhere; more cuts folds off at random
)


class Fold(IntEnum):
    """Which folds may be the answer: any that reaches, or only the one CCD has found."""

    ANY = 0
    HOME = 1


class Newton(NamedTuple):
    """Parameters of the Newton finish."""

    precision: Annotated[
        float, Field(gt=0.0, le=1e-2, description="distance aimed at, over the chain length [-]")
    ] = 1e-9
    steps: Annotated[int, Field(ge=1, le=1000, description="most steps of a descent")] = 40
    retries: Annotated[int, Field(ge=0, le=10000, description="most other starts")] = 160
    fold: Annotated[
        Fold, Field(description="any that reaches, or home: stay with the fold of the CCD pose")
    ] = Fold.ANY


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
    own: Array,
    reachable: int,
    params: Newton,
    angles: Array,
    scratch: Array,
    verdict: Array,
) -> None:
    """End a solve at its goal within the limits, or as near as there is a way to.

    The arguments are those of the slot `finish`, see `limbik.core.slots`.
    """
    chain = Linkage(length, offsets, frozen, base_position, base_rotation, low, high)
    load_own(own, scratch)
    point = (goal[0], goal[1], goal[2])
    aimed = min(params.precision * length, 0.5 * tolerance)
    for joint in range(angles.shape[0]):
        write((angles[joint, 0], angles[joint, 1], angles[joint, 2]), scratch, joint, ANGLES)
    copy_columns(ANGLES, HOME, scratch)
    nearest = descend(point, aimed, params.steps, COARSE, chain, scratch)
    copy_columns(ANGLES, BEST, scratch)
    if nearest >= tolerance:
        nearest = _buckle(point, aimed, tolerance, nearest, params.steps, chain, scratch)
    if nearest >= tolerance:
        retries = _affordable(params.retries, angles.shape[0])
        if not reachable:
            straight = nearest <= beyond_reach(point, chain, scratch) + NEARER * length
            retries = 0 if straight else min(retries, OUT_RETRIES)
        nearest = _search(point, aimed, tolerance, nearest, retries, params, chain, scratch)
    tried = params.retries > 0 or not reachable
    verdict[IN_VAIN] = 1.0 if nearest >= tolerance and tried else 0.0
    verdict[LEAST_FOUND] = nearest
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
def _buckle(
    goal: Vector,
    aimed: float,
    tolerance: float,
    nearest: float,
    steps: int,
    chain: Linkage,
    scratch: Array,
) -> float:
    """Push the pose off where it stands, descend again, and take what is nearer into BEST.

    So a pose is left from which no axis alone leads nearer.

    Returns:
        The distance of the end of BEST from the goal [length].
    """
    off_home(chain, scratch)
    distance = descend(goal, aimed, steps, THOROUGH, chain, scratch)
    if distance < tolerance or distance < nearest - NEARER * chain.length:
        copy_columns(ANGLES, BEST, scratch)
        return _settled(goal, aimed, distance, steps, chain, scratch)
    return nearest


@kernel
def _search(
    goal: Vector,
    aimed: float,
    tolerance: float,
    nearest: float,
    retries: int,
    params: Newton,
    chain: Linkage,
    scratch: Array,
) -> float:
    """Try other starts until one reaches the goal.

    The best pose comes into BEST, if `params.fold` lets it. Where none reaches, many folds end
    about equally near: the first stays the answer until another is nearer by far, so that the pose
    does not jump between equals along a path.

    Returns:
        The least distance found [length].
    """
    found, home = nearest, True
    for attempt in range(retries):
        other_fold(attempt, chain, scratch)
        for _ in range(2):
            sweep(goal, chain, scratch)
        distance = descend(goal, aimed, params.steps, COARSE, chain, scratch)
        found = min(found, distance)
        if params.fold == Fold.ANY and (
            distance < tolerance or distance < nearest - NEARER_BY_FAR * chain.length
        ):
            nearest, home = distance, False
            copy_columns(ANGLES, BEST, scratch)
        if found < tolerance:
            break
    if home:
        return min(found, _settled(goal, aimed, nearest, params.steps, chain, scratch))
    copy_columns(BEST, ANGLES, scratch)
    nearest = descend(goal, aimed, params.steps, THOROUGH, chain, scratch)
    copy_columns(ANGLES, BEST, scratch)
    return min(found, nearest)


@kernel
def _settled(
    goal: Vector,
    aimed: float,
    nearest: float,
    steps: int,
    chain: Linkage,
    scratch: Array,
) -> float:
    """Let the pose in BEST settle, unless its end would stay behind; return its distance."""
    copy_columns(BEST, ANGLES, scratch)
    settle(end_at(ANGLES, chain, scratch), chain, scratch)
    distance = descend(goal, aimed, steps, THOROUGH, chain, scratch)
    if distance > max(aimed, nearest + NEARER * chain.length):
        return nearest
    copy_columns(ANGLES, BEST, scratch)
    return distance


@hookimpl
def limbik_finishes() -> Iterable[Strategy]:
    """Offer `newton`."""
    return [Strategy("newton", newton, Newton, "Limited Newton steps, then other folds.")]
