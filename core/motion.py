"""What a solved path is like: its largest step, its pops, how much of it was reached (M-12)."""

from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.solution import Solution, Status

POP_LEAST: Final = 2.0  # [deg]; nobody sees a smaller one
POP_RATIO: Final = 4.0
POP_WINDOW: Final = 9  # frames a step is compared with


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
        pops: Indices of the frames a joint jumps to: it turns by more than 2° and more than four
            times the median of the nine steps around.
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
    steps = joint_steps(solution.chain.frozen @ hpb_to_matrix(solution.angles))
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
        _pops(np.degrees(steps)),
    )


def joint_steps(turns: Array) -> Array:
    """Return how far each joint turns from frame to frame.

    Args:
        turns: Rotations, (m, n, 3, 3).

    Returns:
        Angles [rad], (m - 1, n).
    """
    change = np.swapaxes(turns[:-1], -1, -2) @ turns[1:]
    across = np.stack([change[..., i, j] - change[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    trace = change[..., 0, 0] + change[..., 1, 1] + change[..., 2, 2]
    return np.asarray(np.arctan2(np.linalg.norm(across, axis=0), trace - 1.0))


def _pops(steps: Array) -> tuple[int, ...]:
    if len(steps) < 2:
        return ()
    half = POP_WINDOW // 2
    padded = np.pad(steps, ((half, half), (0, 0)), mode="reflect" if len(steps) > half else "edge")
    usual = np.median(sliding_window_view(padded, POP_WINDOW, axis=0), axis=-1)
    jumps = (steps > POP_LEAST) & (steps > POP_RATIO * usual)
    return tuple((np.flatnonzero(jumps.any(axis=1)) + 1).tolist())
