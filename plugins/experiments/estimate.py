"""What an experiment will take, before it is run: time and bytes."""

from dataclasses import dataclass

import numpy as np

from limbik.plugins.experiments.batch import solve_rows
from limbik.plugins.experiments.plan import SOLVES, Piece
from limbik.plugins.experiments.run import Run

TIMED = 200  # solves that are timed
MOST_TRIALS = 8  # trials they are taken from
ROW = 36.0  # bytes of a row: position and distance are random numbers, the rest packs to little


@dataclass(frozen=True)
class Estimate:
    """What is to be expected.

    Attributes:
        seconds: Processor time of the solves alone, on one core.
        size: Bytes of the parts.
    """

    seconds: float
    size: float


def estimate(prepared: Run) -> Estimate:
    """Time some solves and count rows; metrics are not in the time."""
    trials = prepared.experiment.trials
    chosen = np.unique(np.linspace(0, len(trials) - 1, MOST_TRIALS).astype(int)).tolist()
    each = TIMED // len(chosen)
    costs = []
    for trial in (trials[number] for number in chosen):
        count = min(each, trial.count)
        goals = trial.goal_set.goals.part(0, count).positions(trial.scene.chain)
        table = solve_rows(trial, Piece(trial.number, 0, count), goals)
        costs.append(float(table["us"][0]) / len(trial.scene.chain))
    posed = sum(trial.posed for trial in trials)
    rows = sum(batch.rows for batch in prepared.batches if batch.table == SOLVES)
    return Estimate(1e-6 * float(np.mean(costs)) * posed, ROW * rows)
