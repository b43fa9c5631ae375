"""How straight the way from IK to FK is."""

import numpy as np

from limbik.plugins.judging.run import NotJudged, Run

SHARES = np.linspace(0.0, 1.0, 21)


def mix_detour(run: Run) -> float:
    """Way of the end from IK to FK pose over their distance, at the path's middle goal [-]."""
    goal = run.goals[len(run.goals) // 2]
    own, ends = run.own_solver("mix of IK and FK"), []
    for share in SHARES.tolist():
        solver = own.altered(fk_mix=share)
        ends.append(solver.solve(goal, fk_offsets=run.fk_offsets).positions[-1])
    places = np.array(ends)
    apart = float(np.linalg.norm(places[-1] - places[0]))
    if apart < 0.01 * run.reach:
        raise NotJudged("the IK pose and the FK pose end in one place")
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum() / apart)
