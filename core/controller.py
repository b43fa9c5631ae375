"""The controller: a goal with an orientation and habits of its own (000 §6.1(7)(A)-(D))."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import SHORTEST, Vector, vector
from limbik.core.errors import InputError
from limbik.core.reach import pull_into_reach
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.solution import Solution
from limbik.core.solver import Solver

Follows = Literal["own", "base", "end", "aim"]


@dataclass(frozen=True)
class Controller:
    """What the end of a chain is led by; a plain value, every solve returns the next one.

    Attributes:
        position: World position [length].
        turn: World orientation, HPB [rad].
        follows: What the orientation is after a solve: `own` keeps it, `base` and `end` copy the
            first and the last joint, `aim` lays Z along base→controller (C-07C).
        reach_limit: Whether it is pulled into the range of the end's distances (C-07A).
        hold_on_end: Whether it sits on the end while the solver's IK is off (C-07D).

    Raises:
        InputError: A number is not finite, or `follows` is none of its words.
    """

    position: Vector
    turn: Vector = (0.0, 0.0, 0.0)
    follows: Follows = "own"
    reach_limit: bool = False
    hold_on_end: bool = False

    def __post_init__(self) -> None:
        for what in ("position", "turn"):
            value = getattr(self, what)
            if np.shape(value) != (3,) or not np.isfinite(value).all():
                raise InputError(f"controller: {what} must be three finite numbers, not {value}")
        if self.follows not in get_args(Follows):
            words = ", ".join(get_args(Follows))
            raise InputError(f"controller: follows must be one of {words}, not {self.follows!r}")

    def moved(self, position: ArrayLike) -> "Controller":
        """Return the controller at another world position [length]."""
        return replace(self, position=vector(position))

    def lead(
        self, solver: Solver, before: "Led | None" = None, fk_offsets: ArrayLike | None = None
    ) -> "Led":
        """Solve for the controller's position.

        While controller, solver and FK offsets rest, nothing is solved, even where end and
        controller are apart (C-07B).

        Args:
            solver: Of the chain.
            before: What the last call returned; its continuity is handed on.
            fk_offsets: As in `Solver.solve`.

        Returns:
            The solution and the controller as it stands afterwards.

        Raises:
            InputError: Chain and controller or offsets do not fit.
            PluginError: A strategy gave a result that is not a number.
        """
        key = None if fk_offsets is None else np.array(fk_offsets, np.float64).tobytes()
        if before is not None and self._rests(before, solver, key):
            return before
        chain = solver.chain
        goal = pull_into_reach(chain, self.position) if self.reach_limit else self.position
        continuity = None if before is None else before.solution.continuity
        turn = self.turn if solver.settings.end_orientation else None
        solution = solver.solve(goal, fk_offsets=fk_offsets, continuity=continuity, goal_turn=turn)
        held = self.hold_on_end and not solver.settings.ik
        place = solution.positions[-1] if held else solution.goal
        turn = self._turn(solution, place)
        stands = replace(self, position=vector(place), turn=turn)
        return Led(stands, self, solution, solver, key)

    def _rests(self, before: "Led", solver: Solver, key: bytes | None) -> bool:
        """Whether nothing has changed that a solve depends on."""
        same = before.solver is solver and before.offsets == key
        return same and self in (before.controller, before.asked)

    def _turn(self, solution: Solution, place: Array) -> Vector:
        """Return the orientation after a solve, HPB [rad]."""
        if self.follows == "base":
            return vector(matrix_to_hpb(solution.rotations[0]))
        if self.follows == "end":
            return vector(matrix_to_hpb(solution.rotations[-1]))
        away = place - solution.positions[0]
        if self.follows == "own" or not np.linalg.norm(away) > SHORTEST:
            return self.turn
        heading = -np.arctan2(away[0], away[2])
        return vector((heading, np.arctan2(away[1], np.hypot(away[0], away[2])), 0.0))

    @property
    def rotation(self) -> Array:
        """World orientation as a matrix, (3, 3)."""
        return hpb_to_matrix(self.turn)


@dataclass(frozen=True, eq=False)
class Led:
    """What leading a chain by a controller gave.

    Attributes:
        controller: The controller after the solve: pulled into reach, held on the end, turned.
        asked: The controller as it was before.
        solution: Of the solve.
        solver: That solved it.
        offsets: The FK offsets it was solved with, as bytes; None for none.
    """

    controller: Controller
    asked: Controller
    solution: Solution
    solver: Solver
    offsets: bytes | None
