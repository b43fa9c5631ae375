"""A scene's goals, solved, with everything the measures look at."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from limbik.core.chain import Chain
from limbik.core.kernels.reach import least_reach
from limbik.core.motion import turn_between
from limbik.core.posegoals import WholeSolver
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import Scene, require_goals
from limbik.core.settings import Settings
from limbik.core.solution import Solution
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver import Solver
from limbik.core.solving import single_solver, solve_goals

RATE = 60.0  # goals a second where a scene gives no rate


class NotJudged(Exception):
    """A measure says nothing about this scene; the message tells why."""


@dataclass(frozen=True, eq=False)
class Run:
    """A solved path of m goals of a chain of n joints.

    Attributes:
        solver: What solved it, limbik's own or a plug-in's; measures that replay the path use it
            again.
        goals: (m, 3) [length].
        fk_offsets: (n, 3) [rad].
        follow: Whether each goal was solved from the pose before it.
        rate: Goals a second [1/s].
        solution: With a leading goal axis.
        turns: How the goals are turned, HPB, (m, 3) [rad], NaN for goals without; None if nothing
            turns by them.
    """

    solver: Solver | WholeSolver
    goals: Array
    fk_offsets: Array
    follow: bool
    rate: float
    solution: Solution
    turns: Array | None = None

    @property
    def chain(self) -> Chain:
        """The chain."""
        return self.solver.chain

    @property
    def settings(self) -> Settings:
        """The options."""
        return self.solver.settings

    @cached_property
    def from_root(self) -> Array:
        """Distances of the goals from the bend root [length], (m,)."""
        root = self.settings.bend_reference - 1
        return np.asarray(np.linalg.norm(self.goals - self.solution.positions[:, root], axis=1))

    @cached_property
    def reach(self) -> float:
        """Length of the bones from the bend root on [length]."""
        return float(self.chain.lengths[self.settings.bend_reference - 1 :].sum())

    @property
    def hole(self) -> float:
        """Least distance from the bend root that bones without limits can have [length]."""
        bones = self.chain.lengths[self.settings.bend_reference - 1 :]
        return least_reach(float(bones.sum()), float(bones.max()))

    @property
    def is_limited(self) -> bool:
        """Whether any joint before the end has a limit."""
        if isinstance(self.solution, PlanarSolution):
            return bool(np.isfinite(self.solution.planar_limits).any())
        return bool(np.isfinite(self.chain.high[:-1]).any() or any(self.solution.limits or ()))

    def solve(
        self, goals: Array, turns: Array | None, solver: Solver | WholeSolver | None = None
    ) -> Solution:
        """Solve other goals the way the scene does.

        Args:
            goals: (k, 3) [length].
            turns: How they are turned, HPB, (k, 3) [rad], or None.
            solver: Another one than the scene's.
        """
        chosen = self.solver if solver is None else solver
        many = chosen.follow if self.follow else chosen.solve_many
        return many(goals, goal_turns=turns, fk_offsets=self.fk_offsets)

    def own_solver(self, what: str) -> Solver:
        """Return limbik's own solver, for what only that one knows.

        Raises:
            NotJudged: A plug-in's solved the path.
        """
        if isinstance(self.solver, Solver):
            return self.solver
        raise NotJudged(f"the solver {self.solver.name} knows no {what}")


def run_scene(scene: Scene, registry: Registry | None = None) -> Run:
    """Solve a scene's goals in order.

    Args:
        scene: The scene; its goals are a path at a steady rate.
        registry: Where the strategies are looked up; a new one if absent.
    """
    rate = RATE if scene.judge is None else scene.judge.rate
    require_goals(scene)
    solver = single_solver(scene, registry)
    solution = solve_goals(scene, registry)
    offsets = scene.fk_offsets
    return Run(solver, scene.goals, offsets, scene.follow, rate, solution, scene.goal_turns)


def pose_difference(first: Array, second: Array) -> float:
    """Return the largest turn of a joint before the end between poses (..., n, 3) [rad]."""
    return float(turn_between(hpb_to_matrix(first), hpb_to_matrix(second))[..., :-1].max())
