"""The command line, called in this interpreter in a fresh folder, and scenes for it."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from limbik.cli import main

SCENE = """\
limbik: 1
chain:
  joints:
    - {name: shoulder}
    - {name: elbow, offset: [0, 0, 30], pitch: [-145, 0]}
    - {name: wrist, offset: [0, 0, 26]}
options: {max_iterations: 100}
goals:
  - {name: near, position: [5, 10, 40]}
  - {name: low, position: [0, -20, 35]}
"""
FAR = SCENE.replace("[0, -20, 35]", "[0, -20, 350]")
Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    """Run the command line in a fresh folder; give exit status, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")

    def call(*arguments: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["limbik", *arguments])
        with pytest.raises(SystemExit) as left:
            main()
        shown = capsys.readouterr()
        return int(left.value.code or 0), shown.out, shown.err

    return call


@pytest.fixture
def scene(tmp_path: Path) -> str:
    """A scene whose goals are both reached."""
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    return "scene.yaml"


@pytest.fixture
def far(tmp_path: Path) -> str:
    """A scene with one goal out of reach."""
    (tmp_path / "far.yaml").write_text(FAR, encoding="utf-8")
    return "far.yaml"


@pytest.fixture
def scene_text() -> str:
    """The text of the scene whose goals are both reached."""
    return SCENE
