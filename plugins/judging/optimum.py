"""How much nearer a long search comes within the limits than the solve did."""

from typing import Any

import numpy as np

from limbik.core.posegoals import WholeSolver
from limbik.core.rotation import Array
from limbik.core.solver import Solver
from limbik.plugins.judging.run import NotJudged, Run

STARTS = ("nth-root", "solved-arc", "uniform-arc")
ROUNDS = 2000


def limit_error(run: Run) -> float:
    """Largest miss beyond the best of long solves from several starts, over the reach [-].

    No proof of an optimum: what is found is a pose within the limits that is at least so near.
    """
    if not run.is_limited:
        raise NotJudged("no joint has a limit; see excess_error")
    first = run.solver
    if isinstance(first, WholeSolver):
        if run.turns is not None and first.turns_end:
            raise NotJudged("a pose weighs its orientation against the miss")
        first = Solver(run.chain, run.settings)
    best: Array = np.full(len(run.goals), np.inf)
    for start in STARTS:
        given: dict[str, Any] = {
            "initial_bend": start,
            "max_iterations": ROUNDS,
            "smoothing": 1.0,
            "finish": "newton",
        }
        given |= {"tolerance": min(run.settings.tolerance, 1e-6 * run.reach)}
        solver = first.altered(**given)
        found = solver.solve_many(run.goals, fk_offsets=run.fk_offsets)
        best = np.minimum(best, np.asarray(found.distance))
    miss = np.asarray(run.solution.distance) - best
    return max(0.0, float(miss.max()) / run.reach)
