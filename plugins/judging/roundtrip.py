"""Whether IK and FK take over from each other without a jump."""

import numpy as np

from limbik.core.errors import InputError
from limbik.core.match import Match, match_fk, match_ik
from limbik.core.rotation import Array
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.plugins.judging.run import NotJudged, Run, pose_difference

MIXES = (0.0, 0.5, 1.0, 0.5, 0.0)
MOST = 50  # goals looked at


def round_trip(run: Run) -> float:
    """Largest turn of a joint on the way IK, FK, IK, over goals spread along the path [rad].

    The pose is matched to FK, mixed from 0 to 1 and back, and matched to IK again; goal and bend
    vector of that IK are found from the pose alone.
    """
    if isinstance(run.solver, Solver2D):
        raise NotJudged("the pole of the 2D solver is not matched")
    solver = run.own_solver("mix of IK and FK")
    rows = np.unique(np.linspace(0, len(run.goals) - 1, MOST).round().astype(int))
    return max(_turn(run, solver, run.goals[row], run.solution.angles[row]) for row in rows)


def _turn(run: Run, first: Solver, goal: Array, pose: Array) -> float:
    found = _matched(first, pose)
    solver, offsets, worst = found.solver, match_fk(run.chain, pose), found.difference
    for mix in MIXES:
        mixed = solver.altered(fk_mix=mix, fk_strength=0.0)
        angles = mixed.solve(goal, fk_offsets=offsets).angles
        worst = max(worst, pose_difference(angles, pose))
    back = _matched(first, angles)
    return max(worst, back.difference, pose_difference(back.solution.angles, pose))


def _matched(solver: Solver, pose: Array) -> Match:
    try:
        return match_ik(solver, pose)
    except InputError as why:
        raise NotJudged(f"IK is not matched to this pose: {why}") from None
