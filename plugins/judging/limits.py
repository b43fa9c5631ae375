"""How a motion rests on its limits."""

import numpy as np

from limbik.core.rotation import wrap
from limbik.plugins.judging.motion import joint_turns
from limbik.plugins.judging.run import NotJudged, Run

STILL = np.radians(0.02)  # smaller turns are rest [rad]


def limit_excess(run: Run) -> float:
    """Largest angle beyond a range [rad]."""
    angles = run.solution.angles
    over = np.maximum(run.chain.low - angles, angles - run.chain.high)
    return max(0.0, float(over.max()))


def chatter(run: Run) -> float:
    """Most reversals of a joint's axis a second, both motions above 0.02°, of limited axes."""
    joint_turns(run)
    if not run.is_limited:
        raise NotJudged("no joint has a limit")
    steps = wrap(np.diff(run.solution.angles, axis=0))
    limited = np.isfinite(run.chain.high) & (run.chain.high > run.chain.low)
    turned = (steps[1:] * steps[:-1] < 0.0) & (np.abs(steps[1:]) > STILL)
    turned &= np.abs(steps[:-1]) > STILL
    seconds = len(run.goals) / run.rate
    return float((turned & limited).sum(axis=0).max() / seconds)
