"""Solve one batch and return it as a part of a table; runs in any process, on any machine."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from limbik.core.errors import PluginError
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.solution import Solution
from limbik.core.solving import solve_goals
from limbik.plugins.experiments.goalsets import Goals
from limbik.plugins.experiments.measure import measured, path_columns
from limbik.plugins.experiments.plan import SOLVES, Batch, Piece
from limbik.plugins.experiments.table import FAILED, Table, encode
from limbik.plugins.experiments.trials import Trial

Found = TypeVar("Found")

registry = cache(Registry)
"""The registry of this process."""


@dataclass(frozen=True)
class Job:
    """A batch with all it takes to solve it.

    Attributes:
        batch: What is solved.
        trials: The trials of its pieces.
        goals: The goals of its pieces.
        metrics: Names of what is measured.
        labels: For the columns that name the trials, see `encode`.
        stamp: What the part says about itself.
        form: `parquet` or `npz`.
    """

    batch: Batch
    trials: Sequence[Trial]
    goals: Sequence[Goals]
    metrics: Sequence[str]
    labels: Mapping[str, Sequence[Any]]
    stamp: Mapping[str, Any]
    form: str


@dataclass(frozen=True)
class Part:
    """A solved batch.

    Attributes:
        batch: What was solved.
        content: Bytes of the file.
        failed: How many solves failed.
    """

    batch: Batch
    content: bytes
    failed: int


def run_batch(job: Job) -> Part:
    """Solve a batch; a solve that fails becomes a row, it never ends the batch."""
    tables = []
    for piece, trial, goals in zip(job.batch.pieces, job.trials, job.goals, strict=True):
        rows = goals.positions(trial.scene.chain)
        tables.append(
            solve_rows(trial, piece, rows)
            if job.batch.table == SOLVES
            else _path_row(trial, rows, job.metrics)
        )
    table = {name: np.concatenate([t[name] for t in tables]) for name in tables[0]}
    failed = int((table["status"] == FAILED).sum()) if "status" in table else 0
    return Part(job.batch, encode(table, job.labels, job.stamp, job.form), failed)


def solve_rows(trial: Trial, piece: Piece, goals: Array) -> Table:
    """Solve goals, (m, 3) [length], of one trial: a row each."""
    count = len(goals)
    (status, iterations, distance), us = _timed(_numbers, trial, goals)
    return {
        "trial": np.full(count, trial.number, np.int32),
        "goal": np.arange(piece.start, piece.stop, dtype=np.int64),
        "x": goals[:, 0].copy(),
        "y": goals[:, 1].copy(),
        "z": goals[:, 2].copy(),
        "status": status,
        "iterations": iterations,
        "distance": distance,
        "us": np.full(count, us),
    }


def _path_row(trial: Trial, goals: Array, metrics: Sequence[str]) -> Table:
    """Solve all goals of a trial and measure them: one row."""
    solution, us = _timed(_solved, trial, goals)
    scene = trial.ready(goals, registry())
    row = path_columns(scene, solution) | {"us": us}
    row |= measured(trial, scene, solution, metrics, registry())
    table: Table = {"trial": np.array([trial.number], np.int32)}
    return table | {name: np.array([value], np.float64) for name, value in row.items()}


def _timed(solve: Callable[[Scene], Found], trial: Trial, goals: Array) -> tuple[Found, float]:
    """Return what goals are solved to, and the time of each [µs]."""
    solve(trial.ready(goals[:1], registry()))  # what happens only once is not part of the time
    started = perf_counter()
    found = solve(trial.ready(goals, registry()))
    return found, 1e6 * (perf_counter() - started) / len(goals)


def _solved(scene: Scene) -> Solution | None:
    """Solve goals at once; None if a strategy fails at one of them."""
    try:
        return solve_goals(scene, registry(), threads=1)
    except PluginError:
        return None


def _numbers(scene: Scene) -> tuple[Array, Array, Array]:
    """Return status, rounds and distance of every goal, (m,) each.

    Goals a strategy fails at are found by halving. A path has no pose behind a failure.
    """
    found = _solved(scene)
    if found is not None:
        return (
            np.asarray(found.status, np.int8),
            np.asarray(found.iterations, np.int32),
            np.asarray(found.distance, np.float64),
        )
    count = len(scene.goals)
    if count == 1 or scene.follow:
        return (
            np.full(count, FAILED, np.int8),
            np.zeros(count, np.int32),
            np.full(count, np.nan),
        )
    halves = (scene.goals[: count // 2], scene.goals[count // 2 :])
    first, second = (_numbers(replace(scene, goals=half)) for half in halves)
    status, iterations, distance = (
        np.concatenate(pair) for pair in zip(first, second, strict=True)
    )
    return status, iterations, distance
