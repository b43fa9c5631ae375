"""Run an experiment: what is missing in its folder is solved and kept."""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from limbik.core.errors import EnvironmentProblem
from limbik.core.jit import is_compiled_before
from limbik.plugins.experiments.batch import Job, solve_rows
from limbik.plugins.experiments.engine import Done, WorkerLost, run_jobs
from limbik.plugins.experiments.folder import Folder, opened
from limbik.plugins.experiments.identity import contents, fingerprint, versions
from limbik.plugins.experiments.labels import label_columns
from limbik.plugins.experiments.model import LOCAL, SERIAL
from limbik.plugins.experiments.plan import PATHS, SOLVES, Batch, Piece, plan
from limbik.plugins.experiments.read import Experiment
from limbik.plugins.experiments.table import form_here
from limbik.plugins.experiments.trials import Trial

SMALL = 200_000  # joints to pose; less takes longer to hand out than to do
MOST_LOSSES = 3  # workers lost in a row, without a part finished


@dataclass(frozen=True)
class Run:
    """An experiment cut into batches.

    Attributes:
        experiment: The experiment.
        batches: All of them.
        manifest: What its folder says about it.
    """

    experiment: Experiment
    batches: list[Batch]
    manifest: dict[str, Any]

    @property
    def solves(self) -> int:
        """How many solves become rows."""
        return sum(batch.solves for batch in self.batches if batch.table == SOLVES)

    @property
    def engine(self) -> str:
        """The engine asked for; without one `serial` for a small experiment."""
        posed = sum(trial.posed for trial in self.experiment.trials)
        return self.experiment.model.engine or (SERIAL if posed <= SMALL else LOCAL)

    @property
    def output(self) -> Path:
        """The folder asked for."""
        return Path(self.experiment.model.output or Path("runs") / self.experiment.name)


@dataclass(frozen=True)
class Outcome:
    """What a run came to.

    Attributes:
        folder: Where its parts are.
        parts: How many there are.
        before: How many of them an earlier run had made.
        failed: Solves that failed in this run.
    """

    folder: Path
    parts: int
    before: int
    failed: int


def prepare(experiment: Experiment) -> Run:
    """Cut an experiment into batches and describe it."""
    model = experiment.model
    batches = plan(experiment.trials, model.batch, bool(model.metrics))
    content, made_with = contents(experiment), versions(experiment.distributions)
    manifest = {
        "format": 1,
        "name": experiment.name,
        "fingerprint": fingerprint(content, made_with),
        "seed": model.seed,
        "versions": made_with,
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "form": form_here(),
        "batches": {
            table: sum(batch.table == table for batch in batches) for table in (SOLVES, PATHS)
        },
        "metrics": list(model.metrics),
        "trials": [
            {
                "trial": trial.number,
                "chain": trial.chain,
                "strategy": trial.strategy,
                "goals": trial.goal_set.name,
                "repeat": trial.goal_set.repeat,
                "path": trial.goal_set.is_path,
                "steps": getattr(trial.goal_set.goals, "steps", None),
                "count": trial.count,
                "length": trial.scene.chain.length,
                "label": trial.label,
                "params": dict(trial.params),
            }
            for trial in experiment.trials
        ],
        "contents": content,
    }
    return Run(experiment, batches, manifest)


def run(prepared: Run, new: bool = False, progress: Callable[[int], None] | None = None) -> Outcome:
    """Solve what is missing.

    Args:
        prepared: The experiment.
        new: Take a new folder if the one asked for holds another experiment.
        progress: Told how many goals are solved so far, those of earlier runs among them.

    Raises:
        InputError: The folder holds another experiment.
        EnvironmentProblem: The folder cannot be written, another run is at it, workers keep dying.
    """
    with opened(prepared.output, prepared.manifest, new) as folder:
        folder.sweep_out()
        missing = folder.missing(prepared.batches)
        before = len(prepared.batches) - len(missing)
        _compile(prepared.experiment.trials if missing else ())
        done = sum(batch.solves for batch in prepared.batches)
        done -= sum(batch.solves for batch in missing)
        failed = 0
        for batch, failures in _solved(prepared, folder, missing):
            done += batch.solves
            failed += failures
            if progress is not None:
                progress(done)
    return Outcome(folder.path, len(prepared.batches), before, failed)


def _compile(trials: Sequence[Trial]) -> None:
    """Make machine code once, before several workers would each make it."""
    if is_compiled_before():
        return
    of_each_kind = {(trial.scene.pole is None, str(trial.solver)): trial for trial in trials}
    for trial in of_each_kind.values():
        goal = trial.goal_set.goals.part(0, 1).positions(trial.scene.chain)
        solve_rows(trial, Piece(trial.number, 0, 1), goal)


def _solved(prepared: Run, folder: Folder, missing: Sequence[Batch]) -> Iterator[Done]:
    """Solve batches and keep their parts; a batch whose worker was killed is solved again."""
    waiting = {(batch.table, batch.number): batch for batch in missing}
    workers = prepared.experiment.model.workers
    losses = 0
    while waiting:
        most = min(workers or os.cpu_count() or 1, len(waiting))
        jobs = _jobs(prepared, list(waiting.values()), folder.form)
        try:
            here = prepared.manifest["versions"]
            for done in run_jobs(prepared.engine, jobs, folder, most, here):
                del waiting[done.batch.table, done.batch.number]
                losses = 0
                yield done
        except WorkerLost:
            losses += 1
            if losses == MOST_LOSSES:
                message = (
                    f"{losses} times a worker was killed before it finished a part; is there too "
                    f"little memory? {len(waiting)} parts are left: run it again to go on"
                )
                raise EnvironmentProblem(message) from None


def _jobs(prepared: Run, batches: Sequence[Batch], form: str) -> Iterator[Job]:
    """Give each batch all it takes to be solved elsewhere."""
    experiment = prepared.experiment
    labels = label_columns(experiment.trials)
    stamp = {key: prepared.manifest[key] for key in ("name", "fingerprint", "seed", "versions")}
    for batch in batches:
        numbers = [piece.trial for piece in batch.pieces]
        own = {name: column[numbers[0] : numbers[-1] + 1] for name, column in labels.items()}
        trials = [experiment.trials[number] for number in numbers]
        goals = [
            trial.goal_set.goals.part(piece.start, piece.stop)
            for trial, piece in zip(trials, batch.pieces, strict=True)
        ]
        bare = [trial.without_goals() for trial in trials]
        yield Job(batch, bare, goals, experiment.model.metrics, own, stamp, form)
