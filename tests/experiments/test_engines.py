"""The same experiment gives the same table in one process, in several, and on a cluster."""

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from pathlib import Path

import pytest

from limbik.core.errors import EnvironmentProblem
from limbik.plugins.experiments import engine
from limbik.tests.experiments.helpers import (
    EXPERIMENT,
    MANY,
    assert_same,
    command,
    parts,
    read,
    run_here,
    run_program,
    tables,
    write_files,
)

METRICS = ("reach_error", "gain", "unsound_poses")
needs_dask = pytest.mark.skipif(find_spec("distributed") is None, reason="needs limbik[dask]")


@pytest.mark.parametrize("workers", ["1", "3"])
def test_several_processes_give_the_table_of_one(file: Path, workers: str) -> None:
    run_here(file)

    done = run_program(
        file.parent, "run", "trial.yaml", "--engine", "local", "--workers", workers, "-o", "many"
    )

    assert done.returncode == 0, done.stderr
    assert_same(tables(Path("run"), METRICS), tables(Path("many"), METRICS))


def test_a_run_begun_by_one_engine_is_ended_by_another(file: Path) -> None:
    run_here(file)
    whole = tables(Path("run"), METRICS)
    for part in sorted(Path("run/solves").iterdir())[::2]:
        part.unlink()

    done = run_program(file.parent, "run", "trial.yaml", "--engine", "local", "--workers", "2")

    assert done.returncode == 0, done.stderr
    assert_same(tables(Path("run"), METRICS), whole)


def test_a_small_experiment_stays_in_this_process_unless_told_otherwise(tmp_path: Path) -> None:
    from limbik.plugins.experiments.run import prepare

    file = write_files(tmp_path, EXPERIMENT.replace("engine: serial\n", ""))

    assert prepare(read(file)).engine == "serial"
    assert prepare(read(file, "goals.0.count=100000")).engine == "local"
    assert prepare(read(file, "engine=local")).engine == "local"


def free_port() -> int:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        return int(taken.getsockname()[1])


def program(*arguments: str) -> subprocess.Popen[bytes]:
    """Start a program of Dask in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )


@contextmanager
def cluster() -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and two worker processes on loopback; gives its address and the workers."""
    port = free_port()
    address = f"127.0.0.1:{port}"
    place = ("--host", "127.0.0.1", "--no-dashboard")
    running = [program("dask_scheduler", *place, "--port", str(port))]
    try:
        for _ in range(2):
            arguments = (f"tcp://{address}", "--nthreads", "1", "--no-nanny", "--no-dashboard")
            running.append(program("dask_worker", *arguments, "--death-timeout", "60"))
        wait_for_workers(address)
        yield address, running[1:]
    finally:
        for process in running:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def wait_for_workers(address: str) -> None:
    """Wait until both workers are there, from a process of its own that Dask may log into."""
    code = (
        "from distributed import Client; import sys\n"
        "Client(sys.argv[1], timeout=90).wait_for_workers(2, timeout=90)"
    )
    subprocess.run([sys.executable, "-c", code, f"tcp://{address}"], check=True, timeout=180)


@needs_dask
def test_a_cluster_gives_the_same_table_though_a_worker_is_killed(tmp_path: Path) -> None:
    file = write_files(tmp_path, MANY)
    run_here(file, f"output={tmp_path}/serial")

    with cluster() as (address, workers):
        run = subprocess.Popen(
            command("run", "trial.yaml", "--engine", f"dask://{address}"),
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        try:
            while run.poll() is None and parts(tmp_path / "run") < 5:
                time.sleep(0.01)
            assert run.poll() is None, "over before a worker could be killed"
            os.killpg(workers[0].pid, signal.SIGKILL)
            _, told = run.communicate(timeout=900)
        finally:
            run.kill()
            run.wait()
        assert run.returncode == 0, told.decode()
        assert workers[1].poll() is None

    assert_same(tables(tmp_path / "run", METRICS), tables(tmp_path / "serial", METRICS))


@needs_dask
def test_a_scheduler_that_is_not_there_is_one_line(file: Path) -> None:
    address = f"127.0.0.1:{free_port()}"

    done = run_program(file.parent, "run", "trial.yaml", "--engine", f"dask://{address}")

    assert done.returncode == 3
    line = f"limbik: no Dask scheduler answers at {address}; start one with 'dask scheduler'\n"
    assert done.stderr.endswith(line)
    assert "Traceback" not in done.stderr


def test_without_dask_the_extra_is_named(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)

    with pytest.raises(EnvironmentProblem, match=r"pip install 'limbik\[dask\]'"):
        run_here(file, "engine=dask://127.0.0.1:1")


def test_workers_of_another_version_are_refused() -> None:
    here = {"limbik": "1.0", "numpy": "2.0"}
    there = {"tcp://a:1": here, "tcp://b:2": {"limbik": "1.0", "numpy": "1.26"}}

    with pytest.raises(EnvironmentProblem) as caught:
        engine._check_versions(there, here, "a:0")

    assert str(caught.value) == "workers of other versions:\n  tcp://b:2: numpy 1.26, here 2.0"


def test_a_scheduler_without_workers_is_refused() -> None:
    with pytest.raises(EnvironmentProblem, match="has no workers; start some with 'dask worker'"):
        engine._check_versions({}, {"limbik": "1.0"}, "a:0")


def test_workers_that_keep_dying_end_the_run(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lost three times without a part finished: a message; what was finished before stays."""
    from limbik.plugins.experiments import run

    calls = []

    def dying(*arguments: object) -> Iterator[None]:
        calls.append(arguments)
        raise engine.WorkerLost
        yield

    monkeypatch.setattr(run, "run_jobs", dying)

    with pytest.raises(EnvironmentProblem, match=r"3 times a worker was killed .* 2\d parts"):
        run_here(file)

    assert len(calls) == 3
