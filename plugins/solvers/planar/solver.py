"""Planar solvers: chains whose joints turn by pitch only (001).

`planar-ccd` and `planar-fabrik` reach what the limits allow; `article-...` are the article's own
loops, for comparison. The plane is that of the base's z and y; pitch turns z toward y.
"""

from collections.abc import Iterable
from typing import Annotated, Any, NamedTuple

import numpy as np
from pydantic import Field

from limbik.core.chain import Chain
from limbik.core.errors import ChainError
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.solution import Solution, Status
from limbik.core.strategy import Degrees, Strategy
from limbik.core.whole import Batch, assemble
from limbik.plugins.solvers.fit import SAME, require_axes
from limbik.plugins.solvers.planar.layout import ARTICLE

NOTES = {int(Status.OUT_OF_REACH): "no pose within limits reaches it"}


class Robust(NamedTuple):
    """How the repaired solvers search."""

    sweeps: Annotated[int, Field(ge=1, le=100_000, description="from each start")] = 100
    step: Annotated[
        float,
        Field(ge=0.0, le=360.0, description="largest turn from goal to goal of a path; 0 = any"),
        Degrees,
    ] = 0.0


class Literal(NamedTuple):
    """How long the article's loops run."""

    sweeps: Annotated[int, Field(ge=1, le=100_000, description="at most")] = 100


class Plane(NamedTuple):
    """A planar chain of n joints and the end."""

    lengths: Array
    """(n,) [length]."""
    shift: Array
    """What a link's relative angle is above its joint's pitch, (n,) [rad]."""
    origin: Array
    """Where joint 0 is, world, (3,) [length]."""


def read_plane(chain: Chain, solver: str) -> Plane:
    """Read a planar chain out of a chain.

    Raises:
        ChainError: A joint turns or lies out of the plane, or a bone has no length.
    """
    count = len(chain) - 1
    if count < 2:
        raise ChainError(f"{solver} needs two bones or more")
    for joint in range(count):
        require_axes(chain, joint, (1,), solver)
        if abs(chain.frozen[joint, 0, 0] - 1.0) > SAME:
            raise ChainError(f"{solver}: only a pitch can be frozen", chain.names[joint])
        if abs(chain.offsets[joint + 1, 0]) > SAME * chain.length or not chain.lengths[joint] > 0.0:
            name = chain.names[joint + 1]
            raise ChainError(f"{solver} needs an offset [0, y, z] with a length", name)
    ways = np.arctan2(chain.offsets[1:, 1], chain.offsets[1:, 2])
    frozen = np.arctan2(chain.frozen[:-1, 1, 2], chain.frozen[:-1, 2, 2])
    shift = frozen + np.diff(ways, prepend=0.0)
    origin = np.asarray(chain.base_position) + chain.base_rotation @ chain.offsets[0]
    return Plane(chain.lengths, shift, origin)


def _points(chain: Chain, plane: Plane, goals: Array) -> Array:
    """Return the goals in the plane, (m, 2); what is out of the plane is left to the distance."""
    local = (goals - plane.origin) @ chain.base_rotation
    return np.ascontiguousarray(local[:, [2, 1]])


def _finish(
    chain: Chain, settings: Settings, goals: Array, pitches: Array, numbers: tuple[Array, Array]
) -> Solution:
    """Make the solution of pitches (m, n) with status and sweeps (m,)."""
    angles = np.zeros((len(goals), len(chain), 3))
    angles[:, :-1, 1] = pitches
    angles[:, -1] = np.clip(chain.rest[-1], chain.low[-1], chain.high[-1])
    status, sweeps = (values.astype(np.int64) for values in numbers)
    found = assemble(chain, goals, angles, status, sweeps, [""] * len(goals))
    # A goal beside the plane is as near as it gets and yet not reached.
    beside = (status == Status.REACHED) & (np.asarray(found.distance) > settings.tolerance)
    status = np.where(beside, int(Status.OUT_OF_REACH), status)
    notes = [
        "the goal is not in the plane" if b else NOTES.get(s, "")
        for b, s in zip(beside.tolist(), status.tolist(), strict=True)
    ]
    return assemble(chain, goals, angles, status, sweeps, notes)


def _near_range(chain: Chain, pitches: Array) -> Array:
    """Move pitches by whole turns to their ranges, (m, n) [rad]."""
    low, high = chain.low[:-1, 1], chain.high[:-1, 1]
    free = np.isinf(high)
    middle = (np.where(free, 0.0, low) + np.where(free, 0.0, high)) / 2.0
    return pitches - 2.0 * np.pi * np.round((pitches - middle) / (2.0 * np.pi))


def prepare_robust(chain: Chain, settings: Settings, params: Robust, method: str) -> Batch:
    """Make a repaired solver ready; `method` is `ccd` or `fabrik`.

    Raises:
        ChainError: The chain is not planar.
    """
    plane = read_plane(chain, f"planar-{method}")

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        from limbik.plugins.solvers.planar.arm import PlanarArm

        low, high = chain.low[:-1, 1] + plane.shift, chain.high[:-1, 1] + plane.shift
        arm = PlanarArm(plane.lengths, low, high)
        found = arm.solve(
            _points(chain, plane, goals),
            method,
            (chain.rest if near is None else near)[:-1, 1] + plane.shift,
            settings.tolerance,
            params.sweeps,
            follow,
            params.step,
            near is not None,
        )
        pitches = _near_range(chain, found.angles - plane.shift)
        if not np.isinf(low).any():
            pitches = np.clip(pitches, chain.low[:-1, 1], chain.high[:-1, 1])
        return _finish(chain, settings, goals, pitches, (found.status, found.sweeps))

    return solve


def prepare_article(chain: Chain, settings: Settings, params: Literal, method: str) -> Batch:
    """Make one of the article's loops ready; the unlimited ones leave the ranges.

    Raises:
        ChainError: The chain is not planar.
    """
    plane = read_plane(chain, f"article-{method}")

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        from limbik.plugins.solvers.planar.arm import PlanarArm

        low, high = chain.low[:-1, 1] + plane.shift, chain.high[:-1, 1] + plane.shift
        arm = PlanarArm(plane.lengths, low, high)
        pose = start = (chain.rest if near is None else near)[:-1, 1] + plane.shift
        rows, numbers = np.empty((len(goals), len(plane.lengths))), np.empty((2, len(goals)))
        for row, point in enumerate(_points(chain, plane, goals)):
            pose, used, left = arm.sweeps(
                method, point, pose if follow else start, settings.tolerance, params.sweeps
            )
            rows[row] = pose
            numbers[:, row] = (0 if left <= settings.tolerance else 1), used
        pitches = _near_range(chain, rows - plane.shift)
        return _finish(chain, settings, goals, pitches, (numbers[0], numbers[1]))

    return solve


def _named(make: Any, method: str) -> Any:
    """Give a solver the arguments of its slot, its method bound."""

    def kernel(chain: Chain, settings: Settings, params: Any) -> Batch:
        batch: Batch = make(chain, settings, params, method)
        return batch

    return kernel


@hookimpl
def limbik_solvers() -> Iterable[Strategy]:
    """Offer the solvers."""
    for method, text in (("ccd", "CCD"), ("fabrik", "FABRIK")):
        yield Strategy(
            f"planar-{method}",
            _named(prepare_robust, method),
            Robust,
            f"Planar {text} that reaches what the limits allow.",
        )
    for method in ARTICLE:
        yield Strategy(
            f"article-{method}",
            _named(prepare_article, method),
            Literal,
            "The article's loop as printed, for comparison.",
        )
