"""A chain is checked when it is built, and says what is wrong with which joint."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError
from limbik.core.pose import forward_kinematics
from limbik.tests.limbs import arm, ball, joint, solver

TIP = Joint("tip", (0.0, 0.0, 10.0))


def with_limit(low: float, high: float) -> Chain:
    return Chain([Joint.degrees("elbow", pitch=(low, high)), TIP])


BAD: list[tuple[Callable[[], Any], str | None, str]] = [
    (lambda: Chain([TIP]), None, "a chain has 2 to 256 joints, this one has 1"),
    (lambda: Chain([]), None, "a chain has 2 to 256 joints, this one has 0"),
    (lambda: ball(*[1.0] * 256), None, "a chain has 2 to 256 joints, this one has 257"),
    (lambda: Chain([TIP, TIP]), "tip", "two joints have this name; every joint needs its own"),
    (lambda: Chain([Joint(""), TIP]), None, "every joint needs a name"),
    (
        lambda: Chain([Joint("a"), Joint("b")]),
        None,
        "all joints are in one place: at least one bone needs a length",
    ),
    (
        lambda: Chain([Joint("a", (0.0, np.nan, 0.0)), TIP]),
        "a",
        "offset must be three finite numbers (found [0.0, nan, 0.0])",
    ),
    (
        lambda: Chain([Joint("a", frozen=(0.0, np.inf, 0.0)), TIP]),
        "a",
        "frozen must be three finite numbers (found [0.0, inf, 0.0])",
    ),
    (
        lambda: Chain([Joint("a", rest=(0.0, 0.0)), TIP]),  # type: ignore[arg-type]
        "a",
        "rest must be three finite numbers (found [0.0, 0.0])",
    ),
    (
        lambda: Chain([Joint("a", offset=3.0), TIP]),  # type: ignore[arg-type]
        "a",
        "offset must be three finite numbers (found 3.0)",
    ),
    (
        lambda: Chain([Joint.degrees("a", heading=10.0), TIP]),  # type: ignore[arg-type]
        "a",
        "heading range must be two finite numbers (found 10.0)",
    ),
    (
        lambda: Chain([Joint("a", heading=("low", 1.0)), TIP]),  # type: ignore[arg-type]
        "a",
        "heading range must be two finite numbers (found ('low', 1.0))",
    ),
    (
        lambda: Chain([Joint("a"), TIP], (0.0, 0.0, np.inf)),
        None,
        "base position must be three finite numbers (found [0.0, 0.0, inf])",
    ),
    (
        lambda: Chain([Joint("a"), TIP], base_turn=(np.nan, 0.0, 0.0)),
        None,
        "base rotation must be three finite numbers (found [nan, 0.0, 0.0])",
    ),
    (
        lambda: with_limit(-30.0, np.nan),
        "elbow",
        "pitch range must be two finite numbers (found [-30, nan])",
    ),
    (
        lambda: with_limit(30.0, -30.0),
        "elbow",
        "pitch range [30, -30]: the minimum is above the maximum",
    ),
    (
        lambda: with_limit(170.0, 190.0),
        "elbow",
        "pitch range [170, 190] crosses ±180°: turn the joint's zero with `frozen` "
        "so that the range fits between -180 and 180",
    ),
    (
        lambda: with_limit(-181.0, 0.0),
        "elbow",
        "pitch range [-181, 0] crosses ±180°: turn the joint's zero with `frozen` "
        "so that the range fits between -180 and 180",
    ),
    (
        lambda: solver(ball(10.0, 10.0), bend_reference=3),
        None,
        "bend_reference 3: this chain of 3 joints allows 1 to 2",
    ),
    (
        lambda: solver(ball(10.0, 10.0), held={"base": 2, "end": 1}),
        None,
        "held: 3 joints held, this chain has 2 before its end",
    ),
    (
        lambda: solver(ball(10.0, 0.0), bend_reference=2),
        "j1",
        "the chain has no length from the bend root to the end",
    ),
]


@pytest.mark.parametrize(("build", "name", "message"), BAD, ids=[case[2][:40] for case in BAD])
def test_what_makes_no_chain_is_refused_by_name(
    build: Callable[[], Any], name: str | None, message: str
) -> None:
    with pytest.raises(ChainError) as caught:
        build()
    assert caught.value.joint == name
    assert caught.value.faults[0].message == message


def test_ranges_up_to_180_degrees_and_fixed_axes_are_allowed() -> None:
    assert np.degrees(with_limit(-180.0, 180.0).high[0, 1]) == pytest.approx(180.0)
    fixed = with_limit(12.0, 12.0)
    assert fixed.low[0, 1] == fixed.high[0, 1] == pytest.approx(np.radians(12.0))


def test_free_axes_have_infinite_limits() -> None:
    chain = ball(10.0, 10.0)
    assert np.isneginf(chain.low).all()
    assert np.isposinf(chain.high).all()


def test_degrees_and_radians_build_the_same_joint() -> None:
    one = Joint.degrees("a", (1, 2, 3), (10, 20, 30), (1, 2, 3), (-5, 5), None, (0, 90))
    turn = np.pi / 180.0
    assert one.frozen == pytest.approx((10 * turn, 20 * turn, 30 * turn))
    assert one.rest == pytest.approx((turn, 2 * turn, 3 * turn))
    assert one.heading == pytest.approx((-5 * turn, 5 * turn))
    assert one.pitch is None
    assert one.bank == pytest.approx((0.0, np.pi / 2))


def test_arrays_are_read_only_and_the_input_may_change_after() -> None:
    joints = [Joint("a"), TIP]
    chain = Chain(joints)
    joints.pop()
    assert len(chain) == 2
    for array in (chain.offsets, chain.frozen, chain.rest, chain.low, chain.high, chain.lengths):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_lengths_are_those_of_the_bones() -> None:
    chain = Chain([Joint("a", (9, 9, 9)), Joint("b", (3, 4, 0)), Joint("c", (0, 0, 5))])
    assert chain.lengths == pytest.approx([5.0, 5.0])
    assert chain.length == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("turn", "straight"), [((0, 0, 0), True), ((0, 0, 77), True), ((0, 1e-3, 0), False)]
)
def test_bind_type_is_straight_while_all_bones_lie_on_one_line(
    turn: tuple[float, float, float], straight: bool
) -> None:
    joints = [Joint("a"), Joint.degrees("b", (0, 0, 1), rest=turn), Joint("c", (0, 0, 1))]
    assert Chain(joints).is_straight is straight


def test_bones_without_length_do_not_decide_the_bind_type() -> None:
    assert ball(5.0, 0.0, 5.0).is_straight
    joints = [
        joint("a", (0, 0, 0)),
        joint("b", (0, 0, 0)),
        joint("c", (0, 1, 1)),
        joint("d", (0, 1, 0)),
    ]
    assert not Chain(joints).is_straight


def test_mirrored_angles_give_the_mirrored_pose_and_twice_mirrored_is_the_same() -> None:
    chain = Chain(arm().joints, (1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    angles = np.random.default_rng(3).uniform(-1.0, 1.0, (4, 3))
    one, _ = forward_kinematics(chain, angles)
    other, _ = forward_kinematics(chain.mirrored(), angles * [-1, 1, -1])
    np.testing.assert_allclose(other, one * [-1, 1, 1], atol=1e-12)
    assert chain.mirrored().mirrored().joints == chain.joints
