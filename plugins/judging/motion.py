"""How fast and how evenly the joints turn."""

import numpy as np

from limbik.core.motion import joint_steps, popping
from limbik.core.rotation import Array
from limbik.plugins.judging.run import NotJudged, Run

SLOWEST = 0.2  # goals that move slower are not asked for a gain [lengths/s]
BENT = 0.05  # a limb is bent where its middle is this far off the line [lengths]


def joint_turns(run: Run) -> Array:
    """Turn of every joint before the end from goal to goal [rad], (m-1, n-1)."""
    if len(run.goals) < 3:
        raise NotJudged("a path of at least three goals is needed")
    return joint_steps(run.solution.angles)


def gains(run: Run) -> Array:
    """Largest turn of a joint over the way of the goal [rad/length], where the goal moves."""
    way = np.linalg.norm(np.diff(run.goals, axis=0), axis=1) / run.reach
    moving = way * run.rate > SLOWEST
    if not moving.any():
        raise NotJudged(f"the goal moves less than {SLOWEST} lengths a second")
    return np.asarray(joint_turns(run).max(axis=1)[moving] / way[moving])


def accelerations(run: Run) -> Array:
    """Change of every joint's angular speed [rad/s²], (m-2, n-1)."""
    return np.abs(np.diff(joint_turns(run), axis=0)) * run.rate**2


def pops(run: Run) -> float:
    """Steps that stand out from those around them."""
    return float(popping(joint_turns(run)).sum())


def plane_speeds(run: Run) -> Array:
    """Speed at which the plane of a bent limb turns about root→end [rad/s]."""
    root = run.settings.bend_reference - 1
    places = run.solution.positions[:, root:]
    line = places[:, -1] - places[:, 0]
    line = line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-12)
    off = places[:, 1:-1] - places[:, :1]
    if off.shape[1] == 0:
        raise NotJudged("a single bone has no bend plane")
    off = off - (off * line[:, None]).sum(-1, keepdims=True) * line[:, None]
    farthest = np.linalg.norm(off, axis=2).argmax(axis=1)
    side = off[np.arange(len(off)), farthest]
    size = np.linalg.norm(side, axis=1)
    bent = (size > BENT * run.reach)[:-1] & (size > BENT * run.reach)[1:]
    if not bent.any():
        raise NotJudged("the limb is never bent")
    side = side / np.maximum(size, 1e-12)[:, None]
    sine = np.linalg.norm(np.cross(side[:-1], side[1:]), axis=1)
    turn = np.arctan2(sine, (side[:-1] * side[1:]).sum(1))
    return np.asarray(turn[bent] * run.rate)
