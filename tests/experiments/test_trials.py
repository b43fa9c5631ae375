"""What an experiment expands to, and how it is cut into batches."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbik.core.settings import Settings
from limbik.plugins.experiments.labels import label_columns
from limbik.plugins.experiments.plan import MOST_JOINTS, PATHS, SOLVES, plan
from limbik.plugins.experiments.run import prepare
from limbik.plugins.experiments.variants import place, shown
from limbik.tests.experiments.helpers import EXPERIMENT, SCENE, read, write_files


def test_strategies_sweeps_chains_goals_and_repeats_are_crossed(file: Path) -> None:
    experiment = read(
        file,
        "goals.0.repeats=3",
        "sweep.bend_vector.angle=0,90",
        "strategies.1.sweep.smoothing=0.2,0.4",
    )

    variants = 2 * 2 * (1 + 2)
    assert len(experiment.trials) == variants * (3 + 1)
    last = experiment.trials[-1]
    assert last.label == "two-bone finish=newton bend_vector.angle=90 smoothing=0.4"
    assert last.scene.settings.bend_vector == {"use": "manual", "angle": 90}
    assert last.scene.settings.smoothing == 0.4
    assert last.scene.settings.reference_axis == "y-"  # the scene's own
    assert [trial.number for trial in experiment.trials] == list(range(4 * variants))


def test_a_strategy_is_put_on_top_of_the_scenes_options(file: Path) -> None:
    first = read(file).trials[0].scene.settings

    assert first == Settings(
        initial_bend="nth-root",
        finish="none",
        bend_vector={"use": "manual", "angle": 180},
        reference_axis="y-",
    )


def test_goal_sets_may_name_their_chains(tmp_path: Path) -> None:
    text = EXPERIMENT.replace("[arm.yaml]", "[arm.yaml, {name: other, scene: arm.yaml}]")
    text = text.replace("kind: path,", "kind: path, chains: [other],")

    trials = read(write_files(tmp_path, text)).trials

    assert [(t.chain, t.goal_set.name) for t in trials[::4]] == [
        ("arm", "reach"),
        ("other", "reach"),
        ("other", "path"),
    ]


def test_all_chains_draw_from_one_seed_and_all_variants_meet_the_same_goals(file: Path) -> None:
    trials = read(file).trials

    goals = [trial.goal_set.goals.positions(trial.scene.chain) for trial in trials[:4]]

    for other in goals[1:]:
        np.testing.assert_array_equal(goals[0], other)


def test_a_swept_parameter_keeps_what_the_scene_says_beside_it(tmp_path: Path) -> None:
    text = EXPERIMENT.replace("finish: [none, newton]", "bend_vector.exclude_bank: [true]")
    file = write_files(tmp_path, text.replace("arm.yaml]", "other.yaml]"))
    scene = SCENE.replace("options: {", "options: {held: {base: 1}, ")
    (tmp_path / "other.yaml").write_text(scene, encoding="utf-8")

    settings = read(file, "sweep.held.bend_base=true").trials[0].scene.settings

    expected = {"use": "manual", "angle": 180, "exclude_bank": True}
    assert settings.bend_vector == expected
    assert (settings.held.base, settings.held.bend_base) == (1, True)


def test_an_option_within_a_strategys_parameters_can_be_swept() -> None:
    options: dict[str, object] = {"held": {"base": 1}}

    place(options, "held.end", 2)
    place(options, "initial_bend.exponent", 3.0)

    assert options == {
        "held": {"base": 1, "end": 2},
        "initial_bend": {"use": "nth-root", "exponent": 3.0},
    }


@settings(max_examples=30)
@given(
    counts=st.lists(st.integers(1, 3000), min_size=1, max_size=6),
    goals=st.none() | st.integers(1, 500),
)
def test_batches_hold_every_goal_once(
    tmp_path_factory: pytest.TempPathFactory, counts: list[int], goals: int | None
) -> None:
    sets = "".join(f"  - {{name: g{k}, kind: reach, count: {n}}}\n" for k, n in enumerate(counts))
    head, _, tail = EXPERIMENT.partition("goals:\n")
    text = f"{head}goals:\n{sets}{tail[tail.index('metrics') :]}"
    trials = read(write_files(tmp_path_factory.mktemp("batches"), text)).trials

    batches = plan(trials, goals, True)

    seen = {trial.number: np.zeros(trial.count, int) for trial in trials}
    for batch in (batch for batch in batches if batch.table == SOLVES):
        assert batch.rows == batch.solves <= max(goals or MOST_JOINTS / 3, 1) * 1.5 + 1
        for piece in batch.pieces:
            seen[piece.trial][piece.start : piece.stop] += 1
    assert all((found == 1).all() for found in seen.values())
    paths = [batch for batch in batches if batch.table == PATHS]
    assert [batch.pieces[0].trial for batch in paths] == [trial.number for trial in trials]
    for table in (SOLVES, PATHS):
        numbers = [batch.number for batch in batches if batch.table == table]
        assert numbers == list(range(len(numbers)))


def test_a_path_is_never_cut(file: Path) -> None:
    batches = plan(read(file, "goals.1.count=500").trials, 40, False)

    pieces = [piece for batch in batches for piece in batch.pieces if piece.trial >= 4]
    assert [(piece.start, piece.stop) for piece in pieces] == [(0, 500)] * 4


def test_the_plan_does_not_depend_on_the_engine(file: Path) -> None:
    one = prepare(read(file, "engine=serial"))
    other = prepare(read(file, "engine=local", "workers=4", "output=elsewhere"))

    assert one.batches == other.batches
    assert one.manifest["fingerprint"] == other.manifest["fingerprint"]


def test_labels_are_of_one_type_in_each_column(file: Path) -> None:
    trials = read(
        file,
        "strategies.0.sweep.max_iterations=5,10",
        "sweep.aim_twist=true,false",
        "sweep.initial_bend=nth-root,two-bone",
    ).trials

    columns = label_columns(trials)

    assert set(columns["max_iterations"]) == {5.0, 10.0, None}
    assert set(columns["aim_twist"]) == {True, False}
    assert set(columns["initial_bend"]) == {"nth-root", "two-bone"}
    assert {len(column) for column in columns.values()} == {len(trials)}


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (0.1, "0.1"),
        (True, "true"),
        ([0, 1.5], "[0 1.5]"),
        ({"use": "two-bone"}, "two-bone"),
        ({"use": "nth-root", "exponent": 2}, "nth-root/exponent=2"),
        ("plain", "plain"),
    ],
)
def test_swept_values_are_shown_briefly(value: object, words: str) -> None:
    assert shown(value) == words
