"""Pole rotors turn the pole with the chain; binding leaves the rest pose alone."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError
from limbik.core.pole import ROTORS, Pole, PoleRotor
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix, matrix_to_hpb
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver2d import Solver2D

REGISTRY = Registry(third_party=False)
LEG = Chain(
    [
        Joint.degrees("hip", frozen=(0.0, -90.0, 0.0)),
        Joint.degrees("knee", (0.0, 0.0, 43.0)),
        Joint.degrees("ankle", (0.0, 0.0, 43.0)),
    ],
    (9.0, 93.0, 0.0),
)
FRONT = (9.0, 50.0, 60.0)
HIP = np.array([9.0, 93.0, 0.0])


def solver(rotor: Any = None, **options: Any) -> Solver2D:
    return Solver2D(LEG, registry=REGISTRY, pole=Pole(position=FRONT, rotor=rotor), **options)


def test_a_pole_may_be_a_point_or_a_pole() -> None:
    point = Solver2D(LEG, registry=REGISTRY, pole=np.array(FRONT)).solve((9, 20, 10))

    np.testing.assert_array_equal(point.positions, solver().solve((9, 20, 10)).positions)
    np.testing.assert_array_equal(point.pole, FRONT)


def test_a_rotor_at_rest_leaves_the_pole_where_it_is() -> None:
    solution = solver("leg").solve((9.0, 7.0, 0.0))

    np.testing.assert_allclose(solution.pole, FRONT, atol=1e-12)
    assert solution.rotor is not None
    np.testing.assert_allclose(solution.rotor, np.eye(3), atol=1e-15)


def test_a_rotor_turns_the_pole_with_the_chain() -> None:
    """A leg swung forward by 90° takes the pole from the front of the knee to above it."""
    solution = solver(PoleRotor()).solve((9.0, 93.0, 80.0))

    np.testing.assert_allclose(solution.pole, HIP + np.array([0.0, 60.0, 43.0]), atol=1e-12)


def test_half_the_swing_is_half_the_turn() -> None:
    half = solver(PoleRotor(swing=0.5)).solve((9.0, 93.0, 80.0))
    s = np.sqrt(0.5)

    np.testing.assert_allclose(half.pole - HIP, [0, s * (60 - 43), s * (60 + 43)], atol=1e-12)


@pytest.mark.parametrize(("preset", "share"), [("arm", 0.5), ("leg", 1.0)])
def test_a_preset_follows_the_goals_twist(preset: str, share: float) -> None:
    """A foot turned out by 40° about the hanging leg takes the pole along by its share."""
    turned = solver(preset).solve((9.0, 20.0, 0.0), goal_turn=np.radians([40.0, 0.0, 0.0]))
    expected = hpb_to_matrix(np.radians([40.0 * share, 0.0, 0.0])) @ (np.array(FRONT) - HIP)

    np.testing.assert_allclose(turned.pole - HIP, expected, atol=1e-9)
    assert ROTORS[preset].twist == share


FOOT = (0.4, -0.7, 0.3)


def test_all_shares_at_one_carry_the_pole_with_the_goal() -> None:
    """As if the pole were a part of the foot."""
    carried = solver(PoleRotor(twist=1.0, tilt=1.0)).solve((20.0, 30.0, 25.0), goal_turn=FOOT)
    foot_at_rest = LEG.rest_pose[1][-1]
    expected = hpb_to_matrix(FOOT) @ foot_at_rest.T @ (np.array(FRONT) - HIP)

    np.testing.assert_allclose(carried.pole - HIP, expected, atol=1e-9)


def test_tilting_the_goal_alone_moves_the_pole_by_the_share_of_the_tilt() -> None:
    """Below the hip, where the leg hangs as at rest, a foot pitched down has no twist."""
    pitch, share = 0.8, 0.25
    foot = hpb_to_matrix((0.0, pitch, 0.0)) @ LEG.rest_pose[1][-1]
    turn = matrix_to_hpb(foot)
    tilted = solver(PoleRotor(twist=1.0, tilt=share)).solve((9.0, 20.0, 0.0), goal_turn=turn)
    plain = solver("leg").solve((9.0, 20.0, 0.0), goal_turn=turn)
    expected = hpb_to_matrix((0.0, pitch * share, 0.0)) @ (np.array(FRONT) - HIP)

    np.testing.assert_allclose(tilted.pole - HIP, expected, atol=1e-9)
    np.testing.assert_allclose(plain.pole, FRONT, atol=1e-9)


@pytest.mark.parametrize("away", [0.0, 1e-7, -1e-7])
def test_with_a_rotor_a_circle_through_the_poles_line_never_flips(away: float) -> None:
    """A fixed pole turns the knee over twice a round, a rotor not once, not even overhead."""
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    ring = np.stack([0.0 * turn + away, -np.cos(turn), np.sin(turn)], -1)
    path = HIP + 70.0 * ring

    def flips(rotor: Any) -> int:
        bends = solver(rotor).solve_many(path).bend_vector
        return int(((bends[1:] * bends[:-1]).sum(-1) < 0.5).sum())

    assert (flips(None), flips("leg")) == (2, 0)


def test_the_rotor_turns_with_the_chains_parent() -> None:
    tilted = Chain(LEG.joints, LEG.base_position, (0.4, 0.2, -0.3))
    turn = hpb_to_matrix((0.4, 0.2, -0.3))
    pole, goal = np.array(FRONT) - HIP, np.array([5.0, -60.0, 30.0])
    moved = Pole(position=tuple((HIP + turn @ pole).tolist()), rotor="leg")
    one = solver("leg").solve(HIP + goal)
    other = Solver2D(tilted, registry=REGISTRY, pole=moved).solve(HIP + turn @ goal)

    np.testing.assert_allclose(other.pole - HIP, turn @ (one.pole - HIP), atol=1e-9)
    np.testing.assert_allclose(other.angles, one.angles, atol=1e-9)


def test_the_goal_takes_its_axes_from_the_rotor_if_asked() -> None:
    plain = solver(PoleRotor()).solve((9, 20, 30))
    axes = solver(PoleRotor(orient_goal=True)).solve((9, 20, 30))

    assert plain.goal_rotation is None
    np.testing.assert_array_equal(axes.goal_rotation, axes.rotor)


def test_z_axes_are_synchronised_both_ways() -> None:
    rotor = PoleRotor(sync_z=True)
    free = solver(rotor).solve((9, 20, 30))
    given = solver(rotor).solve((9, 20, 30), goal_turn=(0.3, -0.2, 0.5))
    loose = solver(PoleRotor()).solve((9, 20, 30), goal_turn=(0.3, -0.2, 0.5))
    assert free.rotor is not None
    assert free.goal_rotation is not None
    assert given.rotor is not None
    assert loose.rotor is not None

    np.testing.assert_allclose(free.goal_rotation[:, 2], free.rotor[:, 2], atol=1e-12)
    np.testing.assert_allclose(given.rotor[:, 2], hpb_to_matrix((0.3, -0.2, 0.5))[:, 2], atol=1e-12)
    assert np.abs(loose.rotor - given.rotor).max() > 0.1


def test_rotors_of_many_goals_are_those_of_each() -> None:
    goals = np.random.default_rng(2).normal(size=(5, 3)) * 30 + HIP
    turns = np.random.default_rng(3).uniform(-1, 1, (5, 3))
    many = solver("arm").solve_many(goals, goal_turns=turns)

    for row in range(5):
        one = solver("arm").solve(goals[row], goal_turn=turns[row])
        np.testing.assert_allclose(many.pole[row], one.pole, atol=1e-12)
        single = many.single(row)
        assert isinstance(single, PlanarSolution)
        assert single.rotor is not None
        assert one.rotor is not None
        np.testing.assert_allclose(single.rotor, one.rotor, atol=1e-12)


def test_a_share_out_of_range_is_refused() -> None:
    with pytest.raises(InputError, match="twist: must be at most 1"):
        PoleRotor(twist=1.5)


def bent(chance: np.random.Generator, spatial: bool) -> Chain:
    """A chain of 3 to 6 joints at rest in any pose, in space or in its plane."""
    share = np.array([1.0, 1.0, 1.0]) if spatial else np.array([0.0, 1.0, 0.0])
    return Chain(
        [
            Joint.degrees(
                f"j{k}",
                (0.0, 0.0, float(chance.uniform(20, 40)) if k else 0.0),
                rest=tuple((chance.uniform(-50, 50, 3) * share).tolist()),
            )
            for k in range(chance.integers(3, 7))
        ],
        (1.0, 2.0, 3.0),
        (0.3, 0.2, 0.1),
    )


@pytest.mark.parametrize("axis", ["y+", "x-", "free"])
@pytest.mark.parametrize("spatial", [False, True])
def test_a_bound_chain_stays_and_comes_back(axis: str, spatial: bool) -> None:
    """To 1e-6 degrees, wherever the pole is (M-04); unbound the same chain moves."""
    chance = np.random.default_rng(6)
    for _ in range(8):
        chain = bent(chance, spatial)
        plain = Solver2D(
            chain, registry=REGISTRY, pole=chance.uniform(-80, 80, 3), reference_axis=axis
        )
        ends, rest = forward_kinematics(chain, chain.rest)
        bound = plain.bind()
        stays = bound.solve(ends[-1])
        away = bound.solve(ends[0] + 0.8 * (ends[-1] - ends[0]))
        back = bound.solve(ends[-1], continuity=away.continuity)

        for solution in (stays, back):
            assert np.degrees(np.abs(solution.angles - chain.rest)).max() <= 1e-6
            np.testing.assert_allclose(solution.rotations, rest, atol=1e-9)
        assert np.abs(away.positions - ends).max() > 1.0
        assert np.abs(plain.solve(ends[-1]).positions - ends).max() > 1e-3


def test_a_bound_chain_still_follows_its_pole() -> None:
    """A pole turned by 30° about the line base to goal takes the whole chain along."""
    chain = bent(np.random.default_rng(1), False)
    ends, _ = forward_kinematics(chain, chain.rest)
    pole = np.array([60.0, 50.0, 40.0])
    bound = Solver2D(chain, registry=REGISTRY, pole=pole).bind()
    line = (ends[-1] - ends[0]) / np.linalg.norm(ends[-1] - ends[0])
    angle = np.radians(30.0)

    def about(v: Any) -> Any:
        side, along = np.cross(line, v), line * (line @ v)
        return np.cos(angle) * (v - along) + np.sin(angle) * side + along

    turned = bound.solve(ends[-1], pole=ends[0] + about(pole - ends[0]))
    expected = [ends[0] + about(place - ends[0]) for place in ends]
    np.testing.assert_allclose(turned.positions, expected, atol=1e-9)


def test_a_bind_that_cannot_stay_says_why() -> None:
    chain = Chain(
        [
            Joint.degrees("a"),
            Joint.degrees("b", (0.0, 0.0, 30.0), rest=(0.0, -60.0, 0.0), planar=(-20.0, 0.0)),
            Joint.degrees("c", (0.0, 0.0, 30.0)),
        ]
    )
    bent_past = Solver2D(chain, registry=REGISTRY, pole=(0.0, 90.0, 0.0))
    with pytest.raises(InputError, match=r"rest pose is outside the planar limits \(b planar\)"):
        bent_past.bind()
    with pytest.raises(InputError, match="the goal is 13 from the chain's resting end"):
        solver().bind((9.0, 20.0, 0.0))


def test_a_chain_whose_end_rests_on_its_base_is_not_bound() -> None:
    joints = [Joint.degrees(n, (0, 0, 30.0 if k else 0.0), rest=(0, 120.0 if k else 0, 0))
              for k, n in enumerate("abcd")]  # fmt: skip
    with pytest.raises(InputError, match="the end rests on the base"):
        Solver2D(Chain(joints), registry=REGISTRY, pole=FRONT).bind()
