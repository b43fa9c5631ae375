"""A finish reaches what can be reached, keeps the limits, and tells the truth otherwise."""

import numpy as np
import pytest

from limbik.core.pose import forward_kinematics
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.tests.kinds import CHAINS, ball, leg
from limbik.tests.limbs import arm, reachable


@pytest.mark.parametrize("name", CHAINS)
def test_every_reachable_goal_is_reached_within_limits(name: str) -> None:
    """JUDGING: at least 99.9 % of 1,000 goals at 1e-4 of the length; here 100 %."""
    chain = CHAINS[name]
    tolerance = 1e-4 * chain.length
    solution = Solver(chain, tolerance=tolerance).solve_many(reachable(chain, 1000, 3))

    assert np.count_nonzero(solution.status == Status.REACHED) == 1000
    assert (solution.angles >= chain.low - 1e-9).all()
    assert (solution.angles <= chain.high + 1e-9).all()
    positions, _ = forward_kinematics(chain, solution.angles)
    ends = np.linalg.norm(positions[:, -1] - solution.goal, axis=1)
    assert ends.max() < tolerance


@pytest.mark.parametrize("extension", [0.97, 0.98, 0.99, 0.995, 0.999])
def test_a_nearly_straight_limb_lands_on_its_goal(extension: float) -> None:
    """Where CCD converges slowest: the bare document reaches none of these in 20 rounds."""
    chain = ball(4)
    directions = np.random.default_rng(1).normal(size=(200, 3))
    goals = directions / np.linalg.norm(directions, axis=1, keepdims=True) * 3.0 * extension
    solution = Solver(chain, tolerance=1e-6).solve_many(goals)

    assert (np.asarray(solution.status) == Status.REACHED).all()


def test_the_precision_asked_for_is_kept() -> None:
    chain = arm()
    solution = Solver(chain).solve_many(reachable(chain, 300, 7))
    coarse = Solver(chain, finish={"use": "newton", "precision": 1e-4}).solve_many(solution.goal)

    assert np.max(solution.distance) <= 1e-9 * chain.length
    assert np.max(coarse.distance) > 1e-9 * chain.length


def test_without_a_finish_the_pose_is_that_of_the_last_round() -> None:
    chain, goal = leg(), [12.0, -80.0, 20.0]
    bare = Solver(chain, finish="none").solve(goal, trace=True)
    ended = Solver(chain).solve(goal, trace=True)
    assert bare.trace is not None
    assert ended.trace is not None

    np.testing.assert_array_equal(bare.angles, bare.trace[-1].angles)
    assert ended.trace[-1].name == "finish"
    np.testing.assert_allclose(ended.trace[-2].angles, bare.angles, atol=1e-12)


def test_held_joints_stay_while_the_finish_works() -> None:
    chain = ball(5)
    solver = Solver(chain, held={"base": 1, "end": 1, "bend_base": True, "bend_end": True})
    bare = Solver(
        chain, finish="none", held={"base": 1, "end": 1, "bend_base": True, "bend_end": True}
    )
    goal = [1.0, 1.5, 2.0]

    np.testing.assert_allclose(
        solver.solve(goal).angles[[0, 3]], bare.solve(goal).angles[[0, 3]], atol=1e-9
    )


def test_a_goal_out_of_reach_leaves_the_chain_straight_toward_it() -> None:
    """M2: at most 0.1 % of the length beyond the best possible."""
    chain = ball(4)
    directions = np.random.default_rng(2).normal(size=(100, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    solution = Solver(chain).solve_many(directions * 3.3)

    assert (np.asarray(solution.status) == Status.OUT_OF_REACH).all()
    assert np.max(solution.distance - 0.3) <= 1e-3 * chain.length


def test_rounds_that_run_out_prove_nothing() -> None:
    solution = Solver(leg(), finish="none", max_iterations=1).solve([12.0, -80.0, 20.0])

    assert solution.status == Status.STOPPED
