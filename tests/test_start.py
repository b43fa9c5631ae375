"""`start: current` goes on from the pose before; `bend` forgets it."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solution import Continuity
from limbik.core.solver import Solver

Array = NDArray[np.float64]
REGISTRY = Registry(third_party=False)
GOAL = np.array([0.25, 0.35, 0.45])


def spine(**limits: Any) -> Chain:
    joints = [Joint.degrees(f"j{k}", (0, 0, 0.2 if k else 0), **limits) for k in range(6)]
    return Chain(joints)


def solver(start: str, chain: Chain | None = None, **options: Any) -> Solver:
    given: dict[str, Any] = {"tolerance": 1e-4, "max_iterations": 200, "smoothing": 1.0}
    made = spine() if chain is None else chain
    return Solver(made, registry=REGISTRY, start=start, **(given | options))


def way(first: list[float]) -> Array:
    """A path from a place to the goal."""
    return np.linspace(first, GOAL, 30)


def turn(first: Array, second: Array) -> float:
    apart = np.linalg.norm(hpb_to_matrix(first) - hpb_to_matrix(second), axis=(-2, -1))
    return float(np.degrees(2 * np.arcsin(np.clip(apart / np.sqrt(8.0), 0.0, 1.0))).max())


def test_a_goal_that_is_reached_already_moves_nothing() -> None:
    bent = np.radians(np.random.default_rng(2).uniform(-40, 40, (6, 3)))
    fixed = Solver(spine(), registry=REGISTRY, ik=False).solve(GOAL, fk_offsets=bent)
    goal, before = fixed.positions[-1], Continuity.from_pose(bent)

    went_on = solver("current").solve(goal, continuity=before)
    began_anew = solver("bend").solve(goal, continuity=before)

    assert went_on.iterations == 0
    assert turn(went_on.angles[:-1], bent[:-1]) < 1e-6
    assert turn(began_anew.angles[:-1], bent[:-1]) > 5.0


def test_two_ways_to_one_goal_end_in_two_poses_only_when_going_on() -> None:
    ends = {
        start: [
            solver(start).follow(way(first)).angles[-1] for first in ([0.8, 0, 0.1], [0, -0.7, 0])
        ]
        for start in ("current", "bend")
    }
    assert turn(*ends["bend"]) < 1e-9
    assert turn(*ends["current"]) > 5.0


def test_without_a_pose_before_both_starts_are_the_same() -> None:
    poses = [solver(start).solve(GOAL).angles for start in ("current", "bend")]
    np.testing.assert_array_equal(poses[0], poses[1])


def test_the_bend_pose_itself_is_still_given_at_0_rounds() -> None:
    before = Continuity.from_pose(np.full((6, 3), 0.3))
    poses = [
        solver(start, max_iterations=0).solve(GOAL, continuity=before).angles
        for start in ("current", "bend")
    ]
    np.testing.assert_array_equal(poses[0], poses[1])


@pytest.mark.parametrize("finish", ["none", "newton"])
def test_a_pose_before_that_breaks_limits_is_pulled_into_them(finish: str) -> None:
    chain = spine(heading=(-30, 30), pitch=(-30, 30), bank=(-10, 10))
    before = Continuity.from_pose(np.full((6, 3), 1.0))
    solution = solver("current", chain, finish=finish).solve((0.1, 0.2, 0.9), continuity=before)
    assert (solution.angles <= chain.high + 1e-9).all()
    assert (solution.angles >= chain.low - 1e-9).all()
