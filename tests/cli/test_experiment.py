"""`limbik experiment run`, `report` and `list`."""

import json
from pathlib import Path

import pytest

from limbik.tests.cli.conftest import Run
from limbik.tests.experiments.helpers import EXPERIMENT, write_files


@pytest.fixture
def file(tmp_path: Path) -> str:
    """A small experiment in the working folder."""
    write_files(tmp_path, EXPERIMENT)
    return "trial.yaml"


def test_run_report_and_list(run: Run, file: str) -> None:
    status, out, err = run("experiment", "run", file)
    assert status == 0, err
    assert out == ("run: 8 trials, 480 solves in 20 parts\nnext: limbik experiment report run\n")

    status, out, _ = run("experiment", "run", file)
    assert status == 0
    assert "in 20 parts, 20 of them were there" in out

    status, out, _ = run("experiment", "report", "run")
    assert status == 0
    assert "arm, reach: 100 goals each" in out
    assert "two-bone finish=newton" in out
    assert "wrote run/report.html" in out

    status, out, _ = run("experiment", "list", ".")
    assert status == 0
    assert out.splitlines()[2].split()[0] == "run"
    assert "all" in out


def test_json_of_all_three(run: Run, file: str) -> None:
    made = json.loads(run("experiment", "run", file, "--json")[1])
    assert (made["status"], made["parts"], made["parts_before"]) == ("ok", 20, 0)

    summary = json.loads(run("experiment", "report", "run", "--json")[1])
    assert summary["fingerprint"] == made["fingerprint"]
    assert [row["count"] for row in summary["rows"]] == [100] * 4 + [20] * 4
    assert summary["rows"][0]["metrics"]["gain"] is None

    listed = json.loads(run("experiment", "list", ".", "--json")[1])["runs"]
    assert [(run["folder"], run["parts"], run["planned"]) for run in listed] == [("run", 20, 20)]


def test_a_dry_run_writes_nothing(run: Run, file: str) -> None:
    status, out, _ = run(
        "experiment", "run", file, "--dry-run", "--set", "sweep.smoothing=0.1,0.5", "-o", "a,b"
    )

    assert status == 0
    assert "16 trials, 960 solves in 40 batches, by engine serial into a,b" in out
    assert "s of one core" in out
    assert not Path("run").exists()
    assert not Path("a,b").exists()
    record = json.loads(run("experiment", "run", file, "--dry-run", "--json")[1])
    assert record["seconds"] > 0.0
    assert record["bytes"] == 480 * 36


def test_a_dry_run_of_a_hundred_million_solves_does_not_draw_them(run: Run, file: str) -> None:
    options = ("--set", "goals.0.count=100000000", "--set", "batch=100000")
    Path(file).write_text(
        Path(file).read_text(encoding="utf-8").replace("metrics: [", "# metrics: ["),
        encoding="utf-8",
    )

    record = json.loads(run("experiment", "run", file, "--dry-run", "--json", *options)[1])

    assert record["solves"] == 4 * (100_000_000 + 20)


def test_a_changed_experiment_needs_another_folder(run: Run, file: str) -> None:
    run("experiment", "run", file)

    status, out, err = run("experiment", "run", file, "--set", "seed=8")
    assert (status, out) == (2, "")
    assert err.startswith("run: error[changed]: this folder holds another experiment")
    assert run("experiment", "run", file, "--set", "seed=8", "--new")[1].startswith("run-2: ")
    assert run("experiment", "run", file, "--set", "seed=9", "-o", "nine")[1].startswith("nine: ")


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (("run", "no.yaml"), 2, "no.yaml: error[unreadable]: cannot read the file"),
        (("run", "trial.yaml", "--engine", "ray"), 2, "--engine ray: error[choice]: engine: must"),
        (("run", "trial.yaml", "--set", "x=1"), 2, "--set x=1: error[unknown-key]: x: unknown"),
        (("run", "trial.yaml", "-o", "arm.yaml"), 2, "arm.yaml: error[exists]: this folder holds"),
        (("run", "trial.yaml", "-o", "arm.yaml/x"), 3, "limbik: cannot make arm.yaml/x"),
        (("report", "."), 2, ".: error[no-run]: this folder holds no run"),
        (("report", "nowhere"), 2, "nowhere: error[no-run]: this folder holds no run"),
        (("list", "nowhere"), 2, "nowhere: error[unreadable]: there is no such folder"),
    ],
)
def test_what_goes_wrong_is_said_in_a_line(
    run: Run, file: str, arguments: tuple[str, ...], status: int, message: str
) -> None:
    left, out, err = run("experiment", *arguments)

    assert (left, out) == (status, "")
    assert message in err
    assert "Traceback" not in err


def test_list_without_runs(run: Run) -> None:
    Path("runs").mkdir()

    assert run("experiment", "list")[:2] == (0, "no runs in runs\n")


def test_progress_goes_to_stderr_with_the_time_left(run: Run, file: str) -> None:
    _, out, err = run(
        "experiment", "run", file, "--set", "goals.0.count=1000", "--set", "batch=400"
    )

    assert "%" not in out
    assert "100 % 8160/8160" in err
    assert " s left" in err


def test_the_commands_are_in_the_help(run: Run) -> None:
    shown = run("--help")[1]
    assert "experiment" in shown
    status, shown, _ = run("experiment", "--help")
    assert status == 0
    assert all(name in shown for name in ("run", "report", "list"))
