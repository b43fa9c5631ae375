"""A scene's goals, or its planned trajectory, as a path in time that can be gone along."""

from dataclasses import dataclass, field

import numpy as np

from limbik.core.errors import LimbikError
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.solution import Continuity
from limbik.plugins.viewer.setup import Setup

RATE = 30.0  # goals a second of a path that says nothing
APART = 1.0  # seconds for each goal of a scene whose goals are no path


@dataclass(eq=False)
class Path:
    """Goals in time.

    Attributes:
        times: (m,) [s].
        goals: World positions, (m, 3) [length].
        names: m names.
        turns: How the goals are turned, HPB, (m, 3) [rad]; NaN for goals without, None for none.
        note: Why a planned trajectory is not shown; empty if all is well.
    """

    times: Array
    goals: Array
    names: tuple[str, ...]
    turns: Array | None = None
    note: str = ""
    _pasts: list[Continuity | None] = field(default_factory=lambda: [None])

    @classmethod
    def of(cls, scene: Scene) -> "Path":
        """Return the path of a scene: its trajectory if there is one and scipy, else its goals."""
        note = ""
        if scene.trajectory is not None:
            try:
                return cls._planned(scene)
            except LimbikError as error:
                note = str(error)
        step = 1.0 / RATE if scene.follow else APART
        if scene.judge is not None:
            step = 1.0 / scene.judge.rate
        elif scene.body is not None and scene.body.frame_time:
            step = scene.body.frame_time
        times = np.asarray(np.arange(len(scene.goals)) * step, np.float64)
        return cls(times, scene.goals, scene.goal_names, scene.goal_turns, note)

    @classmethod
    def _planned(cls, scene: Scene) -> "Path":
        from limbik.plugins.paths.scene_program import scene_trajectory

        assert scene.trajectory is not None
        samples = scene_trajectory(scene).sample(scene.trajectory.dt)
        names = tuple(f"{time:.2f} s" for time in samples.times)
        return cls(samples.times, samples.positions, names)

    def __len__(self) -> int:
        return len(self.goals)

    @property
    def duration(self) -> float:
        """Time from the first goal to the last [s]."""
        return float(self.times[-1])

    def frame(self, time: float) -> int:
        """Return the last goal at or before a time [s]."""
        return max(int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1, 0)

    def goal(self, frame: int) -> tuple[Array, Array | None]:
        """Return position and turn of a goal."""
        turn = None if self.turns is None else self.turns[frame]
        return self.goals[frame], turn

    def past(self, frame: int, setup: Setup) -> Continuity | None:
        """Return what the solves of all goals before a frame leave behind; they are kept."""
        while len(self._pasts) <= frame:
            goal, turn = self.goal(len(self._pasts) - 1)
            self._pasts.append(setup.solve(goal, turn, self._pasts[-1]).continuity)
        return self._pasts[frame]

    def forget(self) -> None:
        """Drop what was kept: the setup has changed."""
        del self._pasts[1:]
