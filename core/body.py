"""`BodySolver`: several chains on one skeleton, solved one after the other (M-11).

A chain solved earlier moves the base of those that hang from it; each has its own solver.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.bodyorder import order_faults
from limbik.core.bodyscene import BodyScene
from limbik.core.errors import Fault, InputError
from limbik.core.goalturn import carried
from limbik.core.posegoals import WholeSolver
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.skeleton import WORLD, Limb, Skeleton
from limbik.core.solution import Continuity, Solution
from limbik.core.solveinput import checked, expected
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.core.solving import single_solver
from limbik.core.wording import near_match


@dataclass(frozen=True, eq=False)
class BodyChain:
    """One chain of a body, ready to solve.

    Attributes:
        name: Unique in the body.
        limb: The chain as a part of the skeleton.
        solver: Of the limb's chain.
        fk_offsets: As `Solver.solve` takes them, (n, 3) [rad]; None for none.
        frame: Index of the joint in whose frame goals and pole are; -1 for the world.
        follow: Whether `frames` solves each goal from the pose before.
        turns: How the goals of the frames are turned, HPB, (m, 3) [rad], in the axes of `frame`;
            NaN for goals without.
    """

    name: str
    limb: Limb
    solver: Solver | WholeSolver
    fk_offsets: Array | None = None
    frame: int = WORLD
    follow: bool = False
    turns: Array | None = None


@dataclass(frozen=True, eq=False, slots=True)
class BodySolution:
    """A body in one frame.

    Attributes:
        skeleton: The skeleton; its `names` and `parents` are those of the arrays.
        solutions: What became of each chain that had a goal, by its name, in the world.
        positions: World positions of all joints, (n, 3) [length].
        rotations: Their world rotations, (n, 3, 3).
        continuity: Of each chain, for the next solve of a path.
        goal_turns: How the goals of chains that turn by them are turned in the world, HPB, (3,)
            [rad]; NaN for a goal without.
    """

    skeleton: Skeleton
    solutions: dict[str, Solution]
    positions: Array
    rotations: Array
    continuity: dict[str, Continuity]
    goal_turns: dict[str, Array] = field(default_factory=dict)

    @property
    def reached(self) -> bool:
        """Whether every chain is on its goal."""
        return all(bool(solution.reached) for solution in self.solutions.values())


class BodySolver:
    """Solves the chains of a skeleton in order; without state of its own.

    Args:
        skeleton: The skeleton.
        chains: In the order they are solved, each moving the base of those after it.

    Raises:
        InputError: Two chains have one name or turn one joint, or the order undoes a chain.
    """

    def __init__(self, skeleton: Skeleton, chains: Sequence[BodyChain]) -> None:
        names = [chain.name for chain in chains]
        faults = [
            Fault("duplicate-name", f"two chains are called '{name}'", name)
            for name in set(names)
            if names.count(name) > 1
        ]
        limbs = [(chain.name, chain.limb, chain.frame) for chain in chains]
        faults += [fault for _, fault in order_faults(skeleton, limbs)]
        if faults:
            raise InputError(faults)
        self.skeleton = skeleton
        self.chains = tuple(chains)
        self._places, self._rotations = skeleton.motion.world()
        self._moves = [_Moves(skeleton, chain.limb) for chain in chains]

    @classmethod
    def of(cls, scene: BodyScene, registry: Registry | None = None) -> "BodySolver":
        """Make the solver of a scene.

        Args:
            scene: The scene.
            registry: Where the strategies are looked up; a new `Registry()` if absent.

        Raises:
            InputError: The scene binds a rest pose that cannot stay.
        """
        registry = registry or Registry()
        expected(scene, BodyScene, "scene")
        chains = [
            BodyChain(
                part.name,
                part.limb,
                single_solver(part.scene, registry),
                part.scene.fk_offsets,
                part.frame,
                part.scene.follow,
                part.scene.goal_turns,
            )
            for part in scene.parts
        ]
        return cls(scene.skeleton, chains)

    def solve(
        self,
        goals: Mapping[str, ArrayLike],
        *,
        frame: int = 0,
        poles: Mapping[str, ArrayLike] | None = None,
        continuity: Mapping[str, Continuity] | None = None,
        trace: bool = False,
    ) -> BodySolution:
        """Put the chains' ends on their goals.

        Args:
            goals: A position for each chain, by its name, (3,) [length], in the world or the
                chain's frame; a chain without one stays as the skeleton has it.
            frame: Frame of the skeleton's own motion to start from.
            poles: Other positions for the poles of chains with the 2D solver, likewise.
            continuity: What an earlier solve returned; None solves without a past.
            trace: Whether the solutions keep every stage's pose; slower.

        Raises:
            InputError: There is no such chain or frame, or a goal is not three finite numbers.
            PluginError: A strategy failed.
        """
        poles = poles or {}
        self._check(goals, poles, frame)
        motion = self.skeleton.motion
        at = frame if len(motion.turns) > 1 else 0
        places, rotations = self._places[at].copy(), self._rotations[at].copy()
        found = BodySolution(self.skeleton, {}, places, rotations, {})
        for chain, moves in zip(self.chains, self._moves, strict=True):
            if chain.name in goals:
                goal = checked(goals[chain.name], (3,), f"goal of '{chain.name}'")
                if chain.name in poles:
                    chain = _with_pole(chain, poles[chain.name])
                before = (continuity or {}).get(chain.name)
                solution = self._solve(chain, goal, frame, before, trace, found)
                moves.carry(solution, motion.offsets[at], motion.turns[at], found)
        return found

    def frames(
        self, goals: Mapping[str, ArrayLike], *, trace: bool = False
    ) -> Iterator[BodySolution]:
        """Solve frame after frame; chains that `follow` start from their pose before.

        Args:
            goals: Positions for each chain, by its name, (m, 3) [length].
            trace: As in `solve`.

        Raises:
            InputError: As `solve`, or the numbers of goals differ.
        """
        rows = {
            name: checked(given, (None, 3), f"goals of '{name}'") for name, given in goals.items()
        }
        counts = {len(given) for given in rows.values()}
        if len(counts) > 1:
            raise InputError(f"goals: every chain needs as many, found {sorted(counts)}")
        followed = {chain.name for chain in self.chains if chain.follow}
        kept: dict[str, Continuity] = {}
        for frame in range(max(counts, default=0)):
            given = {name: places[frame] for name, places in rows.items()}
            found = self.solve(given, frame=frame, continuity=kept, trace=trace)
            kept = {name: past for name, past in found.continuity.items() if name in followed}
            yield found

    def _check(
        self, goals: Mapping[str, ArrayLike], poles: Mapping[str, ArrayLike], frame: int
    ) -> None:
        names = [chain.name for chain in self.chains]
        for name in (*goals, *poles):
            if name not in names:
                hint = near_match(name, names) or f"chains: {', '.join(names)}"
                raise InputError(Fault("unknown-chain", f"no chain is called '{name}'", hint=hint))
        count = len(self.skeleton.motion.turns)
        if count > 1 and not 0 <= frame < count:
            raise InputError(f"frame {frame}: the skeleton moves for frames 0 to {count - 1}")

    def _solve(
        self,
        chain: BodyChain,
        goal: Array,
        frame: int,
        before: Continuity | None,
        trace: bool,
        found: BodySolution,
    ) -> Solution:
        """Solve one chain from where its base is by now."""
        place, turn = self.skeleton.placed(chain.limb, found.positions, found.rotations)
        solver = chain.solver.moved(place, turn)
        asked: dict[str, Any] = {
            "fk_offsets": chain.fk_offsets,
            "continuity": before,
            "trace": trace,
        }
        turned = None if chain.turns is None else chain.turns[min(frame, len(chain.turns) - 1)]
        if chain.frame != WORLD:
            origin, axes = found.positions[chain.frame], found.rotations[chain.frame]
            goal = origin + axes @ goal
            if turned is not None:
                turned = carried(axes, turned)
            if isinstance(solver, Solver2D):
                solver = solver.with_pole(origin + axes @ np.array(solver.pole.position))
        if turned is not None:
            found.goal_turns[chain.name] = asked["goal_turn"] = turned
        solution = solver.solve(goal, **asked)
        found.solutions[chain.name] = solution
        if solution.continuity is not None:
            found.continuity[chain.name] = solution.continuity
        return solution


def _with_pole(chain: BodyChain, pole: ArrayLike) -> BodyChain:
    """Return a chain with its pole elsewhere, in the chain's frame."""
    if not isinstance(chain.solver, Solver2D):
        raise InputError(f"pole of '{chain.name}': only the 2D solver has a pole")
    place = checked(pole, (3,), f"pole of '{chain.name}'")
    return replace(chain, solver=chain.solver.with_pole(place))


class _Moves:
    """What a solved limb moves: its own joints, and those that hang from them."""

    def __init__(self, skeleton: Skeleton, limb: Limb) -> None:
        self._at = np.array(limb.at)
        self._written = np.array(limb.at[: limb.written])
        self._after = limb.after[: limb.written]
        first, own = limb.at[0], {WORLD, *limb.at[: limb.written]}
        below = [k for k in range(first, len(skeleton.names)) if first in skeleton.above(k)]
        self._below = [(k, skeleton.parents[k]) for k in below if k not in own]

    def carry(self, solution: Solution, offsets: Array, turns: Array, found: BodySolution) -> None:
        """Put the limb's joints where they were solved, and what hangs from them along.

        Args:
            solution: Of the limb.
            offsets: Of the skeleton's joints in their parents' frames, (n, 3) [length].
            turns: Of the skeleton's joints relative to their parents, (n, 3, 3).
            found: What is changed.
        """
        positions, rotations = found.positions, found.rotations
        positions[self._at] = solution.positions
        rotations[self._written] = solution.rotations[: len(self._written)] @ self._after
        for joint, parent in self._below:
            positions[joint] = positions[parent] + rotations[parent] @ offsets[joint]
            rotations[joint] = rotations[parent] @ turns[joint]


def solve_body(
    scene: BodyScene, registry: Registry | None = None, trace: bool = False
) -> list[BodySolution]:
    """Solve all frames of a scene.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new `Registry()` if absent.
        trace: Whether the solutions keep every stage's pose; slower.

    Raises:
        PluginError: A strategy failed.
    """
    return list(BodySolver.of(scene, registry).frames(scene.goals, trace=trace))


def chain_solutions(found: Sequence[BodySolution]) -> dict[str, list[Solution]]:
    """Return the solutions of each chain, frame after frame, by its name."""
    return {name: [body.solutions[name] for body in found] for name in found[0].solutions}


def bodies_met(scene: BodyScene, found: Sequence[BodySolution]) -> bool:
    """Whether every chain whose IK is on is on its goal in every frame."""
    pursued = [part.name for part in scene.parts if part.scene.settings.ik]
    return all(bool(body.solutions[name].reached) for body in found for name in pursued)


def followed(scene: BodyScene, follow: bool) -> BodyScene:
    """Return a scene whose chains all solve each frame from the one before, or none does."""
    parts = [replace(part, scene=replace(part.scene, follow=follow)) for part in scene.parts]
    return replace(scene, parts=tuple(parts))
