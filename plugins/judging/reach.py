"""How near the end comes to its goals, and whether the status says so."""

import numpy as np

from limbik.core.motion import turn_between
from limbik.core.pose import forward_kinematics
from limbik.core.posegoals import WholeSolver
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.solution import Status
from limbik.plugins.judging.run import NotJudged, Run

NEARLY = 0.999  # share of the reach up to which a goal counts as reachable


def reach_errors(run: Run) -> Array:
    """Misses of the goals a chain without limits can reach, over the reach [-].

    With a soft zone the goals up to its start count. Limits are left out of account: they can make
    the judgement too hard, never too mild.
    """
    most = min(NEARLY, 1.0 - run.settings.soft_zone) * run.reach
    able = (run.from_root >= run.hole) & (run.from_root <= most)
    if not able.any():
        raise NotJudged("no goal is within reach")
    return np.asarray(np.asarray(run.solution.distance)[able] / run.reach)


def excess_errors(run: Run) -> Array:
    """Misses beyond what distance makes unavoidable, over the reach [-]; all goals count.

    Limits are left out of account, as in `reach_errors`; `limit_error` knows them.
    """
    beyond = np.maximum(run.from_root - run.reach, run.hole - run.from_root)
    miss = np.asarray(run.solution.distance) - np.maximum(beyond, 0.0)
    return np.asarray(np.maximum(miss, 0.0) / run.reach)


def false_statuses(run: Run) -> float:
    """Goals whose status contradicts the pose: run through forward kinematics, compared anew."""
    positions, rotations = forward_kinematics(run.chain, run.solution.angles)
    is_met = np.linalg.norm(positions[:, -1] - run.goals, axis=1) < run.settings.tolerance
    angle = run.solver.angle if isinstance(run.solver, WholeSolver) else None
    if run.turns is not None and angle is not None:
        left = turn_between(rotations[:, -1], hpb_to_matrix(run.turns))
        is_met &= ~(left >= angle)  # a goal without an orientation, NaN, leaves none
    says = np.asarray(run.solution.status) == Status.REACHED
    return float((says != is_met).sum())
