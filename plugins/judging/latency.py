"""How long one solve takes from Python."""

from time import perf_counter

import numpy as np

from limbik.plugins.judging.run import Run

MOST = 500  # solves


def latency(run: Run) -> float:
    """95th percentile of a single solve's time [s]; depends on the machine."""
    times = []
    for goal in run.goals[:MOST]:
        start = perf_counter()
        run.solver.solve(goal, fk_offsets=run.fk_offsets)
        times.append(perf_counter() - start)
    return float(np.percentile(times, 95))
