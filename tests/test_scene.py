"""Scenes become chains, settings and goals; CSV goals and limits between parts are checked."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from limbik.core.errors import Fault, SceneError
from limbik.core.registry import Registry
from limbik.core.scene import Scene, read_scene, scene_from
from limbik.core.solving import are_met, solve_scene
from limbik.core.yamlfile import read_yaml

REGISTRY = Registry(third_party=False)
SCENE = """\
limbik: 1
chain:
  base: {position: [1, 2, 3], rotation: [90, 0, 0]}
  joints:
    - {name: shoulder, frozen: [0, 30, 0], heading: [-130, 60], pitch: 20}
    - {name: elbow, offset: [0, 0, 30], rest: [0, 10, 0], pitch: [0, 145], bank: 0}
    - {name: wrist, offset: [0, 0, 26]}
"""
GOALS = "goals:\n  - {name: near, position: [1, 2, 40]}\n  - {position: [1, 2, 50]}\n"


def scene(text: str, folder: Path = Path()) -> Scene:
    return scene_from(read_yaml(text, "scene.yaml"), folder, REGISTRY)


def faults(text: str, folder: Path = Path()) -> list[str]:
    with pytest.raises(SceneError) as caught:
        scene(text, folder)
    return [str(fault) for fault in caught.value.faults]


def test_degrees_become_radians_and_a_number_fixes_an_axis() -> None:
    chain = scene(SCENE + GOALS).chain

    np.testing.assert_allclose(np.degrees(chain.low[0]), [-130.0, 20.0, -np.inf])
    np.testing.assert_allclose(np.degrees(chain.high[0]), [60.0, 20.0, np.inf])
    np.testing.assert_allclose(np.degrees(chain.rest[1]), [0.0, 10.0, 0.0])
    np.testing.assert_allclose(np.degrees(chain.joints[0].frozen), [0.0, 30.0, 0.0])
    np.testing.assert_allclose(chain.lengths, [30.0, 26.0])


def test_the_base_is_placed_and_turned() -> None:
    chain = scene(SCENE + GOALS).chain

    assert chain.base_position == (1.0, 2.0, 3.0)
    np.testing.assert_allclose(chain.base_rotation[:, 2], [-1.0, 0.0, 0.0], atol=1e-15)


def test_goals_keep_their_order_and_a_nameless_one_has_its_number() -> None:
    found = scene(SCENE + GOALS)

    assert found.goal_names == ("near", "2")
    np.testing.assert_array_equal(found.goals, [[1, 2, 40], [1, 2, 50]])
    assert found.name == "scene"


def test_options_are_the_settings_and_absent_ones_have_their_defaults() -> None:
    found = scene(SCENE + "options: {smoothing: 0.5, held: {end: 1}}\n" + GOALS).settings

    assert (found.smoothing, found.held.end, found.max_iterations) == (0.5, 1, 20)


def test_fk_offsets_go_to_the_named_joints() -> None:
    found = scene(SCENE + "fk: {elbow: [0, 15, 0]}\n" + GOALS)

    np.testing.assert_allclose(np.degrees(found.fk_offsets), [[0, 0, 0], [0, 15, 0], [0, 0, 0]])


def test_goals_come_from_a_csv_file_beside_the_scene(tmp_path: Path) -> None:
    (tmp_path / "goals.csv").write_text("note,name,z,y,x\n,a,3,2,1\n\nx,b,6,5,4e0\n")
    found = scene(SCENE + "goals: {csv: goals.csv}\n", tmp_path)

    assert found.goal_names == ("a", "b")
    np.testing.assert_array_equal(found.goals, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "1:1: error[csv]: the first line must name the columns x,y,z; missing: "),
        ("name,x,y\n", "1:1: error[csv]: the first line must name the columns"),
        ("name,x,y,z\n", "1: error[empty]: the file holds no goals"),
        ("name,x,y,z\na,1,2\n", "2: error[csv]: this line has 3 values, the header has 4"),
        ("name,x,y,z\na,1,2,three\n", "2: error[type]: z: must be a number, not text 'three'"),
        ("name,x,y,z\na,1,,3\n", "2: error[type]: y: must be a number, not text ''"),
        ("name,x,y,z\na,.nan,2,3\n", "2: error[not-finite]: x: .nan is not a finite number"),
        ("name,x,y,z\na,1,2,nan\n", "2: error[type]: z: must be a number, not text 'nan'"),
        ("name,x,y,z\na,1,2,true\n", "2: error[type]: z: must be a number, not text 'true'"),
        ("name,x,y,z\na,1,2,3e9\n", "2: error[range]: z: must be between -1e+06 and 1e+06"),
        ("name,x,y,z\n,1,2,3\n", "2: error[name]: name: the name is empty"),
        (
            "name,x,y,z\na,1,2,3\nb,1,2,3\na,1,2,3\n",
            "4: error[name]: name: 'a' is given twice, first at line 2",
        ),
        ('name,x,y,z\n"a,1,2,3\n', "2: error[csv]: unexpected end of data"),
    ],
)
def test_a_fault_in_a_csv_file_has_its_line(tmp_path: Path, text: str, expected: str) -> None:
    file = tmp_path / "goals.csv"
    file.write_text(text)

    assert faults(SCENE + "goals: {csv: goals.csv}\n", tmp_path)[0].startswith(f"{file}:{expected}")


def test_a_csv_file_that_is_not_utf_8_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "goals.csv").write_bytes(b"name,x,y,z\n\xff,1,2,3\n")

    assert "the file is not UTF-8" in faults(SCENE + "goals: {csv: goals.csv}\n", tmp_path)[0]


def test_all_faults_of_a_csv_file_come_at_once_but_at_most_twenty(tmp_path: Path) -> None:
    (tmp_path / "goals.csv").write_text(
        "name,x,y,z\n" + "".join(f"g{k},a,2,3\n" for k in range(50))
    )

    assert len(faults(SCENE + "goals: {csv: goals.csv}\n", tmp_path)) == 20


def test_faults_of_options_and_of_strategies_come_together() -> None:
    text = SCENE + "options: {smoothing: 3, bend_vector: {use: manual, angel: 2}}\n" + GOALS

    assert [line.split(": ")[2] for line in faults(text)] == [
        "options.bend_vector.angel",
        "options.smoothing",
    ]


def test_a_scene_is_read_from_standard_input(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.TextIOWrapper(io.BytesIO((SCENE + GOALS).encode()))
    monkeypatch.setattr(sys, "stdin", stream)
    found = read_scene("-")

    assert (found.name, found.document.name) == ("stdin", "<stdin>")


def test_a_missing_file_is_a_fault_with_its_name(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"none\.yaml: error\[unreadable\]: cannot read the file"):
        read_scene(tmp_path / "none.yaml")


FREE = """\
limbik: 1
chain:
  joints: [{name: a}, {name: b, offset: [0, 0, 30]}, {name: c, offset: [0, 0, 26]}]
"""
PATH = "goals:\n" + "".join(f"  - {{position: [{9 * k}, {20 - 9 * k}, 30]}}\n" for k in range(4))


def test_solving_with_a_trace_gives_the_same_poses() -> None:
    for follow in ("", "follow: true\n"):
        found = scene(FREE + follow + PATH)
        plain, traced = solve_scene(found, REGISTRY), solve_scene(found, REGISTRY, trace=True)
        for one, other in zip(plain, traced, strict=True):
            np.testing.assert_allclose(one.angles, other.angles, rtol=0.0, atol=1e-9)
            assert (one.status, one.iterations) == (other.status, other.iterations)
            assert other.trace is not None


def test_a_followed_path_starts_each_goal_from_the_pose_before() -> None:
    """With aim_from previous the aim pose depends on the past; without follow it cannot."""
    text = FREE + "options: {aim_from: previous}\n"
    free, followed = (solve_scene(scene(text + f + PATH), REGISTRY) for f in ("", "follow: true\n"))

    np.testing.assert_array_equal(free[0].angles, followed[0].angles)
    assert np.abs(free[-1].angles - followed[-1].angles).max() > 1e-6


def test_fk_offsets_of_a_scene_reach_the_solver() -> None:
    """With IK off the pose is the rest pose plus the offsets, nothing else."""
    found = scene(FREE + "options: {ik: false}\nfk: {b: [5, 25, 0]}\n" + GOALS)
    solution = solve_scene(found, REGISTRY)[0]

    np.testing.assert_allclose(
        np.degrees(solution.angles), [[0, 0, 0], [5, 25, 0], [0, 0, 0]], atol=1e-9
    )


def test_with_ik_off_no_goal_counts_as_missed() -> None:
    off = scene(SCENE + "options: {ik: false}\n" + GOALS)
    on = scene(SCENE + "options: {max_iterations: -2}\n" + GOALS)

    assert are_met(off, solve_scene(off, REGISTRY))
    assert not are_met(on, solve_scene(on, REGISTRY))


@given(st.binary(max_size=200), st.integers(0, len(SCENE + GOALS) - 1), st.integers(0, 40))
@example(b": ", 9, 0)
def test_a_mutated_scene_is_read_or_refused_with_places(junk: bytes, at: int, dropped: int) -> None:
    """Whatever stands in a file, there is a scene or a SceneError whose faults have lines."""
    text = (SCENE + GOALS).encode()
    mutated = text[:at] + junk + text[at + dropped :]
    faults_found: tuple[Fault, ...] = ()
    goals = np.zeros(3)
    try:
        goals = scene_from(read_yaml(mutated, "scene.yaml"), Path("/nowhere"), REGISTRY).goals
    except SceneError as error:
        faults_found = error.faults

    assert all(fault.line >= 1 and fault.column >= 1 for fault in faults_found)
    assert np.isfinite(goals).all()
