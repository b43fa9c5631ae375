"""How the command line refuses a malformed scene."""

import sys
from pathlib import Path

import pytest

from limbik.cli import main


def assert_check_refuses(
    scene: Path,
    text: str,
    first: str,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """`limbik check` ends with 2, points at the first fault, and writes nothing else.

    Args:
        scene: File to write the text to.
        text: The scene.
        first: The first fault, starting with its line and column.
        capsys: What is written.
        monkeypatch: For the arguments.
    """
    scene.write_text(text, encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["limbik", "check", str(scene)])
    with pytest.raises(SystemExit) as left:
        main()
    shown = capsys.readouterr()

    place = first.split(" ")[0]
    assert left.value.code == 2
    assert shown.err.startswith(f"{scene}:{place} error[")
    assert shown.out == ""
    assert "Traceback" not in shown.err
