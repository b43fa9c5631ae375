"""A finish reaches what can be reached, keeps the limits, and tells the truth otherwise."""

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.solution import Status
from limbik.core.solver import Solver

FIXED = (0.0, 0.0)


def ball(joints: int) -> Chain:
    return Chain([Joint(f"j{i}", (0, 0, 1.0 if i else 0.0)) for i in range(joints)])


def arm() -> Chain:
    return Chain(
        [
            Joint.degrees("shoulder", heading=(-130, 60), pitch=(-85, 85), bank=(-90, 90)),
            Joint.degrees("elbow", (0, 0, 30), heading=FIXED, pitch=(0, 145), bank=(-80, 80)),
            Joint.degrees("wrist", (0, 0, 26), heading=(-30, 30), pitch=(-70, 70), bank=FIXED),
            Joint.degrees("hand", (0, 0, 18), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def leg() -> Chain:
    turned = (0, -90, 0)
    return Chain(
        [
            Joint.degrees("hip", (10, 0, 0), turned, (0, 0, 0), (-40, 40), (-30, 110), (-45, 45)),
            Joint.degrees("knee", (0, 0, 42), heading=FIXED, pitch=(-145, 0), bank=FIXED),
            Joint.degrees("ankle", (0, 0, 40), heading=FIXED, pitch=(-40, 50), bank=(-20, 20)),
            Joint.degrees("toe", (0, 0, 16), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def six_hinges() -> Chain:
    def roll(name: str, along: float, most: float) -> Joint:
        return Joint.degrees(name, (0, 0, along), heading=FIXED, pitch=FIXED, bank=(-most, most))

    def bend(name: str, along: float, low: float, high: float) -> Joint:
        return Joint.degrees(name, (0, 0, along), heading=FIXED, pitch=(low, high), bank=FIXED)

    return Chain(
        [
            roll("base", 0, 170),
            bend("shoulder", 40, -90, 110),
            bend("elbow", 45, -150, 60),
            roll("forearm", 20, 180),
            bend("wrist", 22, -115, 115),
            roll("flange", 8, 180),
            Joint.degrees("tool", (0, 5, 8), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def spine(joints: int) -> Chain:
    bent = (-25, 25)
    return Chain(
        [
            Joint.degrees(f"v{i}", (0, 0, float(i > 0)), heading=bent, pitch=bent, bank=bent)
            for i in range(joints)
        ]
    )


def planar(links: int, low: float, high: float) -> Chain:
    joints = [
        Joint.degrees(f"j{i}", (0, 0, float(i > 0)), heading=FIXED, pitch=(low, high), bank=FIXED)
        for i in range(links)
    ]
    end = Joint.degrees("end", (0, 0, 1), heading=FIXED, pitch=FIXED, bank=FIXED)
    return Chain([*joints, end])


CHAINS = {
    "ball3": ball(3),
    "ball4": ball(4),
    "ball7": ball(7),
    "ball28": ball(28),
    "arm": arm(),
    "leg": leg(),
    "six hinges": six_hinges(),
    "spine8": spine(8),
    "spine24": spine(24),
    "planar3": planar(3, 0, 120),
    "planar4": planar(4, 10, 100),
}


def reachable(chain: Chain, count: int, seed: int) -> Array:
    """Ends of random poses inside the limits, (count, 3)."""
    low = np.where(np.isfinite(chain.low), chain.low, -np.pi)
    high = np.where(np.isfinite(chain.high), chain.high, np.pi)
    random = np.random.default_rng(seed).random((count, len(chain), 3))
    positions, _ = forward_kinematics(chain, low + (high - low) * random)
    return np.ascontiguousarray(positions[:, -1])


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
