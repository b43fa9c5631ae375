"""What goes to which stream, in which characters, and what a light command leaves alone."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]


def test_colours_stay_out_of_a_pipe_and_of_no_color(scene: str, run: Run, tmp_path: Path) -> None:
    for extra in ({}, {"NO_COLOR": "1", "FORCE_COLOR": "1"}):
        shown = subprocess.run(
            [sys.executable, "-m", "limbik", "solve", scene],
            cwd=tmp_path,
            env={**os.environ, **extra},
            capture_output=True,
            check=False,
        )
        assert shown.returncode == 0
        assert not [n for n in (*range(30, 38), *range(90, 98)) if b"[%dm" % n in shown.stdout]


def test_a_terminal_without_the_characters_gets_question_marks(
    scene: str, run: Run, tmp_path: Path
) -> None:
    shown = subprocess.run(
        [sys.executable, "-m", "limbik", "solve", scene],
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
        capture_output=True,
        check=False,
    )

    assert (shown.returncode, shown.stdout.decode("ascii").count("reached")) == (0, 3)


def test_a_closed_pipe_is_quiet(scene: str, run: Run, tmp_path: Path) -> None:
    for command in (["plugins"], ["plugins", "--json"], ["check", scene]):
        reader, writer = os.pipe()
        os.close(reader)
        shown = subprocess.run(
            [sys.executable, "-m", "limbik", *command],
            cwd=tmp_path,
            stdout=writer,
            stderr=subprocess.PIPE,
            check=False,
        )
        os.close(writer)
        assert (shown.returncode, shown.stderr) == (0, b"")


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], ["check", "scene.yaml"]])
def test_light_commands_import_nothing_heavy(
    scene: str, run: Run, tmp_path: Path, arguments: list[str]
) -> None:
    code = (
        "import sys\nfrom limbik.cli import main\n"
        f"sys.argv = ['limbik', *{arguments!r}]\n"
        "try:\n    main()\nexcept SystemExit as left:\n    status = left.code\n"
        "heavy = [m for m in ('numba', 'llvmlite', 'matplotlib', 'scipy') if m in sys.modules]\n"
        "print('HEAVY', status, heavy)\n"
    )
    shown = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )

    assert shown.stdout.splitlines()[-1] in ("HEAVY 0 []", "HEAVY None []"), shown.stderr


def test_solving_announces_that_machine_code_is_compiled(
    run: Run, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for before, announced in ((False, True), (True, False)):
        monkeypatch.setattr("limbik.core.jit.is_compiled_before", lambda before=before: before)
        _, _, err = run("solve", scene)
        assert ("compiling machine code" in err) is announced


@pytest.mark.parametrize("width", [600, 100])
def test_a_terminal_gets_the_joints_it_has_room_for(run: Run, tmp_path: Path, width: int) -> None:
    """A folded table of a spine cannot be read; a wide terminal gets all 23 joints that move."""
    run("init", "spine", "--template", "spine")
    shown = subprocess.run(
        [sys.executable, "-m", "limbik", "solve", "spine.yaml"],
        cwd=tmp_path,
        env={**os.environ, "FORCE_COLOR": "1", "COLUMNS": str(width)},
        capture_output=True,
        text=True,
        check=False,
    )
    lines = re.sub(r"\x1b\[[0-9;]*m", "", shown.stdout).splitlines()
    joints = lines[0].count("h/p/b")
    left_out = [line for line in lines if line == f"{23 - joints} more joints: see --json or --csv"]

    assert max(map(len, lines)) <= width
    assert (joints == 23) is (width == 600)
    assert len(left_out) == (width == 100)
    assert len(lines) == 2 + 10 + 1 + len(left_out)
