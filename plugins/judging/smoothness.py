"""How smooth a joint's motion is as a whole: log dimensionless jerk."""

import numpy as np

from limbik.core.rotation import Array
from limbik.plugins.judging.run import NotJudged, Run


def log_jerk(speed: Array, rate: float) -> float:
    """Return -ln(T³ / v² x integral of (d²v/dt²)²), v the peak speed; nearer to 0 is smoother.

    Args:
        speed: (m,) at a steady rate.
        rate: [1/s].
    """
    peak = float(np.abs(speed).max())
    if len(speed) < 4 or peak == 0.0:
        raise NotJudged("nothing moves")
    bend = np.diff(speed, 2) * rate**2
    length = len(speed) / rate
    jerk = length**3 / peak**2 * float((bend**2).sum()) / rate
    return -float(np.log(jerk)) if jerk > 0.0 else 0.0


def roughness(run: Run) -> float:
    """By how much the middle joint moves less smoothly than the goal, in log jerk [-]."""
    middle = (run.settings.bend_reference - 1 + len(run.chain)) // 2

    def speed(places: Array) -> Array:
        return np.asarray(np.linalg.norm(np.diff(places, axis=0), axis=1) * run.rate)

    goal = log_jerk(speed(run.goals), run.rate)
    joint = log_jerk(speed(run.solution.positions[:, middle]), run.rate)
    return max(0.0, goal - joint)
