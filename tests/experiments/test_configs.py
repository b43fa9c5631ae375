"""The experiments limbik ships: each is sound and can be run, here with few goals."""

from pathlib import Path

import numpy as np
import pytest

from limbik.plugins.experiments.plan import SOLVES
from limbik.plugins.experiments.table import FAILED
from limbik.tests.experiments.helpers import read, run_here, tables

CONFIGS = sorted((Path(__file__).parents[2] / "configs" / "experiments").glob("*.yaml"))
FEWER = {
    "bends": ("goals.0.count=20",),
    "limits": ("goals.0.steps=1,5,5",),
    "root-control": ("goals.2.count=30",),
    "smoothing": ("goals.0.count=20",),
}


def test_all_of_them_are_looked_at() -> None:
    assert [path.stem for path in CONFIGS] == sorted(FEWER)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_a_shipped_experiment_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    changes = (*FEWER[path.stem], "engine=serial")

    outcome = run_here(path, *changes)

    metrics = read(path).model.metrics
    found = tables(outcome.folder, metrics)
    assert outcome.failed == 0
    assert (found[SOLVES]["status"] != FAILED).all()
    assert all(np.isfinite(found["paths"][name]).any() for name in metrics)
    assert outcome.folder == Path("runs", path.stem)
