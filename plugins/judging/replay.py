"""What solving the path again shows: true jumps, dependence on the past, drift."""

import numpy as np
from numpy.typing import NDArray

from limbik.core.rotation import Array
from limbik.plugins.judging.motion import joint_turns
from limbik.plugins.judging.run import NotJudged, Run, pose_difference

JUMP = np.radians(5.0)  # a turn between two goals that is worth a closer look [rad]
HALVINGS = 20
AGAIN = 1000  # solves of one goal


def flips(run: Run) -> float:
    """Jumps that stay above 5° however near the two goals are brought together."""
    if run.follow:
        raise NotJudged("a path solved by continuity has no jump between two goals alone")
    if run.turns is not None:
        raise NotJudged("goals that are turned have no others between them")
    found = 0
    for step in np.flatnonzero(joint_turns(run).max(axis=1) > JUMP):
        near, far = run.goals[step], run.goals[step + 1]
        poses = run.solution.angles[step : step + 2]
        for _ in range(HALVINGS):
            middle = 0.5 * (near + far)
            pose = run.solve(middle[None], None).angles[0]
            first = pose_difference(poses[0], pose)
            second = pose_difference(pose, poses[1])
            if first > second:
                far, poses = middle, np.stack([poses[0], pose])
            else:
                near, poses = middle, np.stack([pose, poses[1]])
            if max(first, second) < JUMP:
                break
        else:
            found += 1
    return float(found)


def history(run: Run) -> float:
    """Largest difference of a goal's pose when the path is solved in another order [rad]."""
    orders = [np.arange(len(run.goals))[::-1], np.random.default_rng(0).permutation(len(run.goals))]
    worst = 0.0
    for order in orders:
        again = _solved_again(run, order)
        worst = max(worst, pose_difference(again, run.solution.angles[order]))
    return worst


def drift(run: Run) -> float:
    """Turn of the first goal's pose after the whole path and 1000 more solves of it [rad]."""
    back = np.concatenate([np.arange(len(run.goals)), np.zeros(AGAIN, int)])
    again = _solved_again(run, back)[len(run.goals) :]
    return pose_difference(again, np.broadcast_to(run.solution.angles[0], again.shape))


def _solved_again(run: Run, order: NDArray[np.int64]) -> Array:
    """Solve the goals in another order and give the angles, HPB [rad]."""
    turns = None if run.turns is None else run.turns[order]
    return run.solve(run.goals[order], turns).angles
