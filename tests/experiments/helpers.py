"""Experiments for the tests, small and with many parts, and their tables."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.plugins.experiments.folder import read_manifest
from limbik.plugins.experiments.overrides import read_override
from limbik.plugins.experiments.plan import PATHS, SOLVES
from limbik.plugins.experiments.read import Experiment, read_experiment
from limbik.plugins.experiments.run import Outcome, prepare, run
from limbik.plugins.experiments.summary import parts_of
from limbik.plugins.experiments.table import decode

SCENE = """\
limbik: 1
chain:
  base: {position: [1, 2, 3], rotation: [30, 0, 0]}
  joints:
    - {name: shoulder, heading: [-130, 60], pitch: [-85, 85], bank: [-90, 90]}
    - {name: elbow, offset: [0, 0, 30], heading: 0, pitch: [0, 145], bank: [-80, 80]}
    - {name: wrist, offset: [0, 0, 26], heading: 0, pitch: 0, bank: 0}
options: {bend_vector: {use: manual, angle: 180}, reference_axis: y-}
goals:
  - {name: near, position: [5, 10, 40]}
"""
LEG = """\
limbik: 1
chain:
  joints:
    - {name: hip}
    - {name: knee, offset: [0, 0, 40], planar: [-140, 0]}
    - {name: ankle, offset: [0, 0, 40]}
solver: 2d
pole: {position: [0, 90, 10]}
goals:
  - {position: [5, 10, 40]}
"""
EXPERIMENT = """\
experiment: 1
name: trial
seed: 7
chains: [arm.yaml]
strategies:
  - {name: nth-root, options: {initial_bend: nth-root}}
  - {name: two-bone, options: {initial_bend: two-bone}}
sweep:
  finish: [none, newton]
goals:
  - {kind: reach, count: 100}
  - {kind: path, count: 20, through: [[0.1, 0.2, 0.6], [0.3, -0.2, 0.6]]}
metrics: [reach_error, gain, unsound_poses]
batch: 40
engine: serial
output: run
"""
MANY = EXPERIMENT.replace("count: 100", "count: 4000").replace("batch: 40", "batch: 100")
"""With many parts, so that there is something to hit: 4 x 40 of solves and one, 8 of paths."""
EXACT = {
    SOLVES: ("trial", "goal", "x", "y", "z", "status", "iterations", "distance"),
    PATHS: ("trial", "goals", "reached", "distance_p95", "iterations"),
}
"""Columns that are the same whenever and wherever an experiment is run."""
Tables = dict[str, dict[str, NDArray[Any]]]


def write_files(folder: Path, experiment: str = EXPERIMENT) -> Path:
    """Write an experiment with its scenes."""
    (folder / "arm.yaml").write_text(SCENE, encoding="utf-8")
    (folder / "leg.yaml").write_text(LEG, encoding="utf-8")
    file = folder / "trial.yaml"
    file.write_text(experiment, encoding="utf-8")
    return file


def read(file: Path, *changes: str) -> Experiment:
    """Read an experiment with values set."""
    return read_experiment(file, [read_override(change) for change in changes])


def run_here(file: Path, *changes: str, new: bool = False) -> Outcome:
    """Run an experiment in this process."""
    return run(prepare(read(file, *changes)), new)


def command(*arguments: str) -> list[str]:
    """Return the command line of `limbik experiment`."""
    return [sys.executable, "-m", "limbik", "experiment", *arguments]


def run_program(
    folder: Path, *arguments: str, timeout: float = 900.0
) -> subprocess.CompletedProcess[str]:
    """Run `limbik experiment` as a program in a folder."""
    return subprocess.run(
        command(*arguments),
        cwd=folder,
        env={**os.environ, "PYTHONWARNINGS": "default"},
        capture_output=True,
        text=True,
        timeout=timeout,
    )


def tables(folder: Path, metrics: Sequence[str] = ()) -> Tables:
    """Read what a run's table has apart from times, in the order of trials and goals."""
    manifest = read_manifest(folder)
    found: Tables = {}
    for table, columns in EXACT.items():
        names = (*columns, *(metrics if table == PATHS else ()))
        parts = [decode(path, names) for path in parts_of(folder, manifest, table)]
        joined = {name: np.concatenate([part[name] for part in parts]) for name in names}
        order = np.lexsort((joined.get("goal", joined["trial"]), joined["trial"]))
        found[table] = {name: column[order] for name, column in joined.items()}
    return found


def parts(folder: Path) -> int:
    """How many parts of a run are finished."""
    return sum(len(list((folder / table).glob("part-*"))) for table in EXACT)


def assert_same(first: Tables, second: Tables) -> None:
    """Hold two tables equal, bit for bit."""
    for table, columns in first.items():
        for name, column in columns.items():
            np.testing.assert_array_equal(column, second[table][name], f"{table}.{name}")
