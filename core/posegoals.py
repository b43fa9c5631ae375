"""Goals with an orientation: what solves them, and what it gives back (M-13)."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.settings import Settings
from limbik.core.solution import Continuity, Solution
from limbik.core.strategy import mirrored
from limbik.core.whole import Batch, WholeSolution, prepare


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

    def __call__(self, goals: Array, follow: bool, near: Array | None = None, /) -> Solution:
        """Solve goals without an orientation, see `limbik.core.whole.Batch`."""
        return self.solve_poses(goals, None, follow, near)

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


def solve_turned(
    batch: Batch, goals: Array, turns: Array | None, follow: bool, near: Array | None = None
) -> Solution:
    """Solve goals with a whole solver; one that does not turn the end leaves orientations aside.

    Args:
        batch: The solver, ready for its chain.
        goals: World positions, (m, 3) [length].
        turns: World orientations, HPB, (m, 3) [rad]; NaN for goals without, None if none has one.
        follow: Whether each is solved from the pose of the one before.
        near: Pose to start from, HPB, (n, 3) [rad]; the rest pose if absent.
    """
    if turns is None or not isinstance(batch, PoseBatch):
        return batch(goals, follow, near)
    return batch.solve_poses(goals, hpb_to_matrix(turns), follow, near)


class WholeSolver:
    """A solver of a plug-in for one chain, called as `limbik.core.solver.Solver` is.

    Args:
        bound: The solver.
        chain: What to pose.
        settings: Options.

    Raises:
        ChainError: It does not solve this kind of chain.
        PluginError: It failed.
    """

    def __init__(self, bound: Bound, chain: Chain, settings: Settings) -> None:
        self._bound = bound
        self.chain, self.settings = chain, settings
        self._batch = prepare(bound, chain, settings)

    @property
    def name(self) -> str:
        """Name of the solver."""
        return self._bound.name

    @property
    def turns_end(self) -> bool:
        """Whether it follows a goal's orientation."""
        return isinstance(self._batch, PoseBatch)

    @property
    def angle(self) -> float | None:
        """Angle to a goal's orientation that counts as reached [rad]; None if it follows none."""
        return self._batch.angle if isinstance(self._batch, PoseBatch) else None

    def moved(self, position: Array, rotation: Array) -> "WholeSolver":
        """Return the solver for the chain with its base elsewhere."""
        return WholeSolver(self._bound, self.chain.moved(position, rotation), self.settings)

    def mirrored(self) -> "WholeSolver":
        """Return the solver of the chain mirrored in the world's YZ plane (M-14)."""
        from limbik.core.mirror import mirrored_settings

        image = type(self._bound.params)(**mirrored(self._bound.params))
        settings = mirrored_settings(self.settings, {})
        return WholeSolver(replace(self._bound, params=image), self.chain.mirrored(), settings)

    def solve(
        self,
        goal: Array,
        *,
        goal_turn: Array | None = None,
        fk_offsets: Array | None = None,
        continuity: Continuity | None = None,
        trace: bool = False,
    ) -> Solution:
        """Solve one goal, from the pose of a continuity; what else is given is of no use here."""
        near = continuity.angles if continuity is not None and continuity.known else None
        turns = None if goal_turn is None else goal_turn[None]
        goals = np.asarray(goal, np.float64)[None]
        found = solve_turned(self._batch, goals, turns, near is not None, near).single(0)
        return replace(found, continuity=Continuity.from_pose(found.angles))

    def solve_many(
        self, goals: Array, *, goal_turns: Array | None = None, fk_offsets: Array | None = None
    ) -> Solution:
        """Solve goals, each on its own; see `solve_turned`."""
        return solve_turned(self._batch, goals, goal_turns, False)

    def follow(
        self, goals: Array, *, goal_turns: Array | None = None, fk_offsets: Array | None = None
    ) -> Solution:
        """Solve goals as a path; see `solve_turned`."""
        return solve_turned(self._batch, goals, goal_turns, True)
