"""Whether poses are poses: finite, rigid."""

import numpy as np

from limbik.plugins.judging.run import Run


def unsound_poses(run: Run) -> float:
    """Poses with a number that is not finite or a frame that is no rotation."""
    frames = run.solution.rotations
    off = np.abs(frames @ np.swapaxes(frames, -1, -2) - np.eye(3)).max(axis=(1, 2, 3))
    finite = np.isfinite(run.solution.angles).all(axis=(1, 2))
    finite &= np.isfinite(run.solution.positions).all(axis=(1, 2))
    return float((~(finite & (off < 1e-9))).sum())


def stretch(run: Run) -> float:
    """Largest change of a bone's length over the reach [-]."""
    lengths = np.linalg.norm(np.diff(run.solution.positions, axis=1), axis=2)
    return float(np.abs(lengths - run.chain.lengths).max() / run.reach)
