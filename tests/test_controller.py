"""The controller: reach limit, rest, orientation, and staying on the end in full FK (C-07)."""

from typing import Any

import numpy as np
import pytest

from limbik import Controller
from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError
from limbik.core.pose import forward_kinematics
from limbik.core.reach import pull_into_reach, reach_range
from limbik.core.rotation import hpb_to_matrix, matrix_to_hpb
from limbik.tests.limbs import arm, ball, solver

UNEQUAL = ball(30.0, 10.0, 5.0)  # 45 out, 15 of the long bone left over


@pytest.mark.parametrize(
    ("bones", "expected"),
    [
        ((20.0, 20.0, 20.0), (0, 60)),
        ((30, 10, 5), (15, 45)),
        ((5, 30, 10), (15, 45)),
        ((7,), (7, 7)),
    ],
)
def test_reach_range_is_what_the_bones_allow(
    bones: tuple[float, ...], expected: tuple[float, float]
) -> None:
    chain = ball(*bones)
    assert reach_range(chain) == pytest.approx(expected)
    ends, _ = forward_kinematics(
        chain, np.random.default_rng(5).uniform(-3, 3, (2000, len(chain), 3))
    )
    distance = np.linalg.norm(ends[:, -1], axis=1)
    assert distance.min() >= expected[0] - 1e-9
    assert distance.max() <= expected[1] + 1e-9


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        ((0.0, 90.0, 0.0), (0.0, 45.0, 0.0)),
        ((0.0, -3.0, 4.0), (0.0, -9.0, 12.0)),
        ((0.0, 0.0, 20.0), (0.0, 0.0, 20.0)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 15.0)),
    ],
    ids=["outside", "in the hole", "within", "on the base"],
)
def test_goals_are_pulled_along_their_line_from_the_base(
    goal: tuple[float, ...], expected: tuple[float, ...]
) -> None:
    moved = Chain(UNEQUAL.joints, (1.0, 2.0, 3.0))
    np.testing.assert_allclose(pull_into_reach(UNEQUAL, goal), expected, atol=1e-12)
    pulled = pull_into_reach(moved, np.add(goal, (1.0, 2.0, 3.0)))
    np.testing.assert_allclose(pulled, np.add(expected, (1.0, 2.0, 3.0)), atol=1e-12)


def test_the_setting_reach_limit_makes_far_goals_reached_at_the_rim() -> None:
    far = [(0.0, 90.0, 0.0), (0.0, 3.0, -4.0)]
    free, limited = solver(UNEQUAL), solver(UNEQUAL, reach_limit=True, max_iterations=500)
    assert not free.solve(far[0]).reached
    for solution in (limited.solve(far[0]), limited.solve_many(far), limited.follow(far)):
        assert np.all(solution.reached)
    np.testing.assert_allclose(limited.solve(far[0]).goal, (0.0, 45.0, 0.0))


def test_a_controller_with_reach_limit_comes_back_pulled() -> None:
    run = solver(UNEQUAL)
    far = Controller((0.0, 90.0, 0.0))
    assert far.lead(run).controller.position == (0.0, 90.0, 0.0)
    limited = Controller((0.0, 90.0, 0.0), reach_limit=True).lead(run)
    assert limited.controller.position == pytest.approx((0.0, 45.0, 0.0))
    assert limited.solution.reached


def test_nothing_is_solved_while_the_controller_rests() -> None:
    """C-07B: even where the end is apart from it, one round a solve would otherwise go nearer."""
    run = solver(ball(20.0, 20.0, 20.0), max_iterations=1, aim_from="previous")
    controller = Controller((10.0, 20.0, 30.0))
    first = controller.lead(run)
    assert not first.solution.reached
    assert controller.lead(run, first) is first
    assert first.controller.lead(run, first) is first
    moved = controller.moved((10.0, 20.0, 30.5)).lead(run, first)
    assert moved is not first
    assert moved.controller.position == (10.0, 20.0, 30.5)


def test_new_fk_offsets_or_another_solver_wake_a_resting_controller() -> None:
    run = solver(ball(20.0, 20.0, 20.0))
    controller = Controller((10.0, 20.0, 30.0))
    first = controller.lead(run)
    offsets = np.full((4, 3), 0.1)
    second = controller.lead(run, first, offsets)
    assert second is not first
    assert controller.lead(run, second, offsets.copy()) is second
    assert controller.lead(solver(ball(20.0, 20.0, 20.0)), first) is not first


def test_a_controller_hands_its_continuity_on() -> None:
    run = solver(ball(20.0, 20.0, 20.0), aim_from="previous")
    goals = [(10.0, 20.0, 30.0), (15.0, 18.0, 30.0), (20.0, 10.0, 30.0)]
    followed = run.follow(goals)
    led = None
    for number, goal in enumerate(goals):
        led = Controller(goal).lead(run, led)
        assert led.solution.angles.tobytes() == followed.angles[number].tobytes()


@pytest.mark.parametrize("follows", ["own", "base", "end", "aim"])
def test_orientation_follows_what_it_is_told_to(follows: Any) -> None:
    turn = (0.3, -0.2, 0.1)
    led = Controller((20.0, 12.0, 30.0), turn, follows).lead(solver(ball(20.0, 20.0, 20.0)))
    rotation, solution = led.controller.rotation, led.solution
    if follows == "own":
        np.testing.assert_allclose(rotation, hpb_to_matrix(turn))
    elif follows == "aim":
        away = np.array(led.controller.position) - solution.positions[0]
        np.testing.assert_allclose(rotation[:, 2], away / np.linalg.norm(away))
        assert matrix_to_hpb(rotation)[2] == pytest.approx(0.0)
    else:
        np.testing.assert_allclose(rotation, solution.rotations[0 if follows == "base" else -1])


def test_a_controller_on_the_base_keeps_its_turn_when_it_follows_the_aim() -> None:
    led = Controller((0.0, 0.0, 0.0), (0.3, 0.2, 0.1), "aim").lead(solver(ball(20.0, 20.0)))
    assert led.controller.turn == (0.3, 0.2, 0.1)


@pytest.mark.parametrize(("ik", "held"), [(False, True), (False, False), (True, True)])
def test_in_full_fk_the_controller_is_held_on_the_end(ik: bool, held: bool) -> None:
    offsets = np.radians([[10.0, 20.0, 0.0], [0.0, 30.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    controller = Controller((60.0, 60.0, 60.0), hold_on_end=held)
    led = controller.lead(solver(arm(), ik=ik), fk_offsets=offsets)
    on_end = tuple(led.solution.positions[-1].tolist())
    assert led.controller.position == (on_end if held and not ik else (60.0, 60.0, 60.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"position": (0.0, 0.0)}, "controller: position"),
        ({"position": (0.0, 0.0, np.inf)}, "controller: position"),
        (
            {"position": (0.0, 0.0, 1.0), "turn": (0.0, np.nan, 0.0)},
            "controller: turn",
        ),
        (
            {"position": (0.0, 0.0, 1.0), "follows": "pole"},
            "controller: follows must be one of own, base, end, aim, not 'pole'",
        ),
    ],
)
def test_a_bad_controller_is_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Controller(**arguments)
    assert message in str(caught.value)


def test_joint_0_of_an_offset_chain_is_where_reach_starts() -> None:
    shifted = Chain([Joint("hip", (100.0, 0.0, 0.0)), *UNEQUAL.joints[1:]])
    np.testing.assert_allclose(pull_into_reach(shifted, (100.0, 90.0, 0.0)), (100.0, 45.0, 0.0))
