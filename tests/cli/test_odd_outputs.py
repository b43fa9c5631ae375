"""Names of files that are no plain files, numbers of samples that are none, and complete help."""

import os
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from limbik.plugins.output.files import write_whole

Run = Callable[..., tuple[int, str, str]]


@pytest.mark.parametrize("name", ["", "."])
def test_a_template_needs_a_name(run: Run, name: str) -> None:
    status, _, err = run("init", name)
    assert status == 2
    assert "a file's name is needed" in err


@pytest.mark.parametrize("name", ["", "."])
def test_a_table_needs_a_name(run: Run, scene: str, name: str) -> None:
    status, _, err = run("solve", scene, "--csv", name)
    assert status == 3
    assert "a file's name is needed" in err


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "table.csv")
    write_whole(tmp_path / "link", "one")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "table.csv").read_text() == "one"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_pipe_is_written_into_and_stays(tmp_path: Path) -> None:
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_whole(pipe, "one")
    reader.join()
    assert read == ["one"]
    assert pipe.is_fifo()


@pytest.mark.parametrize("dt", ["inf", "nan", "0"])
def test_an_endless_step_is_refused(run: Run, dt: str) -> None:
    pytest.importorskip("scipy")
    weld = Path(__file__).parents[2] / "configs" / "weld.yaml"
    status, out, err = run("trajectory", str(weld), "--dt", dt)
    assert (status, out) == (2, "")
    assert "time between samples" in err


def test_no_unit_is_lost_from_the_help(run: Run) -> None:
    _, out, _ = run("trajectory", "--help")
    shown = " ".join(out.replace("│", " ").split())
    assert "in seconds" in shown
    assert "in radians" in shown
