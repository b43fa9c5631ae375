"""Cut an experiment into batches: what is solved at once and becomes one part of a table.

The cut depends on the experiment alone, not on the engine, so that a run can go on with another.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from limbik.plugins.experiments.trials import Trial

SOLVES: Final = "solves"
PATHS: Final = "paths"
MOST_JOINTS = 120_000  # joints posed in a batch: about a second
LARGEST = 1_000_000  # what a batch may be told to have
LEAST_JOINTS = 4_000  # fewer are not worth a file
PARTS = 32  # a smaller experiment is cut into about so many, for several workers


@dataclass(frozen=True)
class Piece:
    """Some goals of one trial.

    Attributes:
        trial: Number of the trial.
        start: First goal.
        stop: First goal behind it.
    """

    trial: int
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start


@dataclass(frozen=True)
class Batch:
    """What one part of a table is made of.

    Attributes:
        table: `solves`, a row a solve, or `paths`, a row a goal set with its metrics.
        number: From 0 within the table.
        pieces: The goals.
    """

    table: str
    number: int
    pieces: tuple[Piece, ...]

    @property
    def name(self) -> str:
        """The part's file without folder and ending."""
        return f"part-{self.number:06d}"

    @property
    def solves(self) -> int:
        """How many goals."""
        return sum(map(len, self.pieces))

    @property
    def rows(self) -> int:
        """How many rows the part has."""
        return self.solves if self.table == SOLVES else len(self.pieces)


def plan(trials: Sequence[Trial], goals: int | None, measured: bool) -> list[Batch]:
    """Cut trials into batches.

    Args:
        trials: The trials.
        goals: Most goals of a batch; None for as many as take about half a second.
        measured: Whether metrics are measured, a batch for each trial's whole goal set.
    """
    total = sum(trial.posed for trial in trials)
    most = min(max(total // PARTS, LEAST_JOINTS), MOST_JOINTS)
    batches: list[Batch] = []
    held: list[Piece] = []
    room = 1.0  # share of a batch that is left

    def close() -> None:
        nonlocal room
        if held:
            batches.append(Batch(SOLVES, len(batches), tuple(held)))
            held.clear()
        room = 1.0

    for trial in trials:
        joints = len(trial.scene.chain)
        size = max(most // joints if goals is None else min(goals, LARGEST // joints), 1)
        start = 0
        while start < trial.count:
            fit = trial.count if trial.goal_set.is_path else start + max(round(room * size), 1)
            stop = min(fit, trial.count)
            held.append(Piece(trial.number, start, stop))
            room -= (stop - start) / size
            start = stop
            if room * size < 0.5:
                close()
    close()
    paths = [
        Batch(PATHS, number, (Piece(trial.number, 0, trial.count),))
        for number, trial in enumerate(trials if measured else ())
    ]
    return batches + paths
