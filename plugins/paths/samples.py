"""`Samples`: a trajectory at given times, as arrays."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array, quaternion_to_matrix
from limbik.plugins.paths.quaternions import half_angle, short_way

MOST_SAMPLES = 10_000_000


@dataclass(frozen=True, eq=False)
class Samples:
    """Poses along a trajectory.

    Attributes:
        times: (m,) [s].
        positions: (m, 3) [length].
        quaternions: Unit, (w, x, y, z), without sign jumps, (m, 4).
        velocities: (m, 3) [length/s].
        path: Length in the present piece, speed and acceleration along it, (m, 3); in overlaps
            the speed of the sum, and no acceleration (NaN).
        move: Number of the first move of the piece, (m,).
    """

    times: Array
    positions: Array
    quaternions: Array
    velocities: Array
    path: Array
    move: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.times)

    @property
    def rotations(self) -> Array:
        """Orientations as matrices, (m, 3, 3)."""
        return quaternion_to_matrix(self.quaternions)

    @property
    def speeds(self) -> Array:
        """Speeds of the position, (m,) [length/s]."""
        return np.asarray(np.linalg.norm(self.velocities, axis=1))

    def accelerations(self) -> Array:
        """Return accelerations by differences of the velocity, (m, 3) [length/s²]."""
        if len(self) < 2:
            return np.zeros_like(self.velocities)
        gaps = np.maximum(np.diff(self.times), 1e-300)
        steps = np.diff(self.velocities, axis=0) / gaps[:, None]
        steps[np.diff(self.times) <= 0.0] = 0.0
        return np.concatenate([steps[:1], 0.5 * (steps[1:] + steps[:-1]), steps[-1:]])

    def rotation_speeds(self) -> Array:
        """Return rotation rates between samples, (m,) [rad/s]; the first is the second's."""
        if len(self) < 2:
            return np.zeros(len(self))
        q = self.quaternions
        gaps = np.maximum(np.diff(self.times), 1e-300)
        rates = 2.0 * half_angle(q[:-1], short_way(q[:-1], q[1:])) / gaps
        return np.concatenate([rates[:1], rates])

    def retimed(self, times: Array) -> "Samples":
        """Return the same poses at other times; speeds follow."""
        slower = self.times[-1] / times[-1] if times[-1] > 0.0 else 1.0
        return replace(
            self,
            times=times,
            velocities=self.velocities * slower,
            path=self.path * (1.0, slower, slower**2),
        )


def sample_times(duration: float, dt: float, stretch: bool) -> tuple[Array, Array]:
    """Return when a trajectory is asked and when its samples are played, (m,) each [s].

    Raises:
        InputError: dt is not above 0, or gives too many samples.
    """
    if not dt > 0.0 or duration / dt > MOST_SAMPLES:
        message = (
            f"the time between samples must be at least {duration / MOST_SAMPLES:.3g} s, not {dt:g}"
        )
        raise InputError(Fault("samples", message, key="dt"))
    steps = duration / dt
    near = abs(steps - round(steps)) <= 1e-9 * max(steps, 1.0)
    count = round(steps) if near else int(steps)
    if stretch and not near:
        count += 1
    if stretch:
        return np.linspace(0.0, duration, count + 1), np.arange(count + 1.0) * dt
    times: Array = np.arange(count + 1.0) * dt
    if near:
        times[-1] = duration
        return times, times
    times = np.append(times, duration)
    return times, times
