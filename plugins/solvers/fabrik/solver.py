"""The solver `fabrik`: any chain, by FABRIK with the joints' own limits (001; G-05)."""

from collections.abc import Iterable
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from limbik.core.chain import Chain
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.solution import Solution
from limbik.core.strategy import Strategy
from limbik.core.whole import Batch, assemble


class Rounds(NamedTuple):
    """How long it searches."""

    rounds: Annotated[int, Field(ge=1, le=100_000, description="from each start")] = 500


def prepare(chain: Chain, settings: Settings, params: Rounds) -> Batch:
    """Make the solver ready; it takes every chain."""

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        from limbik.plugins.solvers.fabrik.kernels import Limb, solve_goals

        position = np.array([chain.base_position], np.float64)
        limb = Limb(
            chain.offsets, chain.frozen, chain.low, chain.high, position, chain.base_rotation[None]
        )
        points = np.ascontiguousarray(goals, np.float64)
        angles, numbers = np.empty((len(points), len(chain), 3)), np.empty((len(points), 2))
        start = np.array(chain.rest if near is None else near)
        solve_goals(limb, points, settings.tolerance, params.rounds, follow, start, angles, numbers)
        status, rounds = numbers.astype(np.int64).T
        return assemble(chain, points, angles, status, rounds, [""] * len(points))

    return solve


@hookimpl
def limbik_solvers() -> Iterable[Strategy]:
    """Offer the solver."""
    return [Strategy("fabrik", prepare, Rounds, "FABRIK in 3D with the joints' own limits.")]
