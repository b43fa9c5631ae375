"""`Session`: what the viewer shows and what a drag does to it; no browser, no drawing.

One session serves all pages that are open. Its callers hold `lock`: requests come from many
threads, and what counts is the newest state.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import RLock

import numpy as np

from limbik.core.body import BodyChain, BodySolution, BodySolver
from limbik.core.bodyscene import BodyScene
from limbik.core.errors import LimbikError
from limbik.core.goalturn import carried
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.skeleton import WORLD
from limbik.core.slots import SOLVER
from limbik.core.solution import Continuity, Solution
from limbik.core.solveinput import checked
from limbik.plugins.viewer.path import Path
from limbik.plugins.viewer.setup import Setup
from limbik.plugins.viewer.views import Flat

LAST = -1
PAUSE = 1.0  # [s] at the end of a path, before it begins again
PARTS = ("IK", "FK")
Pasts = Mapping[str, Continuity]


@dataclass(frozen=True, eq=False)
class Shown:
    """A chain as it is to be seen.

    Attributes:
        setup: How it was solved.
        solution: What came out.
        stages: Names of the stages there are to look at, the finished pose last; empty where only
            that was asked for.
        stage: Which of them this is, `LAST` for the finished pose.
        angles, positions, rotations: The pose of that stage.
        parts: Positions of the IK and of the FK component, of those asked for.
    """

    setup: Setup
    solution: Solution
    stages: tuple[str, ...]
    stage: int
    angles: Array
    positions: Array
    rotations: Array
    parts: dict[str, Array]


@dataclass
class Chained:
    """One chain of a session.

    Attributes:
        name: Its name.
        setup: How it is solved.
        goal: Position in the axes the scene gives its goals in, (3,) [length].
        turns: How the goals of the path are turned, HPB, (m, 3) [rad], or (1, 3) where somebody
            turned the goal; None where nothing is given.
        origin, axes: Of the goal's axes in the world.
    """

    name: str
    setup: Setup
    goal: Array = field(default_factory=lambda: np.zeros(3))
    turns: Array | None = None
    origin: Array = field(default_factory=lambda: np.zeros(3))
    axes: Array = field(default_factory=lambda: np.eye(3))

    def to_world(self, place: Array) -> Array:
        """Return a place in the world that is given in the goal's axes, (3,) [length]."""
        return np.asarray(self.origin + self.axes @ place)

    def from_world(self, place: Array) -> Array:
        """Return a place of the world in the goal's axes, (3,) [length]."""
        return np.asarray(self.axes.T @ (place - self.origin))

    def pole(self, setup: Setup) -> Array:
        """Return where a setup's pole is in the world, (3,) [length]."""
        return self.to_world(np.array(setup.pole.position))

    def turn(self, frame: int) -> Array | None:
        """Return how the goal is turned in a frame of the path, HPB [rad]."""
        return None if self.turns is None else self.turns[min(frame, len(self.turns) - 1)]

    def world_turn(self, setup: Setup, frame: int) -> Array | None:
        """Return it in the world; the 2D solver's turns are never in other axes."""
        turn = self.turn(frame)
        if turn is None or setup.in_plane:
            return turn
        return carried(self.axes, turn)


class Session:
    """Chains with their goals, and what of them is to be seen.

    Args:
        scene: The scene; its first goals are those to begin with.
        registry: Where strategies are looked up.

    Attributes:
        lock: To be held around every other use.
        chains: The chains by name, in the order they are solved.
        selected: Name of the chain the panels are about.
        body: The scene of a body; None for a single chain.
        path: The goals of the scene as a path in time.
        frame: Which goals of the path were taken last.
        follow: Whether each solve starts from the one before.
        stage: Index of the stage to look at; `LAST` for the finished pose.
        parts: Components to be shown as well, of `PARTS`.
        other: The selected chain with the solver to compare with; None for none.
        flat: The plane the chain moves in, if it is one.
        whole: The body as the last solve left it; None for a single chain.
    """

    def __init__(self, scene: Scene | BodyScene, registry: Registry) -> None:
        self.lock = RLock()
        self.name = scene.name
        self.body = scene if isinstance(scene, BodyScene) else None
        scenes = {scene.name: scene} if isinstance(scene, Scene) else {}
        if self.body is not None:
            scenes = {part.name: part.scene for part in self.body.parts}
        self.chains = {name: Chained(name, Setup.of(s, registry)) for name, s in scenes.items()}
        self.selected = next(iter(self.chains))
        self.path = Path.of(scene)
        self.frame, self._time = 0, 0.0
        self.follow = any(given.follow for given in scenes.values())
        self.stage = LAST
        self.parts: set[str] = set()
        self.other: Setup | None = None
        self.flat = Flat.of(scene.chain) if isinstance(scene, Scene) else None
        self.whole: BodySolution | None = None
        self._solver: BodySolver | None = None
        self._past: Pasts = {}
        self._pasts: list[Pasts] = [{}]
        self.go_to(0)

    @property
    def chain(self) -> Chained:
        """The chain the panels are about."""
        return self.chains[self.selected]

    def solve(self, stages: bool = False) -> dict[str, Shown]:
        """Solve all chains for their goals as they stand.

        Args:
            stages: Whether to list the stages; without it, and with the finished pose to be seen,
                a solve is several times as fast.

        Raises:
            LimbikError: A strategy failed; what was shown before may stay.
        """
        trace = stages or self.stage != LAST
        found = self._solve(self._past if self.follow else {}, trace)
        self._past = _continuity(found)
        return {name: self._shown(self.chains[name], one) for name, one in found.items()}

    def compared(self, shown: Mapping[str, Shown]) -> Shown | None:
        """Return what the other solver makes of the selected chain's goal; None without another."""
        if self.other is None:
            return None
        one = self.chain
        found = shown[one.name].solution
        turn = one.world_turn(self.other, self.frame)
        solution = self.other.again(found, turn, one.pole(self.other))
        return _seen(self.other, solution, self.stage, {})

    def move_goal(self, name: str, position: Array) -> None:
        """Put a chain's goal somewhere, (3,) [length], world.

        Raises:
            InputError: The position is not three finite numbers of a sensible size.
        """
        place = checked(position, (3,), "goal")
        one = self.chains[name]
        one.goal = one.from_world(self.flat.nearest(place) if self.flat else place)

    def turn_goal(self, name: str, turn: Array) -> None:
        """Turn a chain's goal, HPB, (3,) [rad], world."""
        one, given = self.chains[name], checked(turn, (3,), "goal's rotation")
        if not one.setup.in_plane:
            given = carried(one.axes.T, given)
        one.turns, self._solver = given.reshape(1, 3), None

    def change(self, name: str, setup: Setup) -> None:
        """Solve a chain another way from now on; it is tried before it is taken.

        Raises:
            LimbikError: It does not solve the present goal; everything stays as it was.
        """
        one, before = self.chains[name], self.chains[name].setup
        one.setup, self._solver = setup, None
        try:
            self._solve({})
        except LimbikError:
            one.setup, self._solver = before, None
            raise
        self._past, self._pasts = {}, [{}]
        if self.other is not None and name == self.selected:
            self.other = self._beside(setup)

    def compare(self, solver: str | None) -> None:
        """Choose the solver to compare with, by name; None for none.

        Raises:
            LimbikError: It does not take the chain.
        """
        if solver is None:
            self.other = None
            return
        setup = self.chain.setup
        self.other = setup.with_strategy(SOLVER.name, setup.fresh(SOLVER.name, solver))

    def select(self, name: str) -> None:
        """Let the panels be about another chain."""
        self.selected, self.other = self.chains[name].name, None

    def go_to(self, frame: int, keep_time: bool = False) -> None:
        """Take the goals of a frame of the path; on a path that is followed, its past too."""
        frame = min(max(int(frame), 0), len(self.path) - 1)
        if not keep_time:
            self._time = float(self.path.times[frame])
        if self.follow:
            self._past = self._past_of(frame)
        self._take(frame)

    def advance(self, seconds: float) -> None:
        """Go along the path for a time [s], from the end back to the start."""
        self._time += seconds
        if self._time > self.path.duration + PAUSE:
            self._time = 0.0
        self.go_to(self.path.frame(self._time), keep_time=True)

    @contextmanager
    def tried(self) -> Iterator[None]:
        """Put goals, frame and past back if what is done inside is refused."""
        kept = [(one, one.goal, one.turns) for one in self.chains.values()]
        frame, past = self.frame, self._past
        try:
            yield
        except LimbikError:
            for one, goal, turns in kept:
                one.goal, one.turns = goal, turns
            self.frame, self._past, self._solver = frame, past, None
            raise

    def _take(self, frame: int) -> None:
        """Take the goals of a frame."""
        self.frame = frame
        for name, one in self.chains.items():
            one.goal = self.path.goals[name][frame]
            turns = self.path.turns[name]
            if one.turns is not turns:
                one.turns, self._solver = turns, None

    def _past_of(self, frame: int) -> Pasts:
        """Return what the solves of all frames before one leave behind; they are kept."""
        while len(self._pasts) <= frame:
            self._take(len(self._pasts) - 1)
            self._pasts.append(_continuity(self._solve(self._pasts[-1])))
        return self._pasts[frame]

    def _solve(self, pasts: Pasts, trace: bool = False) -> dict[str, Solution]:
        """Solve all chains, a single one as it is, those of a body on their skeleton."""
        if self.body is None:
            one = self.chain
            turn, before = one.turn(self.frame), pasts.get(one.name)
            return {one.name: one.setup.solve(one.goal, turn, before, trace)}
        if self._solver is None:
            self._solver = self._body_solver(self.body)
        goals = {name: one.goal for name, one in self.chains.items()}
        found = self._solver.solve(goals, frame=self.frame, continuity=pasts, trace=trace)
        for part in self.body.parts:
            if part.frame != WORLD:
                one = self.chains[part.name]
                one.origin, one.axes = found.positions[part.frame], found.rotations[part.frame]
        self.whole = found
        return found.solutions

    def _body_solver(self, body: BodyScene) -> BodySolver:
        parts = []
        for part in body.parts:
            one = self.chains[part.name]
            limb, setup = part.limb, one.setup
            solved = (part.name, limb, setup.solver, setup.fk, part.frame, False, one.turns)
            parts.append(BodyChain(*solved))
        return BodySolver(body.skeleton, parts)

    def _shown(self, one: Chained, solution: Solution) -> Shown:
        turn = one.world_turn(one.setup, self.frame)
        parts = {
            part: one.setup.again(solution, turn, one.pole(one.setup), part).positions
            for part in self.parts
            if part in one.setup.parts
        }
        return _seen(one.setup, solution, self.stage, parts)

    def _beside(self, setup: Setup) -> Setup | None:
        """Return the setup to compare with for a changed one; None if it does not fit any more."""
        assert self.other is not None
        try:
            return setup.with_strategy(SOLVER.name, self.other.choice)
        except LimbikError:
            return None


def _continuity(found: Mapping[str, Solution]) -> Pasts:
    known = {name: solution.continuity for name, solution in found.items()}
    return {name: past for name, past in known.items() if past is not None}


def _seen(setup: Setup, solution: Solution, stage: int, parts: dict[str, Array]) -> Shown:
    """Pick the stage to be seen out of a solution."""
    trace = solution.trace or ()
    names = tuple(found.name for found in trace)
    if stage == LAST or stage >= len(trace) - 1:
        pose = solution.angles, solution.positions, solution.rotations
        return Shown(setup, solution, names, LAST, *pose, parts)
    positions, rotations = forward_kinematics(solution.chain, trace[stage].angles)
    return Shown(setup, solution, names, stage, trace[stage].angles, positions, rotations, parts)
