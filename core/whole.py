"""Whole solvers: what a plug-in of the hook `limbik_solvers` brings, and how it is called.

Such a strategy's `kernel` is no compiled step but a Python function `(chain, settings, params)`,
params in radians. It looks at the chain, raises `ChainError` if it cannot solve this kind, and
returns a function `(goals (m, 3), follow) -> Solution` with a leading goal axis, or a `PoseBatch`
if it turns the end to an orientation too. It must be quick and load no compiler: `limbik check`
calls it.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import LimbikError, PluginError
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.slots import SOLVER
from limbik.core.solution import Solution
from limbik.core.strategy import flatten, unflatten

BUILT_IN_3D = "3d"
OWN_SOLVERS = (BUILT_IN_3D, "2d")
"""Names of the solvers that are no plug-ins: `limbik.core.solver.Solver` and `Solver2D`."""

Batch = Callable[[Array, bool], Solution]


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


@dataclass(frozen=True, slots=True)
class PoseSolution(WholeSolution):
    """A solution of goals with an orientation (M-13).

    Attributes:
        goal_rotation: World rotations asked for, (3, 3) or (m, 3, 3); NaN where none was.
        rotation_error: Angle left to them [rad]; (m,) for many; 0 where none was asked for.
        jumped: Whether the chain had to go over into another fold, or turn farther than the step of
            the goal explains, on a path; (m,) for many.
    """

    goal_rotation: Array = field(default_factory=lambda: np.full((3, 3), np.nan))
    rotation_error: float | Array = 0.0
    jumped: bool | NDArray[np.bool_] = False


class PoseBatch(ABC):
    """A whole solver, ready for a chain, whose goals may have an orientation.

    Attributes:
        chain: The chain.
        tolerance: Distance that counts as reached [length].
        angle: Angle that counts as reached [rad].
    """

    chain: Chain
    tolerance: float
    angle: float

    def __call__(self, goals: Array, follow: bool) -> Solution:
        """Solve goals without an orientation, (m, 3) [length]."""
        return self.solve_poses(goals, None, follow)

    @abstractmethod
    def solve_poses(
        self, goals: Array, rotations: Array | None, follow: bool, near: Array | None = None
    ) -> PoseSolution:
        """Solve poses, as a path or each on its own.

        Args:
            goals: World positions, (m, 3) [length].
            rotations: World rotations, (m, 3, 3); NaN, or None, where the orientation is free.
            follow: Whether each is solved from the pose of the one before.
            near: Pose to start from, HPB, (n, 3) [rad]; the rest pose if absent.
        """


def prepare(bound: Bound, chain: Chain, settings: Settings) -> Batch:
    """Make a solver ready for a chain.

    Raises:
        ChainError: It does not solve this kind of chain.
        PluginError: It failed.
    """
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
