"""A scene's goals, or its planned trajectory, as a path in time that can be gone along."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from limbik.core.bodyscene import BodyScene
from limbik.core.errors import LimbikError
from limbik.core.rotation import Array, matrix_to_hpb
from limbik.core.scene import Scene, require_goals

RATE = 30.0  # goals a second of a path that says nothing
APART = 1.0  # seconds for each goal of a scene whose goals are no path


@dataclass(frozen=True, eq=False)
class Path:
    """Goals of one chain or several in time.

    Attributes:
        times: (m,) [s].
        names: m names.
        goals: Positions for each chain, by its name, (m, 3) [length].
        turns: How they are turned, HPB, (m, 3) [rad]; NaN for goals without, None for none.
        note: Why a planned trajectory is not shown; empty if all is well.
    """

    times: Array
    names: tuple[str, ...]
    goals: Mapping[str, Array]
    turns: Mapping[str, Array | None]
    note: str = ""

    @classmethod
    def of(cls, scene: Scene | BodyScene) -> "Path":
        """Return the path of a scene: its trajectory if there is one and scipy, else its goals.

        Raises:
            SceneError: It has a trajectory that cannot be planned, and no goals.
        """
        if isinstance(scene, BodyScene):
            turns = {part.name: part.scene.goal_turns for part in scene.parts}
            step = scene.frame_time or APART
            times = _steady(len(scene.frame_names), step)
            return cls(times, scene.frame_names, scene.goals, turns)
        note = ""
        if scene.trajectory is not None:
            try:
                return cls._planned(scene)
            except LimbikError as error:
                note = str(error)
        require_goals(scene)
        step = 1.0 / RATE if scene.follow else APART
        if scene.judge is not None:
            step = 1.0 / scene.judge.rate
        elif scene.body is not None and scene.body.frame_time:
            step = scene.body.frame_time
        goals, turns = {scene.name: scene.goals}, {scene.name: scene.goal_turns}
        return cls(_steady(len(scene.goals), step), scene.goal_names, goals, turns, note)

    @classmethod
    def _planned(cls, scene: Scene) -> "Path":
        from limbik.plugins.paths.scene_program import scene_trajectory

        assert scene.trajectory is not None
        samples = scene_trajectory(scene).sample(scene.trajectory.dt)
        names = tuple("on the trajectory" for _ in samples.times)
        turns = matrix_to_hpb(samples.rotations)
        return cls(samples.times, names, {scene.name: samples.positions}, {scene.name: turns})

    def __len__(self) -> int:
        return len(self.times)

    @property
    def duration(self) -> float:
        """Time from the first goal to the last [s]."""
        return float(self.times[-1])

    def frame(self, time: float) -> int:
        """Return the last goal at or before a time [s]."""
        return max(int(np.searchsorted(self.times, time + 1e-9, side="right")) - 1, 0)


def _steady(count: int, step: float) -> Array:
    return np.asarray(np.arange(count) * step, np.float64)
