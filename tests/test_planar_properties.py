"""What holds for every 2D solve: limits, the pole's side, no jumps, the same in any order."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver2d import Solver2D

REGISTRY = Registry(third_party=False)
Numbers = np.random.Generator

number = st.floats(-90.0, 90.0)
span = st.tuples(st.floats(-170.0, 170.0), st.floats(-170.0, 170.0)).map(sorted)
place = st.tuples(number, number, number)


@st.composite
def limbs(draw: Any) -> Chain:
    """Chains of 2 to 6 joints, bent and limited at will."""
    joints = [Joint.degrees("base", frozen=draw(place), planar=draw(st.none() | span))]
    for k in range(draw(st.integers(1, 5))):
        offset = (draw(st.floats(-3, 3)), draw(st.floats(-3, 3)), draw(st.floats(5, 40)))
        limits = draw(st.none() | span)
        joints.append(Joint.degrees(f"j{k}", offset, rest=draw(place), planar=limits))
    return Chain(joints)


def measured(solution: PlanarSolution, positions: Any) -> Any:
    """Planar angles out of positions [rad], NaN beside bones seen from their ends."""
    flat = np.diff((positions - positions[0]) @ solution.plane[:, :2], axis=0)
    ways = np.where(np.hypot(*flat.T) > 1e-3, np.arctan2(flat[:, 1], flat[:, 0]), np.nan)
    turns = np.diff(ways, prepend=0.0)
    return np.arctan2(np.sin(turns), np.cos(turns))


@settings(deadline=None)
@given(limbs(), place, place, st.sampled_from(["y+", "y-", "x+", "free"]))
def test_planar_limits_hold_from_the_bend_on(limb: Chain, goal: Any, pole: Any, axis: str) -> None:
    """Measured from the joints' positions, not from what the solver says of itself."""
    solver = Solver2D(limb, registry=REGISTRY, pole=pole, reference_axis=axis)
    solution = solver.solve(goal, trace=True)
    assert solution.trace is not None
    low, high = solution.planar_limits[:, :-1]
    ends = np.array([low, high])

    assert np.isfinite(solution.angles).all()
    for stage in solution.trace[5:]:
        turns = measured(solution, stage.positions)
        outside = np.maximum(low - turns, turns - high)
        # A range that ends near 180° is met by -180° too.
        around = np.abs(np.abs(turns - ends) - 2.0 * np.pi).min(axis=0)
        assert np.nanmax(np.minimum(outside, around), initial=-1.0) <= 1e-9
    assert (solution.planar_angles[:-1] >= low - 1e-9).all()
    assert (solution.planar_angles[:-1] <= high + 1e-9).all()


@settings(deadline=None)
@given(limbs(), place, place)
def test_bones_keep_their_lengths_and_the_distance_is_true(
    limb: Chain, goal: Any, pole: Any
) -> None:
    solution = Solver2D(limb, registry=REGISTRY, pole=pole).solve(goal)

    bones = np.linalg.norm(np.diff(solution.positions, axis=0), axis=1)
    np.testing.assert_allclose(bones, limb.lengths, rtol=1e-12)
    assert solution.distance == pytest.approx(np.linalg.norm(solution.positions[-1] - goal))
    assert solution.reached == (solution.distance < 0.01)


def limb(chance: Numbers, joints: int, bent: bool = False) -> Chain:
    """A limb with random bones, straight or bent in its plane."""
    rest = chance.uniform(-40, 40, joints) if bent else np.zeros(joints)
    return Chain(
        [
            Joint.degrees(
                f"j{k}",
                (0.0, 0.0, float(chance.uniform(20, 40)) if k else 0.0),
                rest=(0.0, float(rest[k]), 0.0),
            )
            for k in range(joints)
        ]
    )


def test_the_bend_is_on_the_poles_side_in_10000_unlimited_solves() -> None:
    """Every joint, not only most: none lies beyond the line base to goal where it is reached."""
    chance = np.random.default_rng(11)
    solves = 0
    for joints in (3, 4, 5, 7, 12):
        for bent in (False, True):
            for _ in range(10):
                chain = limb(chance, joints, bent)
                longest = 2.0 * chain.lengths.max() - chain.length
                ways = chance.normal(size=(100, 3))
                ways /= np.linalg.norm(ways, axis=1, keepdims=True)
                far = chance.uniform(max(longest, 0.0), chain.length, (100, 1))
                pole = chance.normal(size=3) * 60.0
                found = Solver2D(chain, registry=REGISTRY, pole=pole).solve_many(ways * far)
                sides = np.einsum("mnk,mk->mn", found.positions, found.bend_vector)[:, 1:-1]
                solves += len(sides)
                assert (sides.mean(axis=1) >= -1e-9).all()
                assert (sides[np.asarray(found.reached)] >= -0.01).all()
                toward = np.einsum("k,mk->m", pole, found.bend_vector)
                assert (toward > 0.0).all()
    assert solves == 10_000


def turns_between(rotations: Any) -> Any:
    """Largest turn of a joint against its parent from goal to goal, (m - 1,) [deg]."""
    own = np.concatenate([rotations[:, :1], rotations[:, :-1].swapaxes(2, 3) @ rotations[:, 1:]], 1)
    step = own[:-1].swapaxes(2, 3) @ own[1:]
    return np.degrees(np.arccos(np.clip((np.trace(step, axis1=2, axis2=3) - 1) / 2, -1, 1))).max(1)


@pytest.mark.parametrize("axis", ["y+", "x-", "free"])
@pytest.mark.parametrize("limited", [False, True])
def test_a_goal_that_moves_by_a_degree_turns_no_joint_by_more_than_five(
    axis: str, limited: bool
) -> None:
    """Away from the pole's line, and with the free axis from goals behind the resting chain."""
    chance = np.random.default_rng(3)
    steps = 0
    for joints in (3, 4, 6):
        for _ in range(15):
            plain = limb(chance, joints)
            span = (-150.0, 0.0) if limited else None
            chain = Chain(
                [Joint.degrees(j.name, j.offset, planar=span if k else None)
                 for k, j in enumerate(plain.joints)]
            )  # fmt: skip
            pole = chance.normal(size=3)
            pole *= 100.0 / np.linalg.norm(pole)
            u, v, _ = np.linalg.qr(chance.normal(size=(3, 3)))[0]
            far = chance.uniform(0.35, 0.9) * chain.length
            turn = np.radians(np.arange(360.0))[:, None]
            ways = np.cos(turn) * u + np.sin(turn) * v
            solver = Solver2D(chain, registry=REGISTRY, pole=pole, reference_axis=axis)
            moved = turns_between(solver.solve_many(far * ways).rotations)
            good = np.abs(ways @ pole)[:-1] < 100.0 * np.cos(np.radians(40.0))
            if axis == "free":
                good &= ways[:-1, 2] > np.cos(np.radians(100.0))
            steps += good.sum()
            assert (moved[good] <= 5.0).all()
    assert steps > 3000


def test_without_continuity_the_order_of_goals_does_not_count() -> None:
    chance = np.random.default_rng(9)
    solver = Solver2D(limb(chance, 5, True), registry=REGISTRY, pole=(0.0, 90.0, 0.0))
    goals = chance.normal(size=(50, 3)) * 40.0
    order = chance.permutation(50)

    one, other = solver.solve_many(goals), solver.solve_many(goals[order])
    np.testing.assert_array_equal(one.angles[order], other.angles)


def test_a_mirrored_limb_gives_the_mirrored_pose() -> None:
    """Planar limits count toward the pole, so they stay the same in the mirror (M-14)."""
    chance = np.random.default_rng(4)
    plain = limb(chance, 5, True)
    chain = Chain([Joint(j.name, j.offset, rest=j.rest, planar=(-1.0, 0.3)) for j in plain.joints])
    flip = np.array([-1.0, 1.0, 1.0])
    goal, pole = np.array([20.0, 30.0, 40.0]), np.array([50.0, 60.0, -10.0])
    one = Solver2D(chain, registry=REGISTRY, pole=pole).solve(goal)
    other = Solver2D(chain.mirrored(), registry=REGISTRY, pole=pole * flip).solve(goal * flip)

    np.testing.assert_allclose(other.positions, one.positions * flip, atol=1e-9)
