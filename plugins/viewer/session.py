"""`Session`: what the viewer shows and what a drag does to it; no browser, no drawing.

One session serves all pages that are open. Its callers hold `lock`: requests come from many
threads, and what counts is the newest state.
"""

from dataclasses import dataclass
from threading import RLock

from limbik.core.errors import LimbikError
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.slots import SOLVER
from limbik.core.solution import Continuity, Solution
from limbik.core.solveinput import checked
from limbik.plugins.viewer.path import Path
from limbik.plugins.viewer.setup import Setup
from limbik.plugins.viewer.views import Flat

LAST = -1
PAUSE = 1.0  # [s] at the end of a path, before it begins again
PARTS = ("IK", "FK")


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
        goal: World position, (3,) [length].
        turn: How the goal is turned, HPB [rad]; None where nothing is given.
        past: Continuity of the last solve.
    """

    name: str
    setup: Setup
    goal: Array
    turn: Array | None = None
    past: Continuity | None = None


class Session:
    """Chains with their goals, and what of them is to be seen.

    Args:
        scene: The scene; its first goal is the one to begin with.
        registry: Where strategies are looked up.

    Attributes:
        lock: To be held around every other use.
        chains: The chains by name.
        path: The goals of the scene as a path in time.
        frame: Which goal of the path was taken last.
        follow: Whether each solve starts from the one before.
        stage: Index of the stage to look at; `LAST` for the finished pose.
        parts: Components to be shown as well, of `PARTS`.
        other: The solver to compare with, `{use: name}`; None for none.
        flat: The plane the chain moves in, if it is one.
    """

    def __init__(self, scene: Scene, registry: Registry) -> None:
        self.lock = RLock()
        self.name = scene.name
        self.chains = {scene.name: Chained(scene.name, Setup.of(scene, registry), scene.goals[0])}
        self.path = Path.of(scene)
        self.frame = 0
        self.follow = scene.follow
        self.stage = LAST
        self.parts: set[str] = set()
        self.other: Setup | None = None
        self.flat = Flat.of(scene.chain)
        self.go_to(0)

    @property
    def chain(self) -> Chained:
        """The chain the panels are about."""
        return next(iter(self.chains.values()))

    def solve(self, stages: bool = False) -> dict[str, Shown]:
        """Solve all chains for their goals as they stand.

        Args:
            stages: Whether to list the stages; without it, and with the finished pose to be seen,
                a solve is several times as fast.

        Raises:
            LimbikError: A strategy failed; what was shown before may stay.
        """
        trace = stages or self.stage != LAST
        return {name: self._solved(chained, trace) for name, chained in self.chains.items()}

    def compared(self) -> Shown | None:
        """Return what the other solver makes of the same goal; None without another."""
        if self.other is None:
            return None
        one = self.chain
        solution = self.other.solve(one.goal, one.turn, None, self.stage != LAST)
        return _shown(self.other, solution, self.stage, {})

    def move_goal(self, name: str, position: Array) -> None:
        """Put a chain's goal somewhere, (3,) [length], world.

        Raises:
            InputError: The position is not three finite numbers of a sensible size.
        """
        place = checked(position, (3,), "goal")
        self.chains[name].goal = self.flat.nearest(place) if self.flat else place

    def turn_goal(self, name: str, turn: Array) -> None:
        """Turn a chain's goal, HPB, (3,) [rad]."""
        self.chains[name].turn = checked(turn, (3,), "goal's rotation")

    def change(self, name: str, setup: Setup) -> None:
        """Solve a chain another way from now on; it is tried before it is taken.

        Raises:
            LimbikError: It does not solve the present goal; everything stays as it was.
        """
        one = self.chains[name]
        setup.solve(one.goal, one.turn)
        one.setup, one.past = setup, None
        self.path.forget()
        if self.other is not None and name == self.chain.name:
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

    def go_to(self, frame: int, keep_time: bool = False) -> None:
        """Take the goals of a frame of the path; on a path that is followed, its past too."""
        self.frame = min(max(int(frame), 0), len(self.path) - 1)
        if not keep_time:
            self._time = float(self.path.times[self.frame])
        one = self.chain
        one.goal, one.turn = self.path.goal(self.frame)
        one.past = self.path.past(self.frame, one.setup) if self.follow else None

    def advance(self, seconds: float) -> None:
        """Go along the path for a time [s], from the end back to the start."""
        self._time += seconds
        if self._time > self.path.duration + PAUSE:
            self._time = 0.0
        self.go_to(self.path.frame(self._time), keep_time=True)

    def _solved(self, one: Chained, trace: bool) -> Shown:
        before = one.past if self.follow else None
        solution = one.setup.solve(one.goal, one.turn, before, trace)
        one.past = solution.continuity
        parts = {
            part: one.setup.solve(one.goal, one.turn, before, part=part).positions
            for part in self.parts
            if one.setup.parts
        }
        return _shown(one.setup, solution, self.stage, parts)

    def _beside(self, setup: Setup) -> Setup | None:
        """Return the setup to compare with for a changed one; None if it does not fit any more."""
        assert self.other is not None
        try:
            return setup.with_strategy(SOLVER.name, self.other.choice)
        except LimbikError:
            return None


def _shown(setup: Setup, solution: Solution, stage: int, parts: dict[str, Array]) -> Shown:
    """Pick the stage to be seen out of a solution."""
    trace = solution.trace or ()
    names = tuple(found.name for found in trace)
    if stage == LAST or stage >= len(trace) - 1:
        pose = solution.angles, solution.positions, solution.rotations
        return Shown(setup, solution, names, LAST, *pose, parts)
    positions, rotations = forward_kinematics(solution.chain, trace[stage].angles)
    return Shown(setup, solution, names, stage, trace[stage].angles, positions, rotations, parts)
