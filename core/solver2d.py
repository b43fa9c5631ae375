"""`Solver2D`: a chain that bends in the plane of base, goal and pole (000 §6.2, §7.5)."""

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar, Final, Self

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import Chain, vector
from limbik.core.errors import Fault, InputError
from limbik.core.flatten2d import (
    Planar,
    flat_planar,
    flat_plane_body,
    flat_plane_options,
)
from limbik.core.jointlimits import refuse_limits
from limbik.core.pole import Pole, turn_pole
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.settings import Settings, misfits_in_2d
from limbik.core.solution import Continuity, Solution
from limbik.core.solution2d import PlanarSolution, PlaneFrom
from limbik.core.solveinput import check_joints, checked, checked_turns
from limbik.core.solver import Solver

COLUMNS: Final = 17  # numbers of a solve before its planar angles


class Solver2D(Solver):
    """Solves goals for one chain that bends toward a pole; without state of its own.

    Limits are the planar joints' (`Joint.planar`), not those of heading, pitch and bank.

    Args:
        chain: What to pose.
        settings: Options; the document's defaults when left out.
        registry: Where strategies are looked up; one with all installed plug-ins when left out.
        pole: Position in the world [length], or a `Pole`, which may have a rotor.
        **options: Single settings by name, instead of or on top of `settings`.

    Raises:
        ChainError: The bend reference is not a joint of this chain.
        InputError: As for `Solver`, or a setting belongs to the 3D solver.
    """

    _slots: ClassVar[tuple[str, ...]] = ("initial_bend",)
    _early_stages: ClassVar[tuple[str, ...]] = (
        "initial",
        "simple aim",
        "reference axis",
        "fk",
        "aim",
        "bend",
    )

    def __init__(
        self,
        chain: Chain,
        settings: Settings | None = None,
        registry: Registry | None = None,
        *,
        pole: Pole | Sequence[float] | Array,
        **options: Any,
    ) -> None:
        if not isinstance(pole, Pole):
            pole = Pole(position=vector(checked(pole, (3,), "pole")))
        self.pole = pole
        super().__init__(chain, settings, registry, **options)

    @staticmethod
    def _check_fit(chain: Chain, settings: Settings) -> None:
        misfits = list(misfits_in_2d(settings))
        if misfits:
            raise InputError(Fault(code, message, key) for key, code, message in misfits)
        check_joints(chain, settings, 0)
        refuse_limits(chain, "the 2D solver")

    def _flatten(self) -> tuple[Any, ...]:
        chain, settings = self.chain, self.settings
        return (
            flat_plane_body(chain, settings),
            flat_plane_options(chain, settings),
            flat_planar(chain, settings),
        )

    @property
    def _planar(self) -> Planar:
        found: Planar = self._fixed[2]
        return found

    @_planar.setter
    def _planar(self, planar: Planar) -> None:
        self._fixed = (*self._fixed[:2], planar)

    def _entry(self) -> Callable[..., int]:
        from limbik.core.kernels.solve2d import solve_plane_goals

        return solve_plane_goals

    def solve(
        self,
        goal: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
        trace: bool = False,
        pole: ArrayLike | None = None,
        goal_turn: ArrayLike | None = None,
    ) -> PlanarSolution:
        """Put the chain's end on a goal, bent toward the pole.

        As `Solver.solve`, with a pole.

        Args:
            goal: World position, (3,) [length].
            fk_offsets: HPB, (n, 3) [rad].
            continuity: What an earlier solve returned.
            trace: Whether to return every stage's pose.
            pole: Another position for the pole, (3,) [length].
            goal_turn: HPB, (3,) [rad]; moves a rotor only.

        Returns:
            The pose with status, distance, IK plane and the continuity for a next solve.
        """
        goals = checked(goal, (3,), "goal").reshape(1, 3)
        poles = None if pole is None else checked(pole, (3,), "pole").reshape(1, 3)
        turns = None if goal_turn is None else checked_turns(goal_turn, (3,)).reshape(1, 3)
        asked = self._ask(goals, poles, turns)
        return asked.finish(self._solve_row(asked.rows, fk_offsets, continuity, trace))

    def solve_many(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        threads: int | None = None,
        poles: ArrayLike | None = None,
        goal_turns: ArrayLike | None = None,
    ) -> PlanarSolution:
        """Solve goals that have nothing to do with each other, on all cores.

        As `Solver.solve_many`, with poles.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: HPB, (n, 3) [rad].
            threads: How many to use; None for as many as there are cores.
            poles: Other positions for the pole, (m, 3) [length].
            goal_turns: HPB, (m, 3) [rad].
        """
        points = checked(goals, (None, 3), "goals")
        asked = self._ask_many(points, poles, goal_turns)
        return asked.finish(self._solve_rows(asked.rows, fk_offsets, threads))

    def follow(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
        poles: ArrayLike | None = None,
        goal_turns: ArrayLike | None = None,
    ) -> PlanarSolution:
        """Solve a path in order, each goal with the continuity of the one before.

        As `Solver.follow`, with poles.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: HPB, (n, 3) [rad].
            continuity: State before the first goal; None for the rest pose's.
            poles: Other positions for the pole, (m, 3) [length].
            goal_turns: HPB, (m, 3) [rad].
        """
        points = checked(goals, (None, 3), "goals")
        asked = self._ask_many(points, poles, goal_turns)
        return asked.finish(self._follow_rows(asked.rows, fk_offsets, continuity))

    def bind(self, goal: ArrayLike | None = None) -> "Solver2D":
        """Return this solver bound to the rest pose: there the pose stays (M-04).

        See `limbik.core.bind.bound`. Altered or mirrored it stays bound.
        """
        from limbik.core.bind import bound

        return bound(self, goal)

    def mirrored(self) -> Self:
        """Return the solver of the chain and the pole mirrored in the world's YZ plane (M-14)."""
        x, y, z = self.pole.position
        found = super().mirrored().with_pole(np.array([-x, y, z]))
        found._planar = found._planar._replace(pole_turn=-self._planar.pole_turn)
        return found

    def moved(self, position: Array, rotation: Array) -> Self:
        """Return this solver for its chain with the base elsewhere; the pole stays."""
        found = super().moved(position, rotation)
        turn = rotation @ self.chain.base_rotation.T
        found._planar = self._planar._replace(
            rest_direction=np.ascontiguousarray(turn @ self._planar.rest_direction),
            rest_axis=np.ascontiguousarray(turn @ self._planar.rest_axis),
        )
        return found

    def with_pole(self, position: Array) -> Self:
        """Return this solver with its pole elsewhere, (3,) [length]; the rotor stays."""
        found = copy(self)
        found.pole = self.pole.model_copy(update={"position": vector(position)})
        return found

    def variant(self, planar: Planar, **options: Any) -> Self:
        """Return a solver with other planar numbers and settings, for `limbik.core.bind`."""
        found = self.altered(**options)
        found._planar = planar
        return found

    def _alike(self, chain: Chain, settings: Settings) -> Self:
        found = type(self)(chain, settings, self.registry, pole=self.pole)
        ours = self._planar
        found._planar = found._planar._replace(
            keeps_shape=ours.keeps_shape, pole_turn=ours.pole_turn, bound=ours.bound
        )
        return found

    def _ask_many(
        self, goals: Array, poles: ArrayLike | None, goal_turns: ArrayLike | None
    ) -> "_Asked":
        several = None if poles is None else checked(poles, (None, 3), "poles")
        turns = None if goal_turns is None else checked_turns(goal_turns, (None, 3))
        for given, what in ((several, "poles"), (turns, "goal turns")):
            if given is not None and len(given) != len(goals):
                raise InputError(f"{what}: expected {len(goals)}, one a goal, found {len(given)}")
        return self._ask(goals, several, turns)

    def _ask(self, goals: Array, poles: Array | None, turns: Array | None) -> "_Asked":
        """Put goals and poles side by side, the poles turned by the rotor unless given."""
        goals = self._goals(goals)
        rotor = self.pole.turns_by
        rows = np.empty((len(goals), 6))
        rows[:, :3], rows[:, 3:] = goals, self.pole.position
        frames = axes = None
        if rotor is not None:
            line = self._planar.rest_direction
            rows[:, 3:], frames, axes = turn_pole(self.chain, line, self.pole, rotor, goals, turns)
        elif turns is not None:
            axes = hpb_to_matrix(turns)
        if poles is not None:
            rows[:, 3:] = poles
        return _Asked(rows, frames, axes)

    @property
    def _columns(self) -> int:
        return COLUMNS + len(self.chain)

    def _solution(self, numbers: Array, row: Array, **fields: Any) -> PlanarSolution:
        source = numbers[..., 7]
        return PlanarSolution(
            **fields,
            plane=numbers[..., 8:COLUMNS].reshape(*numbers.shape[:-1], 3, 3),
            plane_from=_PLANE_FROM[int(source)] if numbers.ndim == 1 else source.astype(np.int64),
            planar_angles=numbers[..., COLUMNS:],
            planar_limits=self._limits,
            pole=row[..., 3:],
        )

    @cached_property
    def _limits(self) -> Array:
        return np.stack([self._planar.low, self._planar.high])


_PLANE_FROM = {int(source): source for source in PlaneFrom}


@dataclass(frozen=True, slots=True)
class _Asked:
    """What a call asks for: rows of goal and pole, the rotor's and the goals' axes."""

    rows: Array
    frames: Array | None
    axes: Array | None

    def finish(self, found: Solution) -> PlanarSolution:
        """Add the axes of rotor and goal to what the kernel found."""
        assert isinstance(found, PlanarSolution)
        if self.frames is None and self.axes is None:
            return found
        pick: Any = 0 if found.goal.ndim == 1 else slice(None)
        return replace(
            found,
            rotor=None if self.frames is None else self.frames[pick],
            goal_rotation=None if self.axes is None else self.axes[pick],
        )
