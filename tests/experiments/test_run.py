"""Running: the table is what solving the goals gives, however it is cut, resumed and stored."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import EnvironmentProblem, InputError, PluginError
from limbik.core.registry import Registry
from limbik.core.scene import read_scene
from limbik.core.solver import Solver
from limbik.core.solving import solve_goals
from limbik.plugins.experiments import batch, table
from limbik.plugins.experiments.folder import locked, read_manifest
from limbik.plugins.experiments.plan import PATHS, SOLVES
from limbik.plugins.experiments.run import prepare, run
from limbik.plugins.experiments.table import FAILED, NPZ, PARQUET, decode, is_whole
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.judging.run import run_scene
from limbik.plugins.output.files import write_whole
from limbik.tests.experiments.helpers import (
    EXPERIMENT,
    assert_same,
    read,
    run_here,
    tables,
    write_files,
)


@pytest.fixture(params=[NPZ, PARQUET])
def form(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both forms of parts."""
    if request.param == PARQUET:
        pytest.importorskip("pyarrow")
    monkeypatch.setattr("limbik.plugins.experiments.run.form_here", lambda: request.param)
    return str(request.param)


def test_rows_are_what_a_solver_gives_for_the_same_goals(file: Path, form: str) -> None:
    run_here(file)

    found = tables(Path("run"))[SOLVES]
    trial = read(file).trials[1]
    goals = trial.goal_set.goals.positions(trial.scene.chain)
    scene = read_scene("arm.yaml")
    expected = Solver(scene.chain, scene.settings, initial_bend="nth-root").solve_many(goals)
    own = found["trial"] == 1
    np.testing.assert_array_equal(found["goal"][own], np.arange(100))
    np.testing.assert_array_equal(np.stack([found[a][own] for a in "xyz"], axis=1), goals)
    np.testing.assert_array_equal(found["distance"][own], expected.distance)
    np.testing.assert_array_equal(found["status"][own], expected.status)
    np.testing.assert_array_equal(found["iterations"][own], expected.iterations)
    assert len(found["trial"]) == 4 * (100 + 20)
    assert read_manifest(Path("run"))["form"] == form


def test_metrics_are_those_of_judge(file: Path) -> None:
    """The path once more as a scene: the same numbers; what needs a path is NaN without one."""
    run_here(file)

    trial = read(file).trials[4]
    goals = trial.goal_set.goals.positions(trial.scene.chain)
    lines = "".join(f"  - {{position: {goal}}}\n" for goal in goals.tolist())
    head = Path("arm.yaml").read_text(encoding="utf-8").partition("goals:\n")[0]
    head = head.replace("options: {", "options: {initial_bend: nth-root, finish: none, ")
    Path("path.yaml").write_text(f"{head}goals:\n{lines}", encoding="utf-8")
    judged = run_scene(read_scene("path.yaml"))
    found = tables(Path("run"), ("reach_error", "gain", "unsound_poses"))[PATHS]
    for name in ("reach_error", "gain", "unsound_poses"):
        assert found[name][4] == BY_NAME[name].measure(judged), name
    assert np.isnan(found["gain"][:4]).all()
    assert np.isfinite(found["gain"][4:]).all()
    assert np.isfinite(found["reach_error"]).all()
    assert found["reached"][4] == np.mean(np.asarray(judged.solution.status) == 0)


def test_a_followed_path_is_solved_from_pose_to_pose(file: Path) -> None:
    changes = ("goals.1.follow=true", "strategies.0.options.start=current", "metrics.0=drift")

    run_here(file, *changes)

    trial = read(file, *changes).trials[4]
    goals = trial.goal_set.goals.positions(trial.scene.chain)
    expected = Solver(trial.scene.chain, trial.scene.settings).follow(goals)
    found = tables(Path("run"))[SOLVES]
    np.testing.assert_array_equal(found["distance"][found["trial"] == 4], expected.distance)


def test_plugins_solvers_and_2d_chains_are_compared_too(tmp_path: Path) -> None:
    """A metric that mixes IK and FK says nothing about a plug-in's solver, the others do."""
    text = EXPERIMENT.replace("chains: [arm.yaml]", "chains: [arm.yaml, leg.yaml]")
    text = text.replace("kind: reach,", "kind: reach, by: ball,")
    text = text.replace("options: {initial_bend: two-bone}}", "solver: fabrik, options: {}}")
    text = text.replace("metrics: [", "metrics: [drift, mix_detour, ")
    file = write_files(tmp_path, text.replace("output: run", f"output: {tmp_path}/run"))

    run_here(file)

    found = tables(tmp_path / "run", ("gain", "drift", "mix_detour"))
    trials = read(file).trials
    whole = np.array([trial.solver is not None for trial in trials])
    path = np.array([trial.goal_set.is_path for trial in trials])
    assert whole.sum() == 8
    assert (np.isfinite(found[PATHS]["gain"]) == path).all()
    assert np.isfinite(found[PATHS]["drift"]).all()
    assert (np.isfinite(found[PATHS]["mix_detour"]) <= ~whole).all()
    assert set(found[SOLVES]["trial"].tolist()) == set(range(len(trials)))


@pytest.mark.parametrize("goals", ["1", "7", "1000"])
def test_the_table_does_not_depend_on_how_it_is_cut(file: Path, goals: str) -> None:
    run_here(file)

    run_here(file, f"batch={goals}", "output=other")

    assert_same(tables(Path("run")), tables(Path("other")))


def test_a_run_goes_on_where_it_was(file: Path, form: str) -> None:
    """Parts that are there stay as they are; missing and damaged ones are made anew."""
    first = run_here(file)
    whole = tables(Path("run"))
    parts = sorted(Path("run/solves").iterdir())
    parts[0].unlink()
    parts[1].write_bytes(parts[1].read_bytes()[:-9])
    parts[2].write_bytes(b"")
    (Path("run/solves") / ".limbik-left").write_bytes(b"half")
    kept = parts[3].stat().st_mtime_ns

    again = run_here(file)

    assert (first.before, again.before) == (0, again.parts - 3)
    assert_same(tables(Path("run")), whole)
    assert parts[3].stat().st_mtime_ns == kept
    assert not list(Path("run/solves").glob(".*"))
    assert parts[0].suffix == f".{form}"


def test_a_changed_experiment_is_refused_and_nothing_of_the_old_one_touched(file: Path) -> None:
    run_here(file)
    before = {path: path.read_bytes() for path in Path("run").rglob("*") if path.is_file()}

    with pytest.raises(InputError) as caught:
        run_here(file, "seed=8", "sweep.smoothing=0.5")

    assert str(caught.value) == (
        "run: error[changed]: this folder holds another experiment: experiment.seed: 7 there, "
        "8 here; experiment.sweep.smoothing: null there, [0.5] here "
        "(--new takes a folder of its own, -o names one)"
    )
    assert {path: path.read_bytes() for path in before} == before


def test_a_changed_scene_or_goal_file_is_another_experiment(file: Path) -> None:
    Path("goals.csv").write_text("name,x,y,z\na,1,2,30\nb,4,5,40\n", encoding="utf-8")
    changes = ("goals.0.kind=file", "goals.0.csv=goals.csv")
    text = file.read_text(encoding="utf-8").replace("kind: reach, count: 100", "kind: file")
    file.write_text(text, encoding="utf-8")
    run_here(file, *changes)

    Path("goals.csv").write_text("name,x,y,z\na,1,2,30\nb,4,5,41\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"points\.goals"):
        run_here(file, *changes)
    scene = Path("arm.yaml").read_text(encoding="utf-8")
    Path("arm.yaml").write_text(scene.replace("[0, 0, 26]", "[0, 0, 27]"), encoding="utf-8")
    with pytest.raises(InputError, match=r"scenes\.arm\.chain\.joints\[2\]\.offset\[2\]: 26"):
        run_here(file, *changes)


def test_what_changes_no_result_changes_no_experiment(file: Path) -> None:
    """Another engine, other goals in the scene, a comment: the run goes on."""
    run_here(file)
    scene = Path("arm.yaml").read_text(encoding="utf-8")
    Path("arm.yaml").write_text(f"# new\n{scene}  - {{position: [1, 2, 30]}}\n", encoding="utf-8")

    assert run_here(file, "name=other", "workers=3").before == run_here(file).parts


def test_new_takes_the_next_free_folder_and_finds_it_again(file: Path) -> None:
    run_here(file)

    second = run_here(file, "seed=8", new=True)
    third = run_here(file, "seed=9", new=True)
    again = run_here(file, "seed=8", new=True)

    assert [str(o.folder) for o in (second, third, again)] == ["run-2", "run-3", "run-2"]
    assert again.before == again.parts


def test_a_folder_with_other_files_is_left_alone(file: Path) -> None:
    Path("run").mkdir()
    Path("run/thesis.txt").write_text("mine", encoding="utf-8")

    with pytest.raises(InputError, match="this folder holds other files and no run"):
        run_here(file)

    assert [path.name for path in Path("run").iterdir()] == ["thesis.txt"]


def test_another_version_is_another_experiment(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_here(file)
    monkeypatch.setattr("limbik.plugins.experiments.identity.__version__", "9.9")

    with pytest.raises(InputError, match=r'limbik: ".*" there, "9.9" here'):
        run_here(file)


def test_two_runs_at_once_in_one_folder_are_refused(file: Path) -> None:
    pytest.importorskip("fcntl")
    run_here(file)

    with (
        locked(Path("run")),
        pytest.raises(EnvironmentProblem, match=r"another run is writing into run \(process \d+\)"),
    ):
        run_here(file)


def test_a_full_disk_loses_nothing(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After some parts the disk is full: a message, no half part, and the run can go on."""
    written: list[Path] = []

    def keep(path: Path, content: bytes | str, *, durable: bool = False) -> None:
        if path.parent.name == SOLVES and len(written) == 3:
            raise EnvironmentProblem(f"cannot write {path}: No space left on device")
        written.append(path)
        real(path, content, durable=durable)

    real = write_whole
    monkeypatch.setattr("limbik.plugins.experiments.folder.write_whole", keep)
    with pytest.raises(EnvironmentProblem, match="No space left"):
        run_here(file)
    monkeypatch.undo()
    monkeypatch.chdir(file.parent)

    assert run_here(file).before == 2  # and the manifest
    assert_same(tables(Path("run")), _undisturbed(file))


def _undisturbed(file: Path) -> Any:
    run_here(file, "output=undisturbed")
    return tables(Path("undisturbed"))


def test_a_solve_that_fails_is_a_row(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A strategy answers nonsense for some goals: those rows say so, the others are as ever."""
    undisturbed = _undisturbed(file)[SOLVES]
    bad = undisturbed["x"] > np.median(undisturbed["x"])
    edge = float(np.median(undisturbed["x"]))

    def failing(scene: Any, registry: Any, threads: int) -> Any:
        if (scene.goals[:, 0] > edge).any():
            raise PluginError("its result is not a finite number")
        return solve_goals(scene, registry, threads)

    monkeypatch.setattr(batch, "solve_goals", failing)

    outcome = run_here(file)

    found = tables(Path("run"))[SOLVES]
    assert outcome.failed == bad.sum() > 0
    np.testing.assert_array_equal(found["status"] == FAILED, bad)
    np.testing.assert_array_equal(np.isnan(found["distance"]), bad)
    np.testing.assert_array_equal(found["distance"][~bad], undisturbed["distance"][~bad])


def test_parts_say_what_they_belong_to(file: Path, form: str) -> None:
    run_here(file)

    manifest = read_manifest(Path("run"))
    part = sorted(Path("run/solves").iterdir())[0]
    if form == NPZ:
        with np.load(part) as arrays:
            stamp = json.loads(str(arrays["limbik"]))
    else:
        from pyarrow import parquet

        stamp = json.loads(parquet.read_schema(part).metadata[b"limbik"])
    for key in ("fingerprint", "seed", "versions", "name"):
        assert stamp[key] == manifest[key]
    assert manifest["versions"]["limbik"]
    assert len(manifest["trials"]) == 8


def test_parquet_has_words_beside_the_numbers(file: Path) -> None:
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    run_here(file)

    rows = [row for p in sorted(Path("run/solves").iterdir()) for row in _rows(parquet, p)]
    assert {(r["trial"], r["strategy"], r["finish"]) for r in rows} == {
        (trial.number, trial.strategy, trial.params["finish"]) for trial in read(file).trials
    }
    assert {row["chain"] for row in rows} == {"arm"}
    assert {row["goals"] for row in rows} == {"reach", "path"}
    assert {row["status"] for row in rows} <= set(table.STATUSES)
    assert {row["length"] for row in rows} == {56.0}
    (path,) = _rows(parquet, Path("run/paths/part-000000.parquet"))
    assert path["gain"] is None


def _rows(parquet: Any, path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = parquet.read_table(path).to_pylist()
    return found


def test_a_damaged_part_is_told_by_name(file: Path, form: str) -> None:
    run_here(file)
    part = sorted(Path("run/solves").iterdir())[0]
    content = bytearray(part.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 40] = bytes(40)
    part.write_bytes(content)

    with pytest.raises(EnvironmentProblem, match=rf"cannot read run/solves/part-000000\.{form}"):
        decode(part, ("trial", "x", "y", "z", "status", "distance", "goal"))


def test_a_part_with_other_rows_is_not_whole(file: Path, form: str) -> None:
    run_here(file)
    part = sorted(Path("run/solves").iterdir())[0]
    rows = prepare(read(file)).batches[0].rows

    assert is_whole(part, rows)
    assert not is_whole(part, rows + 1)
    assert not is_whole(part.with_name(f"none.{form}"), rows)


def test_a_run_in_parquet_is_not_gone_on_with_without_pyarrow(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("pyarrow")
    run_here(file)
    monkeypatch.setattr(table, "find_spec", lambda name: None)

    with pytest.raises(EnvironmentProblem, match=r"pip install 'limbik\[experiments\]'"):
        run_here(file)


def test_progress_counts_what_earlier_runs_did(file: Path) -> None:
    prepared = prepare(read(file))
    told: list[int] = []
    again: list[int] = []
    run(prepared, progress=told.append)
    sorted(Path("run/solves").iterdir())[0].unlink()

    run(prepared, progress=again.append)

    total = sum(batch.solves for batch in prepared.batches)
    assert told == sorted(told)
    assert told[-1] == total
    assert again == [total]


def test_the_registry_of_a_process_is_made_once() -> None:
    assert batch.registry() is batch.registry()
    assert isinstance(batch.registry(), Registry)
