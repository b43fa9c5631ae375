"""How long one solve takes from Python."""

from time import perf_counter

import numpy as np

from limbik.plugins.judging.run import Run

MOST = 500  # solves


def latency(run: Run) -> float:
    """95th percentile of a single solve's time [s]; depends on the machine."""
    times = []
    for row, goal in enumerate(run.goals[:MOST]):
        asked = {} if run.turns is None else {"goal_turn": run.turns[row]}
        start = perf_counter()
        run.solver.solve(goal, fk_offsets=run.fk_offsets, **asked)
        times.append(perf_counter() - start)
    return float(np.percentile(times, 95))
