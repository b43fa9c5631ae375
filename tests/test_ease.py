"""Stiffness and the limit ease of CCD (M-09)."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError, InputError
from limbik.core.kernels.ease import eased, eased_gap
from limbik.core.rotation import Array
from limbik.core.solver import Solver
from limbik.tests.limbs import ARM_OPTIONS, REGISTRY, arm, ball, reachable

GAPS = st.floats(0.0, 3.0)
ZONES = st.floats(0.01, 1.0)


@settings(max_examples=300, deadline=None)
@given(GAPS, st.floats(0.0, 1.0), ZONES)
def test_an_eased_step_stays_short_of_the_limit_and_goes_on(
    gap: float, share: float, zone: float
) -> None:
    step = share * gap
    left = eased_gap(gap, step, zone)
    assert gap - step - 1e-12 <= left <= gap
    if gap - step >= zone:
        assert left == gap - step
    elif gap > 0.0:
        assert left > 0.0


@settings(max_examples=200, deadline=None)
@given(GAPS, st.floats(0.01, 0.98), ZONES)
def test_the_ease_has_no_edge(gap: float, share: float, zone: float) -> None:
    """What is left falls with the step, never faster than the step, and its slope does not jump."""
    step, small = share * gap, 1e-6
    slopes = [
        (eased_gap(gap, at, zone) - eased_gap(gap, at + small, zone)) / small
        for at in (step, step + small)
    ]
    assert -1e-6 <= slopes[0] <= 1.0 + 1e-6
    assert abs(slopes[1] - slopes[0]) < 1e-4


def test_only_axes_that_near_their_limit_are_slowed() -> None:
    low, high = (-1.0, -1.0, -np.inf), (1.0, 1.0, np.inf)
    found = eased((0.9, 0.9, 0.0), (1.0, 0.5, 2.0), low, high, 0.2)
    assert 0.9 < found[0] < 1.0
    assert found[1:] == (0.5, 2.0)
    assert eased((-0.9, 0.0, 0.0), (-1.0, 0.0, 0.0), low, high, 0.2)[0] == pytest.approx(-found[0])


def run(chain: Chain, **options: Any) -> Solver:
    return Solver(chain, registry=REGISTRY, **options)


def turned(chain: Chain, stiffness: dict[str, float], joint: int) -> float:
    """Angle by which one round of CCD at full strength turns a joint of the bend pose [rad]."""
    options: dict[str, Any] = {"smoothing": 1.0, "finish": "none", "stiffness": stiffness}
    goal = (0.4, 0.9, 1.3)
    start = run(chain, max_iterations=0, finish="none").solve(goal).rotations
    end = run(chain, max_iterations=1, **options).solve(goal).rotations
    own = [r[joint - 1].T @ r[joint] for r in (start, end)]
    return float(2.0 * np.arcsin(np.linalg.norm(own[0] - own[1]) / np.sqrt(8.0)))


def test_a_stiff_joint_makes_its_share_of_the_first_turn() -> None:
    """The first joint a round turns has nothing before it: it makes exactly 1 - s of its turn."""
    chain = ball(1.0, 0.8, 0.6)
    whole = turned(chain, {}, 2)
    assert whole > 0.05
    for share in (0.3, 0.9):
        assert turned(chain, {"j2": share}, 2) == pytest.approx((1.0 - share) * whole, rel=1e-6)


def test_a_stiff_joint_has_turned_less_in_the_end() -> None:
    chain, options = arm(), {"finish": "none", "max_iterations": 100, **ARM_OPTIONS}
    goals = reachable(chain, 100, 8)
    start = run(chain, **{**options, "max_iterations": 0}).solve_many(goals).angles

    def work(found: Array, joint: int) -> float:
        return float(np.abs(found[:, joint] - start[:, joint]).mean())

    soft = run(chain, **options).solve_many(goals).angles
    stiff = run(chain, stiffness={"wrist": 0.95}, **options).solve_many(goals).angles
    assert work(stiff, 2) < 0.6 * work(soft, 2)


def test_with_an_ease_joints_stay_clear_of_their_limits() -> None:
    chain, options = arm(), {"finish": "none", "max_iterations": 100, **ARM_OPTIONS}
    goals = reachable(chain, 200, 8)
    hard = run(chain, **options).solve_many(goals)
    soft = run(chain, limit_ease=15.0, **options).solve_many(goals)
    turning = chain.high - chain.low > 1e-6

    def resting(angles: Array) -> float:
        gap = np.minimum(angles - chain.low, chain.high - angles)[:, turning]
        return float((gap < np.radians(0.5)).mean())

    assert resting(soft.angles) < 0.7 * resting(hard.angles)
    assert np.mean(soft.reached) > np.mean(hard.reached) - 0.1


@pytest.mark.parametrize("options", [{"limit_ease": 20.0}, {"stiffness": {"elbow": 0.9}}])
def test_limits_hold_and_goals_are_reached_all_the_same(options: dict[str, Any]) -> None:
    chain, goals = arm(), reachable(arm(), 200, 9)
    found = run(chain, tolerance=1e-4 * 74.0, **options, **ARM_OPTIONS).solve_many(goals)
    assert np.all(found.reached)
    assert (found.angles >= chain.low).all()
    assert (found.angles <= chain.high).all()


def test_switched_off_they_change_no_bit() -> None:
    chain, goals = arm(), reachable(arm(), 50, 9)
    plain = run(chain, **ARM_OPTIONS).solve_many(goals).angles
    named = run(chain, stiffness={"elbow": 0.0}, limit_ease=0.0, **ARM_OPTIONS)
    np.testing.assert_array_equal(named.solve_many(goals).angles, plain)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ChainError, match="stiffness: no joint is called 'knee'"):
        run(arm(), stiffness={"knee": 0.5})
    with pytest.raises(InputError, match="must be below 1"):
        run(arm(), stiffness={"elbow": 1.0})


def test_a_joint_with_a_limit_of_its_own_is_eased_too() -> None:
    cone = {"use": "cone", "swing": (50.0, 50.0)}
    chain = Chain(
        [
            Joint("shoulder", limit=cone),
            Joint("elbow", (0.0, 0.0, 1.0), limit=cone),
            Joint("hand", (0.0, 0.0, 1.0)),
        ]
    )
    options: dict[str, Any] = {"finish": "none", "smoothing": 1.0, "max_iterations": 3}
    goal, start = (1.2, 0.6, 0.9), {"start": "current"}
    hard = run(chain, **options, **start).solve(goal)
    soft = run(chain, limit_ease=30.0, **options, **start).solve(goal)
    assert not np.allclose(hard.angles, soft.angles, atol=1e-3)
