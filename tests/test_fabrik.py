"""FABRIK in three dimensions: the joints' own limits hold, and reachable goals are reached."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.scene import read_scene
from limbik.core.solution import Solution, Status
from limbik.core.whole import prepare

CONFIGS = Path(__file__).parents[1] / "configs"
REGISTRY = Registry(third_party=False)


def solved(name: str, goals: object, follow: bool = False, rounds: int = 500) -> Solution:
    scene = read_scene(CONFIGS / f"{name}.yaml", REGISTRY)
    bound = REGISTRY.bind("solver", {"use": "fabrik", "rounds": rounds})
    return prepare(bound, scene.chain, scene.settings)(np.array(goals, np.float64), follow)


@pytest.mark.parametrize("name", ["arm", "leg"])
def test_nearly_all_goals_from_forward_kinematics_are_reached_within_limits(name: str) -> None:
    """A search, not a proof: at most one goal in 200 is left, and then the status says so."""
    chain = read_scene(CONFIGS / f"{name}.yaml", REGISTRY).chain
    low, high = np.maximum(chain.low, -np.pi), np.minimum(chain.high, np.pi)
    poses = np.random.default_rng(5).uniform(low, high, (500, len(chain), 3))
    goals = forward_kinematics(chain, poses)[0][:, -1]
    found = solved(name, goals)

    positions, _ = forward_kinematics(chain, found.angles)
    met = np.linalg.norm(positions[:, -1] - goals, axis=1) <= 0.01
    np.testing.assert_array_equal(found.reached, met)
    assert met.mean() >= 0.995
    assert (found.angles >= chain.low).all()
    assert (found.angles <= chain.high).all()


def test_every_goal_of_the_spine_s_scene_is_reached() -> None:
    scene = read_scene(CONFIGS / "spine.yaml", REGISTRY)
    assert np.asarray(solved("spine", scene.goals).reached).all()


def test_a_goal_beyond_the_bones_is_out_of_reach_and_one_limits_forbid_is_not_reached() -> None:
    found = solved("leg", [[9.0, 93.0, 500.0], [9.0, 93.0, -95.0]])
    assert np.asarray(found.status).tolist() == [Status.OUT_OF_REACH, Status.STOPPED]


def test_a_followed_goal_starts_from_the_pose_before() -> None:
    """The same goal again costs no round."""
    goal = [9.0, 20.0, 40.0]
    assert np.asarray(solved("leg", [goal, goal], follow=True).iterations)[1] == 0
    assert np.asarray(solved("leg", [goal, goal]).iterations)[1] > 0


def test_rounds_bound_the_search_from_each_start() -> None:
    found = solved("leg", [[9.0, 93.0, -95.0]], rounds=1)
    assert int(np.asarray(found.iterations)[0]) <= 24
