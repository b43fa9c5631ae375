"""Killed at any moment and started again, a run ends with the table of one left alone."""

import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from limbik.plugins.experiments.plan import SOLVES
from limbik.tests.experiments.helpers import (
    MANY,
    Tables,
    assert_same,
    command,
    parts,
    run_program,
    tables,
    write_files,
)

pytestmark = pytest.mark.skipif(os.name != "posix", reason="kills process groups")


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Tables, int]:
    """The table of a run that nothing disturbs, and how many parts it has."""
    folder = tmp_path_factory.mktemp("undisturbed")
    write_files(folder, MANY)
    done = run_program(folder, "run", "trial.yaml")
    assert done.returncode == 0, done.stderr
    return tables(folder / "run", ("gain",)), parts(folder / "run")


def start(folder: Path, engine: str) -> subprocess.Popen[bytes]:
    """Start a run in a process group of its own, which hears Ctrl-C though this one may not."""
    ours = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return subprocess.Popen(
            command("run", "trial.yaml", "--engine", engine, "--workers", "2"),
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
    finally:
        signal.signal(signal.SIGINT, ours)


def kill(run: subprocess.Popen[bytes]) -> None:
    """Kill a run and its workers, if they are still there."""
    if run.poll() is None:
        os.killpg(run.pid, signal.SIGKILL)
    run.wait()


def kill_often(folder: Path, engine: str, kills: int, seed: int, planned: int) -> None:
    """Kill a run again and again, each time a random while after another part is there."""
    chance = random.Random(seed)
    for left in range(kills, 0, -1):
        before = parts(folder / "run")
        enough = before + (planned - before) // (left + 1) * chance.random()
        run = start(folder, engine)
        while run.poll() is None and parts(folder / "run") <= enough:
            time.sleep(0.002)
        time.sleep(0.02 * chance.random())
        kill(run)


def finish(folder: Path, engine: str, expected: Tables, planned: int) -> None:
    """Let the run end and hold its table to that of the one left alone."""
    done = run_program(folder, "run", "trial.yaml", "--engine", engine, "--workers", "2")
    assert done.returncode == 0, done.stderr
    assert parts(folder / "run") == planned
    assert not [left for left in (folder / "run").rglob(".limbik-*") if left.parent.name == SOLVES]
    assert_same(tables(folder / "run", ("gain",)), expected)


@pytest.mark.parametrize("engine", ["serial", "local"])
def test_killed_twice_it_goes_on(
    engine: str, tmp_path: Path, undisturbed: tuple[Tables, int]
) -> None:
    expected, planned = undisturbed
    write_files(tmp_path, MANY)

    kill_often(tmp_path, engine, 2, 5, planned)

    assert 0 < parts(tmp_path / "run") < planned
    finish(tmp_path, engine, expected, planned)


@pytest.mark.slow
def test_killed_twenty_times_it_goes_on(tmp_path: Path, undisturbed: tuple[Tables, int]) -> None:
    expected, planned = undisturbed
    write_files(tmp_path, MANY)

    kill_often(tmp_path, "local", 20, 11, planned)

    assert 0 < parts(tmp_path / "run") < planned
    finish(tmp_path, "local", expected, planned)


def test_killed_before_there_is_a_part_it_starts_anew(
    tmp_path: Path, undisturbed: tuple[Tables, int]
) -> None:
    """Killed right after its folder appears: an empty folder or one with a manifest alone."""
    expected, planned = undisturbed
    write_files(tmp_path, MANY)

    run = start(tmp_path, "serial")
    while run.poll() is None and not (tmp_path / "run").exists():
        time.sleep(0.001)
    kill(run)

    finish(tmp_path, "serial", expected, planned)


def children(pid: int) -> list[int]:
    """The processes a process has started."""
    listed = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    return [int(child) for child in listed.split()]


def workers(pid: int) -> list[int]:
    """The worker processes among them."""
    found = []
    for child in children(pid):
        words = Path(f"/proc/{child}/cmdline").read_bytes()
        found += [child] if b"popen_loky" in words else []
    return found


needs_proc = pytest.mark.skipif(
    not Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").exists(), reason="needs /proc"
)


@needs_proc
def test_a_worker_that_is_killed_loses_nothing(
    tmp_path: Path, undisturbed: tuple[Tables, int]
) -> None:
    expected, planned = undisturbed
    write_files(tmp_path, MANY)

    run = start(tmp_path, "local")
    try:
        while run.poll() is None and parts(tmp_path / "run") < 3:
            time.sleep(0.002)
        victims = workers(run.pid)
        assert victims
        os.kill(victims[0], signal.SIGKILL)
        assert run.wait(timeout=900) == 0
    finally:
        kill(run)

    assert parts(tmp_path / "run") == planned
    assert_same(tables(tmp_path / "run", ("gain",)), expected)


@needs_proc
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_no_worker_outlives_the_run(tmp_path: Path, how: signal.Signals) -> None:
    write_files(tmp_path, MANY.replace("count: 4000", "count: 100000"))
    run = start(tmp_path, "local")
    try:
        while run.poll() is None and parts(tmp_path / "run") < 2:
            time.sleep(0.005)
        left = workers(run.pid)
        assert left
        os.kill(run.pid, how)
        status = run.wait(timeout=300)
        assert status == (130 if how == signal.SIGINT else -how)
        give_up = time.monotonic() + 30.0
        while left and time.monotonic() < give_up:
            left = [pid for pid in left if is_running(pid)]
            time.sleep(0.05)
        assert not left
    finally:
        kill(run)
        shutil.rmtree(tmp_path / "run", ignore_errors=True)


def is_running(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"
