"""Whole solvers: what a plug-in of the hook `limbik_solvers` brings, and how it is called.

Such a strategy's `kernel` is no compiled step but a Python function `(chain, settings, params)`,
params in radians. It looks at the chain, raises `ChainError` if it cannot solve this kind, and
returns a `Batch`, or a `limbik.core.posegoals.PoseBatch` if it turns the end to an orientation too.
It must be quick and load no compiler: `limbik check` calls it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import LimbikError, PluginError
from limbik.core.jointlimits import refuse_limits
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.slots import SOLVER
from limbik.core.solution import Solution
from limbik.core.strategy import flatten, unflatten

BUILT_IN_3D = "3d"
OWN_SOLVERS = (BUILT_IN_3D, "2d")
"""Names of the solvers that are no plug-ins: `limbik.core.solver.Solver` and `Solver2D`."""


class Batch(Protocol):
    """A whole solver, ready for a chain of n joints."""

    def __call__(self, goals: Array, follow: bool, near: Array | None = None, /) -> Solution:
        """Solve goals, as a path or each on its own.

        Args:
            goals: World positions, (m, 3) [length].
            follow: Whether each is solved from the pose of the one before.
            near: Pose to start from, HPB, (n, 3) [rad]: that of the solve before on a path that is
                given goal by goal; the rest pose if absent.

        Returns:
            A solution with a leading goal axis.
        """


@dataclass(frozen=True, slots=True)
class WholeSolution(Solution):
    """A solution with a remark on each goal.

    Attributes:
        notes: The remark, empty where there is none; a tuple of m for many goals.
    """

    notes: tuple[str, ...] | str = ""

    @property
    def remark(self) -> str:
        """What a reader should know beside the status, such as a singular pose."""
        return self.notes if isinstance(self.notes, str) else ""


def prepare(bound: Bound, chain: Chain, settings: Settings) -> Batch:
    """Make a solver ready for a chain.

    Raises:
        ChainError: It does not solve this kind of chain.
        PluginError: It failed.
    """
    refuse_limits(chain, f"the solver {bound.name}")
    params = unflatten(bound.strategy.params, flatten(bound.params))
    try:
        batch: Batch = bound.strategy.kernel(chain, settings, params)
    except LimbikError:
        raise
    except Exception as error:
        cause = f"{type(error).__name__}: {error}"
        raise PluginError(cause, bound.plugin.name, bound.name, SOLVER.name) from error
    return batch


def assemble(
    chain: Chain,
    goals: Array,
    angles: Array,
    status: NDArray[np.int64],
    iterations: NDArray[np.int64],
    notes: Sequence[str],
) -> WholeSolution:
    """Make the solution of angles a solver has found.

    Args:
        chain: n joints.
        goals: World positions, (m, 3) [length].
        angles: HPB, (m, n, 3) [rad].
        status: Numbers of `Status`, (m,).
        iterations: (m,).
        notes: m remarks.
    """
    positions, rotations = forward_kinematics(chain, angles)
    distance = np.linalg.norm(positions[:, -1] - goals, axis=-1)
    count = len(goals)
    return WholeSolution(
        chain,
        goals,
        angles,
        positions,
        rotations,
        iterations,
        distance,
        status,
        np.zeros((count, 3)),
        np.zeros(count),
        notes=tuple(notes),
    )
