"""Speed profiles: how far along a path at each time (003, "台形の速度プロファイル").

A profile is a row of phases of constant jerk: speed up, cruise, slow down, and with a jerk limit
the rounded ends of these. Phases carry the name of what limits them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from limbik.core.rotation import Array


class Phase(NamedTuple):
    """A stretch of constant jerk.

    Attributes:
        duration: [s].
        speed: At its start [length/s].
        acceleration: At its start [length/s²].
        jerk: [length/s³].
        limit: What keeps it from being faster.
    """

    duration: float
    speed: float
    acceleration: float
    jerk: float
    limit: str

    @property
    def distance(self) -> float:
        """How far it goes [length]."""
        t = self.duration
        return t * (self.speed + t * (self.acceleration / 2.0 + t * self.jerk / 6.0))

    @property
    def last_speed(self) -> float:
        """Speed at its end [length/s]."""
        return self.speed + self.duration * (self.acceleration + self.duration * self.jerk / 2.0)

    def cut(self, start: float, end: float) -> "Phase":
        """Return the part between two times from its start [s]."""
        speed = self.speed + start * (self.acceleration + start * self.jerk / 2.0)
        acceleration = self.acceleration + start * self.jerk
        return Phase(end - start, speed, acceleration, self.jerk, self.limit)


@dataclass(frozen=True, eq=False)
class Profile:
    """Distance by time.

    Attributes:
        phases: In order.
        times: Bounds of the phases, (k + 1,) [s].
        places: Distances at the bounds, (k + 1,) [length].
    """

    phases: tuple[Phase, ...]
    times: Array
    places: Array

    @classmethod
    def of(cls, phases: Sequence[Phase], distance: float | None = None) -> "Profile":
        """Make a profile of phases; empty ones are left out.

        Args:
            phases: In order.
            distance: The exact whole, which rounding would miss; None for the phases' sum.
        """
        kept = tuple(phase for phase in phases if phase.duration > 0.0)
        times = np.concatenate([[0.0], np.cumsum([phase.duration for phase in kept])])
        places = np.concatenate([[0.0], np.cumsum([phase.distance for phase in kept])])
        if distance is not None and kept:
            places[-1] = distance
        return cls(kept, times, places)

    @property
    def duration(self) -> float:
        """Time of the whole [s]."""
        return float(self.times[-1])

    @property
    def distance(self) -> float:
        """Length of the whole [length]."""
        return float(self.places[-1])

    @property
    def peak(self) -> float:
        """Highest speed [length/s]."""
        return max((max(p.speed, p.last_speed) for p in self.phases), default=0.0)

    def at(self, t: Array) -> tuple[Array, Array, Array]:
        """Return distances, speeds and accelerations at times, (m,) each; the ends hold outside."""
        if not self.phases:
            return np.zeros(len(t)), np.zeros(len(t)), np.zeros(len(t))
        inside = np.clip(t, 0.0, self.times[-1])
        k = np.searchsorted(self.times[1:-1], inside, side="right")
        v, a, j = np.array([phase[1:4] for phase in self.phases]).T[:, k]
        dt = inside - self.times[k]
        x = self.places[k] + dt * (v + dt * (a / 2.0 + dt * j / 6.0))
        return np.clip(x, 0.0, self.places[-1]), v + dt * (a + dt * j / 2.0), a + dt * j

    def time_at(self, place: float) -> float:
        """Return when a distance is reached [s]."""
        if not self.phases or place <= 0.0:
            return 0.0
        if place >= self.places[-1]:
            return self.duration
        k = int(np.searchsorted(self.places[1:-1], place, side="right"))
        return float(self.times[k]) + _time_within(self.phases[k], place - float(self.places[k]))

    def part(self, start: float, end: float) -> list[Phase]:
        """Return the phases between two distances [length]."""
        t0, t1 = self.time_at(start), self.time_at(end)
        cuts = []
        for phase, begin in zip(self.phases, self.times[:-1].tolist(), strict=True):
            low, high = max(t0 - begin, 0.0), min(t1 - begin, phase.duration)
            if high > low:
                cuts.append(phase.cut(low, high))
        return cuts

    def speed_at(self, place: float) -> float:
        """Return the speed at a distance [length/s]."""
        if not self.phases:
            return 0.0
        t = self.time_at(place)
        k = int(np.searchsorted(self.times[1:-1], t, side="right"))
        return self.phases[k]._replace(duration=t - float(self.times[k])).last_speed


def _time_within(phase: Phase, distance: float) -> float:
    """Solve a phase for the time of a distance [s]."""
    v, a = phase.speed, phase.acceleration
    if phase.jerk == 0.0:
        root = max(v * v + 2.0 * a * distance, 0.0) ** 0.5
        return min(2.0 * distance / (v + root), phase.duration) if v + root > 0.0 else 0.0
    low, high = 0.0, phase.duration
    for _ in range(80):
        middle = 0.5 * (low + high)
        reached = phase._replace(duration=middle).distance
        low, high = (middle, high) if reached < distance else (low, middle)
    return 0.5 * (low + high)
