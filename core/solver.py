"""`Solver`: a chain and its settings, ready to solve goals (000 §7.6)."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from copy import copy
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import InputError, PluginError
from limbik.core.flatten import SLOT_ORDER, Plugs, flat_body, flat_choice, flat_options, flat_plugs
from limbik.core.jit import Entry
from limbik.core.jointlimits import bound_limits
from limbik.core.portable import Portable
from limbik.core.pose import stages_of
from limbik.core.reach import pull_into_reach
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.solution import Continuity, Solution, Stage, Status
from limbik.core.solveinput import (
    Arrays,
    check_joints,
    checked,
    checked_memory,
    checked_turns,
    expected,
    with_turns,
)

FAILED = 10  # status numbers from here on name the slot whose strategy failed
THREAD_SHARE = 256  # goals a thread should at least have to be worth starting


class Solver(Portable):
    """Solves goals for one chain with one set of options; without state of its own.

    Args:
        chain: What to pose.
        settings: Options; the document's defaults when left out.
        registry: Where strategies are looked up; one with all installed plug-ins when left out.
        **options: Single settings by name, instead of or on top of `settings`.

    Raises:
        ChainError: The bend reference is not a joint of this chain.
        InputError: An option is unknown or out of its range, or a strategy is or its parameters.
    """

    _slots: ClassVar[tuple[str, ...]] = SLOT_ORDER
    _early_stages: ClassVar[tuple[str, ...]] = ("initial", "aim", "bend")

    def __init__(
        self,
        chain: Chain,
        settings: Settings | None = None,
        registry: Registry | None = None,
        **options: Any,
    ) -> None:
        own = Settings() if settings is None else expected(settings, Settings, "settings")
        self.chain, self.settings = expected(chain, Chain, "chain"), _joined(own, options)
        self._check_fit(self.chain, self.settings)
        self.registry = Registry() if registry is None else registry
        self._look_up()
        self._fixed: tuple[Any, ...] = self._flatten()
        self._none = np.zeros((len(chain), 3))
        self._fresh = np.zeros((len(chain) + 4, 3))

    def _look_up(self) -> None:
        """Find the strategies that settings and joints name."""
        self.strategies: dict[str, Bound] = {
            slot: self.registry.bind(slot, getattr(self.settings, slot)) for slot in self._slots
        }
        self.limits = bound_limits(self.chain, self.settings, self.registry)

    def altered(self, **options: Any) -> Self:
        """Return a solver of the same kind with some settings changed."""
        return self._alike(self.chain, _joined(self.settings, options))

    def mirrored(self) -> Self:
        """Return the solver of the chain mirrored in the world's YZ plane (M-14).

        It answers mirrored goals with the mirrored poses.
        """
        from limbik.core.mirror import mirrored_settings

        settings = mirrored_settings(self.settings, self.strategies)
        return self._alike(self.chain.mirrored(), settings)

    def moved(self, position: Array, rotation: Array) -> Self:
        """Return this solver for its chain with the base elsewhere, in a few microseconds.

        Args:
            position: Where the parent of joint 0 stands in the world, (3,) [length].
            rotation: Its axes in the world, (3, 3).
        """
        self._plugs, self._kernel  # noqa: B018 - made once, for all copies
        found = copy(self)
        found.chain = self.chain.moved(position, rotation)
        body = self._fixed[0]._replace(
            base_position=np.array(position, np.float64),
            base_rotation=found.chain.base_rotation,
        )
        found._fixed = (body, *self._fixed[1:])
        return found

    def _alike(self, chain: Chain, settings: Settings) -> Self:
        """Return a solver of this kind for another chain or other settings."""
        return type(self)(chain, settings, self.registry)

    @staticmethod
    def _check_fit(chain: Chain, settings: Settings) -> None:
        """Refuse settings that name joints the chain does not have."""
        check_joints(chain, settings, 1)

    def _flatten(self) -> tuple[Any, ...]:
        """Return what the kernel gets before the strategies."""
        flat = flat_body(self.chain, self.settings), flat_options(self.chain, self.settings)
        return (*flat, flat_choice(self.chain, self.settings)) if self._fully else flat

    @cached_property
    def _plugs(self) -> Plugs:
        """Addresses and parameters of the strategies; compiles them on first use."""
        return flat_plugs(self.chain, self.settings, self.strategies, self.limits)

    @cached_property
    def _kernel(self) -> Callable[..., int]:
        """The compiled solve; numba is imported here and not before.

        Every call passes arrays of the same types, made or checked here: they are looked at once.
        """
        solve_rows = self._entry()
        if not isinstance(solve_rows, Entry):
            return solve_rows
        out = Arrays.empty(1, len(self.chain), 0, self._columns)
        # Strategies are but addresses here and compiled later: `limbik.core.warm` has time.
        plugs = flat_plugs(self.chain, self.settings, {}, (None,) * len(self.chain))
        return solve_rows.direct(
            *self._arguments(plugs, np.zeros((1, 3)), self._none, self._fresh, False, out)
        )

    @property
    def _fully(self) -> bool:
        """Whether the settings ask for what is compiled apart."""
        return self.settings.choose is not None or self.settings.end_orientation > 0.0

    def _entry(self) -> Callable[..., int]:
        """The solve of many rows, not compiled yet."""
        if not self._fully:
            from limbik.core.kernels.solve3d import solve_goals

            return solve_goals
        from limbik.core.kernels.solve_fully import solve_fully

        return solve_fully

    def solve(
        self,
        goal: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
        trace: bool = False,
        goal_turn: ArrayLike | None = None,
    ) -> Solution:
        """Put the chain's end on a goal.

        Args:
            goal: World position, (3,) [length].
            fk_offsets: FK component relative to the rest pose, HPB, (n, 3) [rad].
            continuity: What an earlier solve returned; None solves without a past (M-02).
            trace: Whether to return every stage's pose.
            goal_turn: How the goal is turned in the world, HPB, (3,) [rad], or NaNs; the end takes
                it over by the setting `end_orientation` (M-05).

        Returns:
            The pose with status, distance and the continuity for a next solve.

        Raises:
            InputError: Goal, offsets or continuity are not finite or have another shape.
            PluginError: A strategy gave a result that is not a number.
        """
        rows = checked(goal, (3,), "goal").reshape(1, 3)
        turns = None if goal_turn is None else checked_turns(goal_turn, (3,)).reshape(1, 3)
        return self._solve_row(self._rows(rows, turns), fk_offsets, continuity, trace)

    def solve_many(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        threads: int | None = None,
        goal_turns: ArrayLike | None = None,
    ) -> Solution:
        """Solve goals that have nothing to do with each other, on all cores.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: As in `solve`, one set for all goals.
            threads: How many to use; None for as many as there are cores.
            goal_turns: How the goals are turned, HPB, (m, 3) [rad]; NaNs for goals without.

        Returns:
            A solution whose arrays have a leading goal axis; bit for bit what `solve` gives.

        Raises:
            InputError: The goals or the offsets are not finite or have another shape.
            PluginError: A strategy gave a result that is not a number.
        """
        rows = self._rows(checked(goals, (None, 3), "goals"), goal_turns)
        return self._solve_rows(rows, fk_offsets, threads)

    def follow(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
        goal_turns: ArrayLike | None = None,
    ) -> Solution:
        """Solve a path in order, each goal with the continuity of the one before.

        Goals, offsets, turns and errors are those of `solve_many`.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: HPB, (n, 3) [rad].
            continuity: State before the first goal; None for the rest pose's.
            goal_turns: HPB, (m, 3) [rad].

        Returns:
            A solution with a leading goal axis and the continuity after the last goal.
        """
        rows = self._rows(checked(goals, (None, 3), "goals"), goal_turns)
        return self._follow_rows(rows, fk_offsets, continuity)

    def _solve_row(
        self,
        rows: Array,
        fk_offsets: ArrayLike | None,
        continuity: Continuity | None,
        trace: bool,
    ) -> Solution:
        """Solve one row, (1, k): the goal, then what else the kernel takes for each."""
        memory = self._memory(continuity)
        stages = len(self._early_stages) + max(self.settings.max_iterations, 0) + len(_LATE_STAGES)
        out = Arrays.empty(1, len(self.chain), stages if trace else 0, self._columns)
        count = self._run(rows, self._offsets(fk_offsets), memory, False, out)
        numbers = out.numbers[0].tolist()
        if numbers[2] >= FAILED:
            raise self._blame(int(numbers[2]), rows[0, :3])
        return self._solution(
            out.numbers[0],
            rows[0],
            chain=self.chain,
            goal=rows[0, :3],
            angles=out.angles[0],
            positions=out.positions[0],
            rotations=out.rotations[0],
            iterations=int(numbers[0]),
            distance=numbers[1],
            status=_STATUS[int(numbers[2])],
            bend_vector=out.numbers[0, 3:6],
            bend_angle=numbers[6],
            continuity=Continuity(memory),
            trace=self._named(out.trace[:count], int(numbers[0])) if trace else None,
        )

    def _solve_rows(
        self, rows: Array, fk_offsets: ArrayLike | None, threads: int | None
    ) -> Solution:
        """Solve rows, (m, k), that have nothing to do with each other."""
        fk = self._offsets(fk_offsets)
        out = Arrays.empty(len(rows), len(self.chain), 0, self._columns)
        if threads is not None and expected(threads, int, "threads") < 1:
            raise InputError(f"threads: expected at least 1, found {threads}")
        workers = min(threads or os.cpu_count() or 1, max(len(rows) // THREAD_SHARE, 1))
        bounds = np.linspace(0, len(rows), workers + 1).astype(int).tolist()
        parts = [slice(a, b) for a, b in pairwise(bounds)]

        def run(part: slice) -> None:
            self._run(rows[part], fk, self._fresh.copy(), False, out.part(part))

        if workers == 1:
            run(parts[0])
        else:
            self._kernel, self._plugs  # noqa: B018 - compile once, before the threads start
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(run, parts))
        return self._many(rows, out, None)

    def _follow_rows(
        self, rows: Array, fk_offsets: ArrayLike | None, continuity: Continuity | None
    ) -> Solution:
        """Solve rows, (m, k), in order."""
        memory = self._memory(continuity)
        out = Arrays.empty(len(rows), len(self.chain), 0, self._columns)
        self._run(rows, self._offsets(fk_offsets), memory, True, out)
        return self._many(rows, out, Continuity(memory))

    def _named(self, angles: Array, rounds: int) -> tuple[Stage, ...]:
        names = [*self._early_stages, *(f"round {k + 1}" for k in range(rounds)), *_LATE_STAGES]
        return stages_of(self.chain, names, angles)

    @property
    def _columns(self) -> int:
        """How many numbers the kernel gives for each goal."""
        return 8

    def _solution(self, numbers: Array, row: Array, **fields: Any) -> Solution:
        """Make the solution of one goal or many; numbers and rows have more to read."""
        nearest = numbers[..., 7]
        return Solution(
            **fields,
            nearest=float(nearest) if numbers.ndim == 1 else nearest,
            limits=self.limits if any(self.limits) else None,
        )

    def _run(self, goals: Array, fk: Array, memory: Array, chained: bool, out: Arrays) -> int:
        kernel = self._kernel
        return kernel(*self._arguments(self._plugs, goals, fk, memory, chained, out))

    def _arguments(
        self, plugs: Plugs, goals: Array, fk: Array, memory: Array, chained: bool, out: Arrays
    ) -> tuple[Any, ...]:
        return (*self._fixed, plugs, goals, fk, memory, chained, *out)

    def _blame(self, failure: int, goal: Array) -> PluginError:
        """Return the error of a strategy whose result is not a number."""
        if failure == FAILED + len(SLOT_ORDER):
            bound = next(limit for limit in self.limits if limit is not None)
        else:
            bound = self.strategies[SLOT_ORDER[failure - FAILED]]
        return PluginError(
            f"its result for the goal {goal.tolist()} is not a finite number",
            bound.plugin.name,
            bound.name,
            bound.slot,
        )

    def _goals(self, goals: Array) -> Array:
        """Return goals as the solve gets them: pulled into reach when the settings say so."""
        if not self.settings.reach_limit:
            return goals
        return np.array(pull_into_reach(self.chain, goals), order="C")

    def _rows(self, goals: Array, turns: ArrayLike | None) -> Array:
        """Return what the kernel takes for each goal: its position, and its turn if it has one."""
        return self._goals(goals) if turns is None else with_turns(self._goals(goals), turns)

    def _memory(self, continuity: Continuity | None) -> Array:
        """Return a copy of a continuity's numbers to work on; the kernels trust its shape."""
        if continuity is None:
            return self._fresh.copy()
        given = expected(continuity, Continuity, "continuity")
        return checked_memory(given.memory, len(self.chain))

    def _offsets(self, fk_offsets: ArrayLike | None) -> Array:
        if fk_offsets is None:
            return self._none
        return checked(fk_offsets, (len(self.chain), 3), "FK offsets")

    def _many(self, rows: Array, out: Arrays, continuity: Continuity | None) -> Solution:
        status = out.numbers[:, 2].astype(np.int64)
        if (status >= FAILED).any():
            raise self._blame(int(status.max()), rows[status.argmax(), :3])
        return self._solution(
            out.numbers,
            rows,
            chain=self.chain,
            goal=rows[:, :3],
            angles=out.angles,
            positions=out.positions,
            rotations=out.rotations,
            iterations=out.numbers[:, 0].astype(np.int64),
            distance=out.numbers[:, 1],
            status=status,
            bend_vector=out.numbers[:, 3:6],
            bend_angle=out.numbers[:, 6],
            continuity=continuity,
        )


def _joined(settings: Settings, options: dict[str, Any]) -> Settings:
    """Return settings with single ones replaced, checked again."""
    if not options:
        return settings
    return Settings(**{**settings.model_dump(exclude_unset=True), **options})


_LATE_STAGES = ("finish", "choice")
_STATUS = {int(status): status for status in Status}
