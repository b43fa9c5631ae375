"""Goals from NPZ files, and goals in other programs' axes."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_scene
from limbik.core.bodyscene import body_from
from limbik.core.errors import SceneError
from limbik.core.frames import Y_UP, Z_UP
from limbik.core.registry import Registry
from limbik.core.scene import Scene, scene_from
from limbik.core.yamlfile import read_yaml
from limbik.plugins.formats.tables import write_npz

REGISTRY = Registry(third_party=False)
CHAIN = "limbik: 1\nchain: {joints: [{name: a}, {name: b, offset: [0, 0, 9]}]}\n"


def scene_of(text: str, folder: Path = Path()) -> Scene:
    return scene_from(read_yaml(CHAIN + text, "scene.yaml"), folder, REGISTRY)


@pytest.mark.parametrize(("array", "key"), [("goals", ""), ("positions", ""), ("way", "way")])
def test_goals_come_out_of_an_array(tmp_path: Path, array: str, key: str) -> None:
    places = np.arange(12.0).reshape(4, 3)
    np.savez(tmp_path / "g.npz", **{array: places})  # type: ignore[arg-type]
    asked = f", array: {key}" if key else ""
    scene = scene_of(f"goals: {{npz: g.npz{asked}}}\n", tmp_path)
    np.testing.assert_array_equal(scene.goals, places)
    assert scene.goal_names == ("1", "2", "3", "4")


def test_a_baked_file_is_a_goal_file_again(tmp_path: Path) -> None:
    first = scene_of("goals: [{name: up, position: [0, 1, 8]}, {name: down, position: [0, -1, 8]}]")
    (tmp_path / "motion.npz").write_bytes(write_npz(bake_scene(first, REGISTRY)))
    again = scene_of("goals: {npz: motion.npz}\n", tmp_path)
    assert again.goal_names == first.goal_names
    np.testing.assert_array_equal(again.goals, first.goals)


def test_a_trajectory_is_a_path_of_goals(tmp_path: Path) -> None:
    pytest.importorskip("scipy")
    from limbik.core.scene import read_scene
    from limbik.core.solving import scene_solver
    from limbik.plugins.output.trajectory_files import motion_arrays
    from limbik.plugins.paths.scene_program import scene_trajectory
    from limbik.trajectory import joint_motion

    weld = read_scene(Path(__file__).parents[1] / "configs" / "weld.yaml", REGISTRY)
    samples = scene_trajectory(weld).sample(0.1)
    motion = joint_motion(samples, scene_solver(weld, REGISTRY))
    (tmp_path / "weld.npz").write_bytes(motion_arrays(motion))
    scene = scene_of("follow: true\ngoals: {npz: weld.npz}\n", tmp_path)
    np.testing.assert_array_equal(scene.goals, samples.positions)


@pytest.mark.parametrize(("name", "axes"), [("y-up", Y_UP), ("z-up", Z_UP)])
def test_positions_in_other_axes_are_turned_by_frames_alone(
    tmp_path: Path, name: str, axes: object
) -> None:
    given = [[1.0, 2.0, 3.0], [4.0, -5.0, 6.0]]
    (tmp_path / "g.csv").write_text("name,x,y,z\na,1,2,3\nb,4,-5,6\n")
    np.savez(tmp_path / "g.npz", goals=np.array(given))
    expected = (Y_UP if axes is Y_UP else Z_UP).points(given)
    for goals in (
        "[{position: [1, 2, 3]}, {position: [4, -5, 6]}]",
        "{csv: g.csv}",
        "{npz: g.npz}",
    ):
        scene = scene_of(f"axes: {name}\ngoals: {goals}\n", tmp_path)
        np.testing.assert_array_equal(scene.goals, expected)


def test_a_pole_is_in_the_same_axes() -> None:
    scene = scene_of(
        "axes: z-up\nsolver: 2d\npole: {position: [1, 2, 30]}\ngoals: [{position: [1, 2, 3]}]\n"
    )
    assert scene.pole is not None
    assert scene.pole.position == (1.0, 30.0, 2.0)


def test_limbiks_own_axes_change_nothing() -> None:
    goals = "goals: [{position: [1, 2, 3]}]\n"
    assert (scene_of("axes: limbik\n" + goals).goals == scene_of(goals).goals).all()


def test_a_trajectory_refuses_other_axes() -> None:
    text = "trajectory: {limits: {speed: 1}, points: {a: {position: [0, 0, 1]}}, start: a, "
    text += "program: [{line: {to: a}}]}\naxes: z-up\ngoals: [{position: [1, 2, 3]}]\n"
    with pytest.raises(SceneError, match="a trajectory is in limbik's axes"):
        scene_of(text)


def test_the_scene_of_the_page_on_bodies_is_solved() -> None:
    page = (Path(__file__).parents[1] / "docs" / "bodies.md").read_text(encoding="utf-8")
    text = page.split("```yaml\n")[1].split("```")[0]
    from limbik.core.body import solve_body

    (found,) = solve_body(body_from(read_yaml(text, "page.yaml"), Path(), REGISTRY), REGISTRY)
    assert found.reached
