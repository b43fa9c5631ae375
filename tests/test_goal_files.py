"""Goals with an orientation from CSV and NPZ files, for one chain and for several."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_body, bake_scene
from limbik.core.bodyscene import BodyScene, body_from
from limbik.core.errors import SceneError
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import Scene, scene_from
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml
from limbik.plugins.formats.tables import write_csv, write_npz

REGISTRY = Registry(third_party=False)
CONFIGS = Path(__file__).parents[1] / "configs"
ARM = f"""\
limbik: 1
chain:
  urdf: {CONFIGS / "arm7.urdf"}
  base: pedestal
  end: flange
  rest: {{shoulder_pitch: 30, elbow: 60, wrist_pitch: 60}}
solver: refine
"""
LISTED = """\
goals:
- {name: down, position: [0.5, 0.1, 0.1], rotation: [0, 180, 0]}
- {name: side, position: [0.1, 0.5, 0.6], rotation: [0, -90, 0]}
- {name: anyhow, position: [0.3, 0.8, -0.3]}
"""
IN_DEGREES = """\
name,x,y,z,heading,pitch,bank,note
down,0.5,0.1,0.1,0,180,0,wet
side,0.1,0.5,0.6,0,-90,0,
anyhow,0.3,0.8,-0.3,,,,dry
"""
IN_QUATERNIONS = """\
qw,qx,qy,qz,name,x,y,z
0,1,0,0,down,0.5,0.1,0.1
0.70710678,0.70710678,0,0,side,0.1,0.5,0.6
,,,,anyhow,0.3,0.8,-0.3
"""
PLACES = np.array([[0.5, 0.1, 0.1], [0.1, 0.5, 0.6], [0.3, 0.8, -0.3]])
LACKING = np.array([np.nan] * 3)
HPB = np.array([[0.0, 180.0, 0.0], [0.0, -90.0, 0.0], LACKING])
QUATERNIONS = np.array([[0.0, 1.0, 0.0, 0.0], [0.5**0.5, 0.5**0.5, 0.0, 0.0], [np.nan] * 4])


def scene_of(text: str, folder: Path) -> Scene:
    return scene_from(read_yaml(text, "scene.yaml"), folder, REGISTRY)


def same_turns(scene: Scene, turns: Array | None) -> None:
    """HPB has several forms of one rotation, so matrices are compared."""
    assert scene.goal_turns is not None
    assert turns is not None
    np.testing.assert_allclose(hpb_to_matrix(scene.goal_turns), hpb_to_matrix(turns), atol=1e-8)


@pytest.mark.parametrize("table", [IN_DEGREES, IN_QUATERNIONS])
def test_a_table_gives_the_poses_a_list_gives(tmp_path: Path, table: str) -> None:
    (tmp_path / "g.csv").write_text(table)
    listed = scene_of(ARM + LISTED, tmp_path)
    scene = scene_of(ARM + "goals: {csv: g.csv}\n", tmp_path)
    assert scene.goal_names == listed.goal_names
    np.testing.assert_array_equal(scene.goals, listed.goals)
    same_turns(scene, listed.goal_turns)
    for found, expected in zip(
        solve_scene(scene, REGISTRY), solve_scene(listed, REGISTRY), strict=True
    ):
        assert found.reached
        np.testing.assert_allclose(found.rotations[-1], expected.rotations[-1], atol=1e-5)


@pytest.mark.parametrize("turns", [{"hpb": HPB}, {"quaternions": QUATERNIONS}])
@pytest.mark.parametrize("key", ["", "/"])
def test_arrays_give_the_poses_a_list_gives(
    tmp_path: Path, turns: dict[str, Array], key: str
) -> None:
    prefix = "left arm/" if key else ""
    arrays = {prefix + name: array for name, array in {"goals": PLACES, **turns}.items()}
    np.savez(tmp_path / "g.npz", **arrays)  # type: ignore[arg-type]
    asked = f", array: {prefix}goals" if key else ""
    scene = scene_of(ARM + f"goals: {{npz: g.npz{asked}}}\n", tmp_path)
    same_turns(scene, scene_of(ARM + LISTED, tmp_path).goal_turns)


def test_what_nothing_turns_by_is_passed_over(tmp_path: Path) -> None:
    (tmp_path / "g.csv").write_text(IN_DEGREES)
    np.savez(tmp_path / "g.npz", goals=PLACES, hpb=HPB)
    for goals in ("csv: g.csv", "npz: g.npz"):
        scene = scene_of(ARM.replace("solver: refine\n", "") + f"goals: {{{goals}}}\n", tmp_path)
        assert scene.goal_turns is None


def test_a_file_without_a_single_orientation_has_none(tmp_path: Path) -> None:
    (tmp_path / "g.csv").write_text("x,y,z,heading,pitch,bank\n0.5,0.1,0.1,,,\n")
    np.savez(tmp_path / "g.npz", goals=PLACES, hpb=np.full((3, 3), np.nan))
    for goals in ("csv: g.csv", "npz: g.npz"):
        assert scene_of(ARM + f"goals: {{{goals}}}\n", tmp_path).goal_turns is None
        text = ARM.replace("solver: refine", "options: {end_orientation: 1}")
        with pytest.raises(SceneError, match="no goal has a rotation"):
            scene_of(text + f"goals: {{{goals}}}\n", tmp_path)


def test_goals_without_names_are_numbered(tmp_path: Path) -> None:
    (tmp_path / "g.csv").write_text("x,y,z\n1,2,3\n4,5,6\n")
    assert scene_of(ARM + "goals: {csv: g.csv}\n", tmp_path).goal_names == ("1", "2")


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_baked_motion_is_a_file_of_the_same_poses(
    tmp_path: Path, ending: str, mirrored: bool
) -> None:
    first = scene_of(ARM + LISTED, tmp_path)
    bake = bake_scene(first, REGISTRY, mirrored=mirrored)
    content = write_csv(bake).encode() if ending == "csv" else write_npz(bake)
    (tmp_path / f"motion.{ending}").write_bytes(content)
    again = scene_of(ARM + f"goals: {{{ending}: motion.{ending}}}\n", tmp_path)
    assert again.goal_names == first.goal_names
    np.testing.assert_array_equal(again.goals, bake.solution.goal)
    same_turns(again, bake.goal_turns)
    assert not mirrored or again.goals[0, 0] == -first.goals[0, 0]


def test_a_trajectorys_table_is_a_path_of_poses(tmp_path: Path) -> None:
    pytest.importorskip("scipy")
    from limbik.core.scene import read_scene
    from limbik.core.solving import scene_solver
    from limbik.plugins.output.trajectory_files import motion_arrays, motion_rows
    from limbik.plugins.paths.scene_program import scene_trajectory
    from limbik.trajectory import joint_motion

    weld = read_scene(CONFIGS / "weld.yaml", REGISTRY)
    samples = scene_trajectory(weld).sample(0.1)
    motion = joint_motion(samples, scene_solver(weld, REGISTRY))
    (tmp_path / "weld.csv").write_text(motion_rows(motion))
    (tmp_path / "weld.npz").write_bytes(motion_arrays(motion))
    for goals in ("csv: weld.csv", "npz: weld.npz"):
        scene = scene_of(f"{ARM}follow: true\ngoals: {{{goals}}}\n", tmp_path)
        assert scene.goal_turns is not None
        np.testing.assert_allclose(scene.goals, samples.positions, rtol=1e-14)
        turned = hpb_to_matrix(scene.goal_turns)
        np.testing.assert_allclose(turned, samples.rotations, atol=1e-12)


@pytest.mark.parametrize("goals", ["csv: g.csv", "npz: g.npz"])
def test_orientations_of_files_are_in_limbiks_axes(tmp_path: Path, goals: str) -> None:
    (tmp_path / "g.csv").write_text(IN_DEGREES)
    np.savez(tmp_path / "g.npz", goals=PLACES, hpb=HPB)
    text = f"axes: z-up\ngoals: {{{goals}}}\n"
    with pytest.raises(SceneError, match=r"scene.yaml:9:14: .* an orientation is in limbik's axes"):
        scene_of(ARM + text, tmp_path)
    assert scene_of(ARM.replace("solver: refine\n", "") + text, tmp_path).goal_turns is None


BODY = f"""\
limbik: 1
skeleton: {{urdf: {CONFIGS / "humanoid.urdf"}}}
chains:
- {{name: neck, base: chest, end: head, options: {{off_axis: true}}, goals: [HEAD]}}
- {{name: left arm, base: chest, end: left_hand, options: {{off_axis: true, end_orientation: 1}},
   goals: ARM}}
"""
ARM_GOALS = """[{position: [0.3, 0.4, 0.2], rotation: [10, 20, 30]}, {position: [0.3, 0.3, 0.3]},
  {position: [0.3, 0.4, 0.3], rotation: [-10, 20, 0]}]"""


def body_of(arm: str, folder: Path) -> BodyScene:
    head = "{position: [0.1, 0.7, 0]}"
    text = BODY.replace("HEAD", head).replace("ARM", arm)
    return body_from(read_yaml(text, "body.yaml"), folder, REGISTRY)


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_baked_body_holds_the_goals_of_each_chain(tmp_path: Path, ending: str) -> None:
    from limbik.plugins.formats.bodytables import write_body_csv, write_body_npz

    bake = bake_body(body_of(ARM_GOALS, tmp_path), REGISTRY)
    content = write_body_csv(bake).encode() if ending == "csv" else write_body_npz(bake)
    (tmp_path / f"body.{ending}").write_bytes(content)
    again = body_of(f"{{{ending}: body.{ending}}}", tmp_path)
    arm, first = again.parts[1].scene, bake.scene.parts[1].scene
    np.testing.assert_array_equal(arm.goals, first.goals)
    same_turns(arm, first.goal_turns)
    assert again.frame_names == bake.scene.frame_names
