"""An experiment in a fresh folder that is the working folder."""

from pathlib import Path

import pytest

from limbik.tests.experiments.helpers import write_files


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The experiment's file."""
    monkeypatch.chdir(tmp_path)
    return write_files(tmp_path)
