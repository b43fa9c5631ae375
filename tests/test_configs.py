"""The scenes limbik ships: each is sound and all its goals are reached, within limits."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.body import solve_body
from limbik.core.bodyscene import read_body
from limbik.core.pose import forward_kinematics
from limbik.core.posegoals import PoseSolution
from limbik.core.registry import Registry
from limbik.core.scene import read_scene
from limbik.core.solving import solve_scene
from limbik.plugins.output.templates import TEMPLATES

ALL = sorted((Path(__file__).parents[1] / "configs").glob("*.yaml"))
BODIES = [path for path in ALL if "\nskeleton:" in path.read_text(encoding="utf-8")]
CONFIGS = [path for path in ALL if path not in BODIES]


def test_every_template_is_a_shipped_scene() -> None:
    assert sorted(path.stem for path in ALL) == sorted(TEMPLATES)


@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_every_goal_is_reached_by_the_pose_itself_and_within_limits(path: Path) -> None:
    """Not the status alone: the angles, run through forward kinematics, end on the goal."""
    registry = Registry(third_party=False)
    scene = read_scene(path, registry)
    solutions = solve_scene(scene, registry)

    assert len(solutions) == 10
    for name, goal, solution in zip(scene.goal_names, scene.goals, solutions, strict=True):
        positions, rotations = forward_kinematics(scene.chain, solution.angles)
        if isinstance(solution, PoseSolution) and np.isfinite(solution.goal_rotation).all():
            assert np.abs(rotations[-1] - solution.goal_rotation).max() < 1e-6, name
        assert np.linalg.norm(positions[-1] - goal) <= scene.settings.tolerance, name
        assert (solution.angles >= scene.chain.low - 1e-9).all(), name
        assert (solution.angles <= scene.chain.high + 1e-9).all(), name


@pytest.mark.parametrize("path", BODIES, ids=lambda path: path.stem)
def test_every_chain_of_a_body_is_on_its_goal_in_every_frame(path: Path) -> None:
    """The angles of all chains together, put into the skeleton, end on the goals."""
    registry = Registry(third_party=False)
    scene = read_body(path, registry)
    found = solve_body(scene, registry)

    assert {len(part.scene.goals) for part in scene.parts} == {len(found)}
    for part in scene.parts:
        for row, body in enumerate(found):
            solution = body.solutions[part.name]
            goal = part.scene.goals[row]
            if part.frame >= 0:
                goal = body.positions[part.frame] + body.rotations[part.frame] @ goal
            gap = np.linalg.norm(body.positions[part.limb.at[-1]] - goal)
            assert gap <= part.scene.settings.tolerance, (part.name, scene.frame_names[row])
            assert (solution.angles >= part.scene.chain.low - 1e-9).all(), part.name
            assert (solution.angles <= part.scene.chain.high + 1e-9).all(), part.name


def test_the_zero_poses_are_the_ones_the_comments_describe() -> None:
    """The arm and the leg hang below their root, the foot points forward, the spine stands."""
    ends = {}
    for path in CONFIGS:
        chain = read_scene(path).chain
        positions, _ = forward_kinematics(chain, np.zeros((len(chain), 3)))
        ends[path.stem] = positions[-1]

    np.testing.assert_allclose(ends["arm"], [18.0, 143.0 - 67.5, 0.0], atol=1e-9)
    np.testing.assert_allclose(ends["leg"], [9.0, 93.0 - 86.0, 13.0], atol=1e-9)
    np.testing.assert_allclose(ends["leg-pole"], [9.0, 93.0 - 86.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(ends["finger"], [0.0, 0.0, 91.0], atol=1e-9)
    np.testing.assert_allclose(ends["spine"], [0.0, 156.6, -0.9], atol=0.1)


@pytest.mark.parametrize(
    ("scene", "joint", "angles", "moves_toward"),
    [
        ("arm", "shoulder", (90, 0, 0), (0, 0, 1)),  # flexion: forward
        ("arm", "shoulder", (0, 90, 0), (1, 0, 0)),  # abduction: out to the right
        ("arm", "elbow", (0, 90, 0), (0, 0, 1)),  # flexion: forward
        ("arm", "wrist", (90, 0, 0), (-1, 0, 0)),  # flexion: toward the palm, inward
        ("arm", "wrist", (0, 90, 0), (0, 0, 1)),  # radial deviation: toward the thumb
        ("leg", "hip", (90, 0, 0), (0, 0, 1)),
        ("leg", "hip", (0, 90, 0), (1, 0, 0)),
        ("leg", "knee", (0, -90, 0), (0, 0, -1)),  # flexion: backward
        ("leg", "ankle", (0, 90, 0), (0, 1, 0)),  # dorsiflexion: up
        ("leg-pole", "hip", (0, 90, 0), (0, 0, 1)),  # forward
        ("leg-pole", "knee", (0, -90, 0), (0, 0, -1)),  # flexion: backward
        ("finger", "middle", (0, -90, 0), (0, -1, 0)),  # flexion: down
        ("spine", "L5", (60, 0, 0), (-1, 0, 0)),  # to the left
        ("spine", "L5", (0, 60, 0), (0, 0, -1)),  # backward
    ],
)
def test_an_angle_turns_the_way_the_comments_say(
    scene: str, joint: str, angles: tuple[float, ...], moves_toward: tuple[float, ...]
) -> None:
    path = next(path for path in CONFIGS if path.stem == scene)
    chain = read_scene(path).chain
    turned = np.zeros((len(chain), 3))
    turned[chain.names.index(joint)] = np.radians(angles)
    (zero, _), (moved, _) = (forward_kinematics(chain, a) for a in (turned * 0.0, turned))

    way = moved[-1] - zero[-1]
    assert abs(way @ moves_toward) >= 0.5 * np.linalg.norm(way)
    assert way @ moves_toward > 0.0


@pytest.mark.parametrize("rotation", [("shoulder", 90.0, 1.0), ("shoulder", -70.0, -1.0)])
def test_external_rotation_turns_a_bent_forearm_outward(
    rotation: tuple[str, float, float],
) -> None:
    chain = read_scene(next(path for path in CONFIGS if path.stem == "arm")).chain
    angles = np.zeros((len(chain), 3))
    angles[1, 1] = np.radians(90.0)
    angles[0, 2] = np.radians(rotation[1])
    positions, _ = forward_kinematics(chain, angles)

    assert np.sign(positions[-1, 0] - positions[1, 0]) == rotation[2]
