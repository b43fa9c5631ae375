"""What a solved path is like: its largest step, its pops, how much of it was reached (M-12).

Bakes tell it and `limbik judge` measures by it.
"""

from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.solution import Solution, Status

POP_LEAST: Final = np.radians(3.0)  # [rad]; nobody sees a smaller one
POP_RATIO: Final = 4.0
POP_AROUND: Final = 4  # frames on either side that a step is compared with


@dataclass(frozen=True)
class MotionMetrics:
    """How good a motion is.

    Attributes:
        frames: Number of goals.
        reached: How many of them were reached.
        worst_distance: Largest distance of the end from its goal [length].
        max_step: Largest turn of a joint between two frames [deg].
        max_step_joint: That joint; empty for a single frame.
        max_step_frame: Index of the frame it turns to; 0 for a single frame.
        pops: Indices of the frames a joint jumps to, see `popping`.
    """

    frames: int
    reached: int
    worst_distance: float
    max_step: float
    max_step_joint: str
    max_step_frame: int
    pops: tuple[int, ...]

    def record(self) -> dict[str, Any]:
        """Return the metrics as plain values."""
        return {**asdict(self), "pops": list(self.pops)}


def motion_metrics(solution: Solution) -> MotionMetrics:
    """Measure a solved path.

    Args:
        solution: With a leading goal axis.
    """
    status = np.asarray(solution.status)
    steps = joint_steps(solution.angles)
    largest, joint, frame = 0.0, "", 0
    if steps.size:
        row, column = np.unravel_index(steps.argmax(), steps.shape)
        largest, joint = float(steps[row, column]), solution.chain.names[int(column)]
        frame = int(row) + 1
    return MotionMetrics(
        len(status),
        int((status == Status.REACHED).sum()),
        float(np.asarray(solution.distance).max()),
        float(np.degrees(largest)),
        joint,
        frame,
        tuple((np.flatnonzero(popping(steps).any(axis=1)) + 1).tolist()),
    )


def turn_between(first: Array, second: Array) -> Array:
    """Return the angles between rotations [rad].

    Args:
        first: (..., 3, 3).
        second: (..., 3, 3).
    """
    # |A - B|² = 8 sin²(angle / 2): exact for small angles, where the trace is not.
    apart = np.linalg.norm(first - second, axis=(-2, -1)) / np.sqrt(8.0)
    return np.asarray(2.0 * np.arcsin(np.clip(apart, 0.0, 1.0)))


def joint_steps(angles: Array) -> Array:
    """Return how far each joint before the end turns from frame to frame.

    Args:
        angles: HPB, (m, n, 3) [rad].

    Returns:
        Angles [rad], (m - 1, n - 1).
    """
    turns = hpb_to_matrix(angles[:, :-1])
    return turn_between(turns[:-1], turns[1:])


def popping(steps: Array) -> NDArray[np.bool_]:
    """Tell which steps stand out: above 3°, and four times the median of the nine around them.

    Args:
        steps: As `joint_steps` gives them, (k, n) [rad].
    """
    if not len(steps):
        return np.zeros(steps.shape, bool)
    padded = np.pad(steps, ((POP_AROUND, POP_AROUND), (0, 0)), constant_values=np.nan)
    usual = np.nanmedian(sliding_window_view(padded, 2 * POP_AROUND + 1, axis=0), axis=-1)
    return np.asarray((steps > POP_LEAST) & (steps > POP_RATIO * usual))
