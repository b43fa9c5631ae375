"""Pose goals in scenes: every way to give an orientation, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_scene
from limbik.core.body import solve_body
from limbik.core.bodyscene import body_from
from limbik.core.errors import SceneError
from limbik.core.posegoals import PoseSolution
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix
from limbik.core.scene import Scene, read_scene, scene_from
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml
from limbik.tests.limbs import POSE_ARM

CONFIGS = Path(__file__).parents[1] / "configs"
REGISTRY = Registry(third_party=False)
HEAD = (
    POSE_ARM
    + """\
options: {tolerance: 0.000001}
"""
)
POSE = "position: [0.5, 3, 4]"
TURN = hpb_to_matrix(np.radians([10.0, 20.0, -30.0]))


def scene(text: str) -> Scene:
    return scene_from(read_yaml(text, "s.yaml"), Path("/nowhere"), REGISTRY)


def first(goal: str) -> PoseSolution:
    found = solve_scene(scene(f"{HEAD}goals:\n  - {goal}\n"), REGISTRY)[0]
    assert isinstance(found, PoseSolution)
    return found


def faults(text: str) -> list[str]:
    with pytest.raises(SceneError) as caught:
        scene(text)
    return str(caught.value).splitlines()


def matrix_text() -> str:
    rows = [[*TURN[k].tolist(), (0.5, 3.0, 4.0)[k]] for k in range(3)]
    return f"{{matrix: {[*rows, [0.0, 0.0, 0.0, 1.0]]}}}"


def quaternion_text() -> str:
    w = 0.5 * np.sqrt(1.0 + np.trace(TURN))
    x, y, z = (TURN[2, 1] - TURN[1, 2], TURN[0, 2] - TURN[2, 0], TURN[1, 0] - TURN[0, 1])
    return f"{{{POSE}, quaternion: {[float(v) for v in (w, x / 4 / w, y / 4 / w, z / 4 / w)]}}}"


@pytest.mark.parametrize(
    "goal", [f"{{{POSE}, rotation: [10, 20, -30]}}", quaternion_text(), matrix_text()]
)
def test_an_orientation_may_be_given_in_three_ways(goal: str) -> None:
    found = first(goal)

    assert found.reached
    assert found.rotation_error < np.radians(0.01)
    np.testing.assert_allclose(found.goal, [0.5, 3.0, 4.0])
    np.testing.assert_allclose(found.rotations[-1], TURN, atol=1e-6)


def test_a_goal_without_an_orientation_is_a_position_beside_others() -> None:
    text = f"{HEAD}goals:\n  - {{{POSE}, rotation: [10, 20, -30]}}\n  - {{{POSE}}}\n"
    posed, placed = solve_scene(scene(text), REGISTRY)

    assert posed.reached
    assert placed.reached
    assert np.abs(placed.rotations[-1] - TURN).max() > 0.1


def test_an_orientation_no_pose_has_is_not_reached_and_told() -> None:
    found = first(f"{{{POSE}, rotation: [180, 0, 0]}}")

    assert not found.reached
    assert f"turned off by {np.degrees(found.rotation_error):.3g}°" in found.remark


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        (
            f"{{{POSE}, rotation: [0, 0, 0], quaternion: [1, 0, 0, 0]}}",
            "s.yaml:11:5: error[choice]: goals[0]: one orientation, not rotation and quaternion",
        ),
        (
            f"{{{POSE}, quaternion: [1, 1, 0, 0]}}",
            "s.yaml:11:5: error[range]: goals[0]: a quaternion must have length 1, this one has",
        ),
        (
            "{matrix: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]}",
            "s.yaml:11:5: error[range]: goals[0]: the matrix's first three columns must",
        ),
        (
            "{matrix: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 5, 1]]}",
            "s.yaml:11:5: error[range]: goals[0]: the matrix's last row must be 0 0 0 1",
        ),
        (
            "{name: nowhere}",
            "s.yaml:11:5: error[choice]: goals[0]: needs a position, or a matrix that holds it",
        ),
        (
            f"{{{POSE}, matrix: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}}",
            "s.yaml:11:5: error[choice]: goals[0]: needs a position, or a matrix that holds it",
        ),
    ],
)
def test_a_wrong_orientation_is_refused_at_its_goal(goal: str, expected: str) -> None:
    (line,) = faults(f"{HEAD}goals:\n  - {goal}\n")
    assert line.startswith(expected)


@pytest.mark.parametrize("solver", ["3d", "fabrik"])
def test_a_solver_that_does_not_turn_the_end_refuses_an_orientation(solver: str) -> None:
    text = f"{HEAD}goals:\n  - {{{POSE}, rotation: [0, 0, 0]}}\n"
    (line,) = faults(text.replace("solver: refine", f"solver: {solver}"))
    assert line.startswith("s.yaml:11:39: error[solver]: goals[0].rotation: its orientation has")


def test_a_chain_with_too_few_axes_is_refused() -> None:
    text = f"{HEAD}goals:\n  - {{{POSE}}}\n".replace("bank: [-80, 80]", "bank: 0")
    (line,) = faults(text.replace("bank: [-90, 90]", "bank: 0"))
    assert "refine needs 6 axes that turn, or more; this chain has 5" in line


def test_a_mirrored_bake_mirrors_the_orientations() -> None:
    read = read_scene(CONFIGS / "arm7-pose.yaml", REGISTRY)
    plain, mirrored = (bake_scene(read, REGISTRY, mirrored=m).solution for m in (False, True))
    assert isinstance(plain, PoseSolution)
    assert isinstance(mirrored, PoseSolution)
    flip = np.diag([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(mirrored.rotations[:, -1], flip @ plain.rotations[:, -1] @ flip)
    asked = ~np.isnan(mirrored.goal_rotation[:, 0, 0])
    np.testing.assert_allclose(
        mirrored.rotations[asked, -1], mirrored.goal_rotation[asked], atol=1e-5
    )


def test_a_scene_with_a_trajectory_needs_no_goals() -> None:
    text = HEAD + "trajectory: {limits: {speed: 1}, start: a, program: []}\n"
    read = scene(text)

    assert read.goals.shape == (0, 3)
    with pytest.raises(SceneError, match=r"s\.yaml:1:1: error\[missing-key\]: the scene has no g"):
        solve_scene(read, REGISTRY)
    with pytest.raises(SceneError, match="the scene has no goals"):
        bake_scene(read, REGISTRY)
    assert "goals: key 'goals' is missing" in faults(HEAD)[0]
    assert "at least one goal is needed" in faults(text + "goals: []\n")[0]


BODY = """\
limbik: 1
skeleton:
  joints:
    - {name: hips, offset: [0, 90, 0], frozen: [0, 90, 0]}
    - {name: neck, parent: hips, offset: [0, 0, 45]}
    - {name: shoulder, parent: neck, offset: [18, 0, -5], frozen: [0, 180, 0]}
    - {name: elbow, parent: shoulder, offset: [0, 0, 30]}
    - {name: hand, parent: elbow, offset: [0, 0, 26]}
chains:
  - name: arm
    base: shoulder
    end: hand
    solver: refine
    goals: [{position: [40, 110, 20], rotation: [10, 20, -30]}]
"""


def test_a_chain_of_a_body_is_put_on_its_pose() -> None:
    read = body_from(read_yaml(BODY, "s.yaml"), Path("/nowhere"), REGISTRY)
    (found,) = solve_body(read, REGISTRY)

    assert found.solutions["arm"].reached
    np.testing.assert_allclose(found.positions[4], [40.0, 110.0, 20.0], atol=1e-2)
    np.testing.assert_allclose(found.solutions["arm"].rotations[-1], TURN, atol=1e-3)
