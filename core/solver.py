"""`Solver`: a chain and its settings, ready to solve goals (000 §7.6)."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import ChainError, InputError, PluginError
from limbik.core.flatten import SLOT_ORDER, Body, Options, Plugs, flat_body, flat_options
from limbik.core.jit import Entry
from limbik.core.pose import forward_kinematics
from limbik.core.reach import pull_into_reach
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.slots import PASSED_OVER
from limbik.core.solution import Continuity, Solution, Stage, Status

FAILED = 10  # status numbers from here on name the slot whose strategy failed
LARGEST = 1e100  # squares of larger numbers overflow
THREAD_SHARE = 256  # goals a thread should at least have to be worth starting


class Solver:
    """Solves goals for one chain with one set of options; without state of its own.

    Args:
        chain: What to pose.
        settings: Options; the document's defaults when left out.
        registry: Where strategies are looked up; one with all installed plug-ins when left out.
        **options: Single settings by name, instead of or on top of `settings`.

    Raises:
        ChainError: The bend reference is not a joint of this chain.
        InputError: A strategy is unknown or its parameters are wrong.
        pydantic.ValidationError: An option is out of its range.
    """

    def __init__(
        self,
        chain: Chain,
        settings: Settings | None = None,
        registry: Registry | None = None,
        **options: Any,
    ) -> None:
        given = Settings() if settings is None else settings
        if options:
            given = Settings(**{**given.model_dump(exclude_unset=True), **options})
        _check_fit(chain, given)
        self.chain = chain
        self.settings = given
        self.registry = Registry() if registry is None else registry
        self.strategies: dict[str, Bound] = {
            slot: self.registry.bind(slot, getattr(given, slot)) for slot in SLOT_ORDER
        }
        self._body: Body = flat_body(chain, given)
        self._options: Options = flat_options(chain, given)
        self._none = np.zeros((len(chain), 3))
        self._fresh = np.zeros((len(chain) + 4, 3))

    @cached_property
    def _plugs(self) -> Plugs:
        """Addresses and parameters of the strategies; compiles them on first use."""
        chosen = self.strategies
        return Plugs(
            **{slot: _address(chosen[slot]) for slot in SLOT_ORDER},
            params=np.array([chosen[slot].values for slot in SLOT_ORDER]),
        )

    @cached_property
    def _kernel(self) -> Callable[..., int]:
        """The compiled solve; numba is imported here and not before.

        Every call passes arrays of the same types, made or checked here: they are looked at once.
        """
        from limbik.core.kernels.solve3d import solve_goals

        if not isinstance(solve_goals, Entry):
            return solve_goals
        out = _Arrays(1, len(self.chain), 0)
        return solve_goals.direct(
            *self._arguments(np.zeros((1, 3)), self._none, self._fresh, False, out)
        )

    def solve(
        self,
        goal: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
        trace: bool = False,
    ) -> Solution:
        """Put the chain's end on a goal.

        Args:
            goal: World position, (3,) [length].
            fk_offsets: FK component relative to the rest pose, HPB, (n, 3) [rad].
            continuity: What an earlier solve returned; None solves without a past (M-02).
            trace: Whether to return every stage's pose.

        Returns:
            The pose with status, distance and the continuity for a next solve.

        Raises:
            InputError: Goal, offsets or continuity are not finite or have another shape.
            PluginError: A strategy gave a result that is not a number.
        """
        goals = self._goals(_checked(goal, (3,), "goal").reshape(1, 3))
        memory = self._memory(continuity)
        n = len(self.chain)
        stages = 4 + max(self.settings.max_iterations, 0) if trace else 0
        out = _Arrays(1, n, stages)
        count = self._run(goals, self._offsets(fk_offsets), memory, False, out)
        numbers = out.numbers[0].tolist()
        if numbers[2] >= FAILED:
            raise self._blame(int(numbers[2]), goals[0])
        return Solution(
            self.chain,
            goals[0],
            out.angles[0],
            out.positions[0],
            out.rotations[0],
            int(numbers[0]),
            numbers[1],
            _STATUS[int(numbers[2])],
            out.numbers[0, 3:6],
            numbers[6],
            Continuity(memory),
            self._stages(out.trace[:count], int(numbers[0])) if trace else None,
        )

    def solve_many(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Solution:
        """Solve goals that have nothing to do with each other, on all cores.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: As in `solve`, one set for all goals.
            threads: How many to use; None for as many as there are cores.

        Returns:
            A solution whose arrays have a leading goal axis; bit for bit what `solve` gives.

        Raises:
            InputError: The goals or the offsets are not finite or have another shape.
            PluginError: A strategy gave a result that is not a number.
        """
        points = self._goals(_checked(goals, (None, 3), "goals"))
        fk = self._offsets(fk_offsets)
        out = _Arrays(len(points), len(self.chain), 0)
        workers = min(threads or os.cpu_count() or 1, max(len(points) // THREAD_SHARE, 1))
        bounds = np.linspace(0, len(points), workers + 1).astype(int).tolist()
        parts = [slice(a, b) for a, b in pairwise(bounds)]

        def run(part: slice) -> None:
            self._run(points[part], fk, self._fresh.copy(), False, out.part(part))

        if workers == 1:
            run(parts[0])
        else:
            self._plugs, self._kernel  # noqa: B018 - compile once, before the threads start
            with ThreadPoolExecutor(workers) as pool:
                list(pool.map(run, parts))
        return self._many(points, out, None)

    def follow(
        self,
        goals: ArrayLike,
        *,
        fk_offsets: ArrayLike | None = None,
        continuity: Continuity | None = None,
    ) -> Solution:
        """Solve a path in order, each goal with the continuity of the one before.

        Args:
            goals: World positions, (m, 3) [length].
            fk_offsets: As in `solve`, one set for all goals.
            continuity: State before the first goal; None for the rest pose's.

        Returns:
            A solution with a leading goal axis and the continuity after the last goal.

        Raises:
            InputError: The goals or the offsets are not finite or have another shape.
            PluginError: A strategy gave a result that is not a number.
        """
        points = self._goals(_checked(goals, (None, 3), "goals"))
        memory = self._memory(continuity)
        out = _Arrays(len(points), len(self.chain), 0)
        self._run(points, self._offsets(fk_offsets), memory, True, out)
        return self._many(points, out, Continuity(memory))

    def _run(self, goals: Array, fk: Array, memory: Array, chained: bool, out: "_Arrays") -> int:
        return self._kernel(*self._arguments(goals, fk, memory, chained, out))

    def _arguments(
        self, goals: Array, fk: Array, memory: Array, chained: bool, out: "_Arrays"
    ) -> tuple[Any, ...]:
        return (
            self._body,
            self._options,
            self._plugs,
            goals,
            fk,
            memory,
            chained,
            out.angles,
            out.positions,
            out.rotations,
            out.numbers,
            out.trace,
        )

    def _blame(self, failure: int, goal: Array) -> PluginError:
        """Return the error of a strategy whose result is not a number."""
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

    def _memory(self, continuity: Continuity | None) -> Array:
        """Return a copy of a continuity's numbers to work on; the kernels trust its shape."""
        if continuity is None:
            return self._fresh.copy()
        memory = np.array(continuity.memory, np.float64, order="C")
        if memory.shape != self._fresh.shape:
            raise InputError(
                f"continuity: it is of a chain of {len(memory) - 4} joints, "
                f"this one has {len(self.chain)}"
            )
        if not np.isfinite(memory).all():
            raise InputError("continuity: every number must be finite")
        return memory

    def _offsets(self, fk_offsets: ArrayLike | None) -> Array:
        if fk_offsets is None:
            return self._none
        return _checked(fk_offsets, (len(self.chain), 3), "FK offsets")

    def _many(self, goals: Array, out: "_Arrays", continuity: Continuity | None) -> Solution:
        status = out.numbers[:, 2].astype(np.int64)
        if (status >= FAILED).any():
            raise self._blame(int(status.max()), goals[status.argmax()])
        return Solution(
            self.chain,
            goals,
            out.angles,
            out.positions,
            out.rotations,
            out.numbers[:, 0].astype(np.int64),
            out.numbers[:, 1],
            status,
            out.numbers[:, 3:6],
            out.numbers[:, 6],
            continuity,
        )

    def _stages(self, angles: Array, iterations: int) -> tuple[Stage, ...]:
        rounds = (f"round {k + 1}" for k in range(max(iterations, 0)))
        names = ["initial", "aim", "bend", *rounds, "finish"]
        positions, _ = forward_kinematics(self.chain, angles)
        return tuple(
            Stage(name, pose, places)
            for name, pose, places in zip(names, angles, positions, strict=False)
        )


_STATUS = {int(status): status for status in Status}


class _Arrays:
    """What a solve of m goals writes into."""

    __slots__ = ("angles", "numbers", "positions", "rotations", "trace")

    def __init__(self, m: int, n: int, stages: int) -> None:
        self.angles: Array = np.empty((m, n, 3))
        self.positions: Array = np.empty((m, n, 3))
        self.rotations: Array = np.empty((m, n, 3, 3))
        self.numbers: Array = np.empty((m, 7))
        self.trace: Array = np.empty((stages, n, 3))

    def part(self, rows: slice) -> "_Arrays":
        """Return views of some rows."""
        views = _Arrays(0, self.angles.shape[1], 0)
        views.angles, views.positions = self.angles[rows], self.positions[rows]
        views.rotations, views.numbers = self.rotations[rows], self.numbers[rows]
        return views


def _address(bound: Bound) -> int:
    """Return the address of a strategy, 0 for one that is passed over."""
    return 0 if bound.name == PASSED_OVER else bound.address


def _checked(values: ArrayLike, shape: tuple[int | None, ...], what: str) -> Array:
    """Return values as a contiguous float64 array, or say what is wrong with them."""
    try:
        # A copy, always: compiled code is entered with writable, contiguous arrays only.
        array = np.array(values, np.float64, order="C")
    except (TypeError, ValueError):
        raise InputError(f"{what}: expected numbers of shape {_shown(shape)}") from None
    expects_rows = shape[0] is None
    if array.ndim != len(shape) or array.shape[expects_rows:] != shape[expects_rows:]:
        raise InputError(f"{what}: expected shape {_shown(shape)}, found {array.shape}")
    # A few numbers are checked faster one by one than by numpy.
    few = array.ravel().tolist() if array.size < 16 else (array.min(), array.max())
    if not all(-LARGEST < value < LARGEST for value in few):
        raise InputError(f"{what}: every number must be finite and below {LARGEST:g} in size")
    return array


def _shown(shape: tuple[int | None, ...]) -> str:
    return "(" + ", ".join("m" if size is None else str(size) for size in shape) + ",)"


def _check_fit(chain: Chain, settings: Settings) -> None:
    """Refuse settings that name joints the chain does not have."""
    if settings.bend_reference > len(chain) - 1:
        raise ChainError(
            f"bend_reference {settings.bend_reference}: this chain of {len(chain)} joints "
            f"allows 1 to {len(chain) - 1}"
        )
    held = settings.held.base + settings.held.end
    if held > len(chain) - 1:
        raise ChainError(
            f"held: {held} joints held, this chain has {len(chain) - 1} before its end"
        )
