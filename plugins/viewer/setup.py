"""`Setup`: one chain and how it is solved; every change gives a new, checked one."""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cached_property
from typing import Any

import numpy as np

from limbik.core.chain import Chain, Joint, vector
from limbik.core.errors import LimbikError
from limbik.core.params import member_name, model, sample
from limbik.core.pole import Pole, PoleRotor
from limbik.core.posegoals import WholeSolver
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.settings import ONLY_3D, Settings
from limbik.core.slots import OPTIONS, SOLVER
from limbik.core.solution import Continuity, Solution
from limbik.core.solveinput import checked
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.core.solving import single_solver
from limbik.core.strategy import layout
from limbik.core.whole import OWN_SOLVERS
from limbik.plugins.viewer.controls import Control, controls

IN_PLANE = "2d"
PLAIN_FINISHES = ("newton", "none")  # all that 2D has, without parameters
Choice = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Setup:
    """A chain and all that decides how it is solved.

    Attributes:
        given: The scene as it was read.
        registry: Where strategies are looked up.
        choice: The solver, `{use: name, ...}`.
        settings: Options of all solvers; those the present one has no use for are kept.
        pole: Where the 2D solver bends to.
        fk: FK offsets, HPB, (n, 3) [rad].
        own: The joints' own limits, n of them, `{use: name, ...}`; None for ranges.
    """

    given: Scene
    registry: Registry
    choice: Choice
    settings: Settings
    pole: Pole
    fk: Array
    own: tuple[Choice | None, ...]

    @classmethod
    def of(cls, scene: Scene, registry: Registry) -> "Setup":
        """Make the setup of a scene."""
        choice: Choice = {"use": IN_PLANE if scene.pole else OWN_SOLVERS[0]}
        if scene.solver is not None:
            choice = {"use": scene.solver.name, **plain(scene.solver.params)}
        pole = scene.pole or _beside(scene.chain)
        own = tuple(_mapping(joint.limit) for joint in scene.chain.joints)
        return cls(scene, registry, choice, scene.settings, pole, scene.fk_offsets, own)

    @cached_property
    def chain(self) -> Chain:
        """The chain with the limits as they are now."""
        given = self.given.chain
        if self.own == tuple(_mapping(joint.limit) for joint in given.joints):
            return given
        return replace(given, joints=tuple(map(_limited, given.joints, self.own)))

    @property
    def takes_limits(self) -> bool:
        """Whether joints can be given other limits: the scene writes its chain itself."""
        return self.given.body is None

    @property
    def in_plane(self) -> bool:
        """Whether the 2D solver solves it, which has a pole."""
        return bool(self.choice["use"] == IN_PLANE)

    @property
    def slots(self) -> tuple[str, ...]:
        """The slots of the present solver that take a strategy."""
        if self.choice["use"] not in OWN_SOLVERS:
            return ()
        return ("initial_bend", "finish") if self.in_plane else tuple(OPTIONS)

    def offered(self, slot: str) -> list[str]:
        """Names of the strategies a slot of the present solver takes."""
        if self.in_plane and slot == "finish":
            return list(PLAIN_FINISHES)
        return list(self.registry.strategies(slot))

    def parameters(self, slot: str, name: str) -> list[Control]:
        """What can be set of a strategy, or of a solver."""
        if name in OWN_SOLVERS or (self.in_plane and slot == "finish"):
            return []
        return controls(model(self.registry.find(slot, name).strategy.params))

    @cached_property
    def options(self) -> list[Control]:
        """What can be set of the solve itself, as far as the present solver has it."""
        hidden = ONLY_3D if self.in_plane else ()
        return [control for control in controls(Settings) if control.path[0] not in hidden]

    @cached_property
    def scene(self) -> Scene:
        """The scene as it is now.

        Raises:
            LimbikError: The solver does not take this chain or its parameters.
        """
        solver = None
        if self.choice["use"] not in OWN_SOLVERS:
            solver = self.registry.bind(SOLVER.name, self.choice)
        return replace(
            self.given,
            chain=self.chain,
            settings=_fitting(self.settings, self.in_plane),
            solver=solver,
            pole=self.pole if self.in_plane else None,
            fk_offsets=self.fk,
        )

    @cached_property
    def solver(self) -> Solver | WholeSolver:
        """The solver of the scene as it is now."""
        return single_solver(self.scene, self.registry)

    @property
    def takes_turn(self) -> bool:
        """Whether the orientation of a goal has an effect: on a pole rotor, or on the end."""
        if isinstance(self.solver, WholeSolver):
            return self.solver.turns_end
        if self.in_plane:
            return self.pole.rotor is not None
        return self.settings.end_orientation > 0.0

    @cached_property
    def parts(self) -> dict[str, Solver]:
        """Solvers that give the IK and the FK component alone (C-14)."""
        if isinstance(self.solver, WholeSolver):
            return {}
        return {"IK": self.solver.altered(fk_mix=0.0), "FK": self.solver.altered(ik=False)}

    def solve(
        self,
        goal: Array,
        turn: Array | None = None,
        before: Continuity | None = None,
        trace: bool = False,
    ) -> Solution:
        """Solve one goal.

        Args:
            goal: World position, (3,) [length].
            turn: How the goal is turned, HPB [rad], or NaNs.
            before: Continuity of the solve before.
            trace: Whether to keep every stage's pose.

        Raises:
            LimbikError: The goal is not finite, or a strategy failed.
        """
        return self._ask(self.solver, checked(goal, (3,), "goal"), turn, before, trace)

    def again(self, found: Solution, turn: Array | None, pole: Array, part: str = "") -> Solution:
        """Solve what another solve was asked, from where its base was.

        Args:
            found: The other solve.
            turn: How the goal is turned.
            pole: Where the pole is, world, (3,) [length].
            part: `IK` or `FK` for that component alone.
        """
        chain = found.chain
        base = np.array(chain.base_position, np.float64)
        solver = (self.parts[part] if part else self.solver).moved(base, chain.base_rotation)
        if isinstance(solver, Solver2D):
            solver = solver.with_pole(pole)
        return self._ask(solver, found.goal, turn, None, bool(found.trace))

    def _ask(
        self,
        solver: Solver | WholeSolver,
        goal: Array,
        turn: Array | None,
        before: Continuity | None,
        trace: bool,
    ) -> Solution:
        asked: dict[str, Any] = {"fk_offsets": self.fk, "continuity": before, "trace": trace}
        if turn is not None:
            asked["goal_turn"] = turn
        return solver.solve(goal, **asked)

    def with_option(self, path: tuple[str, ...], value: Any) -> "Setup":
        """Return the setup with one option changed.

        Raises:
            LimbikError: The value is refused.
        """
        options = self.settings.model_dump(exclude_unset=True)
        return self._changed(settings=Settings(**put(options, path, value)))

    def with_strategy(self, slot: str, choice: Choice) -> "Setup":
        """Return the setup with another strategy, `{use: name, ...}`, in a slot or as the solver.

        Raises:
            LimbikError: There is none of this name, or its parameters are refused.
        """
        if slot == SOLVER.name:
            return self._changed(choice=choice)
        self.registry.bind(slot, choice)
        return self.with_option((slot,), choice)

    def with_pole(self, position: Array) -> "Setup":
        """Return the setup with its pole elsewhere, (3,) [length]; the rotor stays."""
        place = vector(checked(position, (3,), "pole"))
        return self._changed(pole=self.pole.model_copy(update={"position": place}))

    def with_rotor(self, rotor: str | dict[str, Any] | None) -> "Setup":
        """Return the setup with another pole rotor: a preset's name, a mapping, or None."""
        given: Any = PoleRotor(**rotor) if isinstance(rotor, dict) else rotor
        return self._changed(pole=Pole(position=self.pole.position, rotor=given))

    def with_bind(self, bind: bool) -> "Setup":
        """Return the setup whose 2D solver leaves the rest pose where it is, or not."""
        return self._changed(given=replace(self.given, bind=bind))

    def with_limit(self, joint: int, choice: Choice | None) -> "Setup":
        """Return the setup with another limit of one joint; None for its ranges.

        Raises:
            LimbikError: There is none of this name, its parameters are refused, or the solver
                takes none.
        """
        own = (*self.own[:joint], choice, *self.own[joint + 1 :])
        return self._changed(own=own)

    def with_fk(self, joint: int, turn: Array) -> "Setup":
        """Return the setup with another FK offset of one joint, HPB, (3,) [rad]."""
        offsets = self.fk.copy()
        offsets[joint] = checked(turn, (3,), "FK offset")
        return self._changed(fk=offsets)

    def chosen(self, slot: str) -> Choice:
        """Return the strategy in a slot, or the solver, with all its parameters."""
        if slot == SOLVER.name and self.choice["use"] in OWN_SOLVERS:
            return self.choice
        return self.full(slot, self.choice if slot == SOLVER.name else getattr(self.settings, slot))

    def full(self, slot: str, choice: str | Choice) -> Choice:
        """Return a choice with all its parameters."""
        bound = self.registry.bind(slot, choice)
        return {"use": bound.name, **plain(bound.params)}

    def fresh(self, slot: str, name: str) -> Choice:
        """Return the choice of a strategy with parameters to begin with."""
        if slot == SOLVER.name and name in OWN_SOLVERS:
            return {"use": name}
        return {"use": name, **plain(sample(self.registry.find(slot, name).strategy) or ())}

    @cached_property
    def solvers(self) -> tuple[list[str], dict[str, str]]:
        """Names of the solvers that take this chain, and why each other one does not."""
        fit, why = [], {}
        for name in (*OWN_SOLVERS, *self.registry.strategies(SOLVER.name)):
            try:
                self.with_strategy(SOLVER.name, self.fresh(SOLVER.name, name))
                fit.append(name)
            except LimbikError as error:
                why[name] = str(error)
        return fit, why

    def _changed(self, **changes: Any) -> "Setup":
        """Return a changed copy that is known to work."""
        changed = replace(self, **changes)
        changed.solver  # noqa: B018 - made now, so that it is refused now
        return changed


def _mapping(choice: str | Mapping[str, Any] | None) -> Choice | None:
    """Return a choice of a strategy as a mapping."""
    return {"use": choice} if isinstance(choice, str) else None if choice is None else dict(choice)


def _limited(joint: Joint, own: Choice | None) -> Joint:
    """Return a joint with a limit of its own, or with its ranges."""
    if own is None:
        return replace(joint, limit=None)
    return replace(joint, limit=own, heading=None, pitch=None, bank=None)


def plain(params: Any) -> dict[str, Any]:
    """Return a strategy's parameters as a scene writes them."""
    if not params:
        return {}
    return {
        field.name: member_name(value) if isinstance(value, IntEnum) else value
        for field, value in zip(layout(type(params)), params, strict=True)
    }


def put(values: Mapping[str, Any], path: tuple[str, ...], value: Any) -> dict[str, Any]:
    """Return nested mappings with the value at a path replaced."""
    found = deepcopy(dict(values))
    place = found
    for key in path[:-1]:
        place = place.setdefault(key, {})
    place[path[-1]] = value
    return found


def _fitting(settings: Settings, in_plane: bool) -> Settings:
    """Leave out what the 2D solver refuses, or what only it takes."""
    options = settings.model_dump(exclude_unset=True)
    if in_plane:
        options = {key: value for key, value in options.items() if key not in ONLY_3D}
        finish = settings.finish if isinstance(settings.finish, str) else settings.finish["use"]
        if "finish" in options:
            options["finish"] = finish if finish in PLAIN_FINISHES else PLAIN_FINISHES[0]
        if settings.max_iterations < -1:
            options["max_iterations"] = -1
    elif settings.bend_reference == 0:
        options["bend_reference"] = 1
    return Settings(**options)


def _beside(chain: Chain) -> Pole:
    """Return a pole for a chain that has none: off the middle of its rest pose, along y."""
    positions, rotations = chain.rest_pose
    place = (positions[0] + positions[-1]) / 2.0 + 0.8 * chain.length * rotations[0, :, 1]
    return Pole(position=vector(np.round(place, 6)))
