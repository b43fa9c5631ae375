"""How a motion rests on its limits."""

import numpy as np

from limbik.core.jointlimits import margin_of
from limbik.core.rotation import Array, wrap
from limbik.core.solution2d import PlanarSolution
from limbik.plugins.judging.motion import joint_turns
from limbik.plugins.judging.run import NotJudged, Run

STILL = np.radians(0.02)  # smaller turns are rest [rad]


def _ranged(run: Run) -> tuple[Array, Array, Array]:
    """Angles that have ranges, and their lower and upper ends; of planar joints in 2D [rad]."""
    if isinstance(run.solution, PlanarSolution):
        low, high = run.solution.planar_limits
        return run.solution.planar_angles, low, high
    return run.solution.angles, run.chain.low, run.chain.high


def limit_excess(run: Run) -> float:
    """Largest angle beyond a range, or beyond a joint's limit of its own [rad]."""
    angles, low, high = _ranged(run)
    over = float(np.maximum(low - angles, angles - high).max())
    for joint, limit in enumerate(run.solution.limits or ()):
        if limit is not None:
            mirrored = run.chain.joints[joint].mirrored
            margins = [margin_of(limit, mirrored, pose) for pose in angles[:, joint]]
            over = max(over, -min(margins))
    return max(0.0, over)


def chatter(run: Run) -> float:
    """Most reversals of a joint's axis a second, both motions above 0.02°, of limited axes."""
    joint_turns(run)
    angles, low, high = _ranged(run)
    steps = wrap(np.diff(angles, axis=0))
    limited = np.isfinite(high) & (high > low)
    if not limited.any():
        raise NotJudged("no joint has a range")
    turned = (steps[1:] * steps[:-1] < 0.0) & (np.abs(steps[1:]) > STILL)
    turned &= np.abs(steps[:-1]) > STILL
    seconds = len(run.goals) / run.rate
    return float((turned & limited).sum(axis=0).max() / seconds)
