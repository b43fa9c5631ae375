"""The end joint takes over the goal's orientation by a share, within its limits (M-05)."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.controller import Controller
from limbik.core.errors import InputError
from limbik.core.kernels.orient import nearest_turn
from limbik.core.kernels.rotation import rotation_vector, turn_by
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.scene import scene_from
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml
from limbik.tests.limbs import REGISTRY

BONES = [Joint("shoulder"), Joint("elbow", (0.0, 0.0, 1.0)), Joint("wrist", (0.0, 0.0, 1.0))]
FREE = Chain([*BONES, Joint("hand", (0.0, 0.0, 0.2))])
NARROW = Joint.degrees("hand", (0, 0, 0.2), heading=(-30, 20), pitch=(-40, 10), bank=(-5, 60))
LIMITED = Chain([*BONES, NARROW])
GOAL = np.array([0.7, 0.4, 1.1])
TURN = np.radians([40.0, -25.0, 70.0])
ANGLES = st.floats(-np.pi, np.pi)


def angle_between(first: Array, second: Array) -> float:
    """Angle of the rotation from one frame to another [rad], exact near 0."""
    return 2.0 * float(np.arcsin(np.clip(np.linalg.norm(first - second) / np.sqrt(8.0), 0, 1)))


def run(chain: Chain, share: float) -> Solver:
    return Solver(chain, end_orientation=share, registry=REGISTRY)


def test_a_full_share_is_the_goals_orientation_exactly() -> None:
    plain, turned = run(FREE, 0.0).solve(GOAL), run(FREE, 1.0).solve(GOAL, goal_turn=TURN)
    assert angle_between(turned.rotations[-1], hpb_to_matrix(TURN)) < 1e-9
    assert angle_between(plain.rotations[-1], hpb_to_matrix(TURN)) > 0.1
    np.testing.assert_array_equal(turned.positions, plain.positions)
    np.testing.assert_array_equal(turned.angles[:-1], plain.angles[:-1])


def test_a_part_of_it_lies_on_the_shortest_way() -> None:
    start = run(FREE, 0.0).solve(GOAL).rotations[-1]
    whole = angle_between(start, hpb_to_matrix(TURN))
    for share in (0.25, 0.5, 0.9):
        found = run(FREE, share).solve(GOAL, goal_turn=TURN).rotations[-1]
        assert angle_between(start, found) == pytest.approx(share * whole, abs=1e-9)
        assert angle_between(found, hpb_to_matrix(TURN)) == pytest.approx((1 - share) * whole)


def test_without_a_share_or_a_turn_nothing_changes() -> None:
    plain = run(LIMITED, 0.0).solve(GOAL).angles
    for share, turn in ((0.0, TURN), (1.0, None), (1.0, np.full(3, np.nan))):
        np.testing.assert_array_equal(run(LIMITED, share).solve(GOAL, goal_turn=turn).angles, plain)


def test_many_goals_each_have_their_own_turn() -> None:
    goals = GOAL * np.array([[0.5], [0.9], [1.0]])
    turns = np.array([TURN, np.full(3, np.nan), -TURN])
    solver = run(FREE, 1.0)
    for many in (solver.solve_many, solver.follow):
        found = many(goals, goal_turns=turns)
        for row in (0, 2):
            assert angle_between(found.rotations[row, -1], hpb_to_matrix(turns[row])) < 1e-9
    found = solver.solve_many(goals, goal_turns=turns)
    for row in range(3):
        one = solver.solve(goals[row], goal_turn=turns[row])
        np.testing.assert_array_equal(found.angles[row], one.angles)


@settings(max_examples=200, deadline=None)
@given(st.tuples(ANGLES, ANGLES, ANGLES))
def test_limits_hold_and_no_turn_inside_them_is_nearer(turn: tuple[float, float, float]) -> None:
    """Compared with 13 x 13 x 13 turns inside the limits."""
    low, high = LIMITED.low[-1], LIMITED.high[-1]
    target = hpb_to_matrix(turn)
    rows = tuple(map(tuple, target.tolist()))
    best = nearest_turn(rows, (0.0, 0.0, 0.0), tuple(low), tuple(high))  # type: ignore[arg-type]
    assert (best >= low).all()
    assert (best <= high).all()
    axes = [np.linspace(a, b, 13) for a, b in zip(low, high, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    agreement = np.einsum("kij,ij->k", hpb_to_matrix(grid), target)
    assert np.einsum("ij,ij->", hpb_to_matrix(best), target) >= agreement.max() - 1e-9


@settings(max_examples=200, deadline=None)
@given(st.tuples(*[st.floats(0.0, 1.0)] * 3))
def test_what_the_limits_allow_is_exact(share: tuple[float, float, float]) -> None:
    low, high = LIMITED.low[-1], LIMITED.high[-1]
    inside = low + np.array(share) * (high - low)
    parent = run(LIMITED, 0.0).solve(GOAL).rotations[-2]
    turn = matrix_to_hpb(parent @ hpb_to_matrix(inside))
    found = run(LIMITED, 1.0).solve(GOAL, goal_turn=turn)
    assert angle_between(found.rotations[-1], hpb_to_matrix(turn)) < 1e-9
    assert (found.angles >= LIMITED.low).all()
    assert (found.angles <= LIMITED.high).all()


@settings(max_examples=300, deadline=None)
@given(st.tuples(ANGLES, ANGLES, ANGLES), st.floats(0.0, np.pi))
def test_rotation_vectors_go_there_and_back(axis: tuple[float, float, float], angle: float) -> None:
    size = np.linalg.norm(axis)
    x, y, z = np.array(axis) / size * angle if size > 1e-3 else (angle, 0.0, 0.0)
    rotation = turn_by((x, y, z))
    back = turn_by(rotation_vector(rotation))
    np.testing.assert_allclose(back, rotation, atol=1e-9)


def test_a_controller_hands_its_own_turn_on() -> None:
    leads = Controller(tuple(GOAL.tolist()), tuple(TURN.tolist()))
    found = leads.lead(run(FREE, 1.0)).solution
    assert angle_between(found.rotations[-1], hpb_to_matrix(TURN)) < 1e-9


def test_the_2d_solver_refuses_the_option() -> None:
    with pytest.raises(InputError, match="ientation: belongs to the 3D solver"):
        Solver2D(FREE, pole=(0, 1, 0), end_orientation=0.5)


def test_turns_that_do_not_fit_are_refused() -> None:
    solver = run(FREE, 1.0)
    with pytest.raises(InputError, match="goal turns: expected 2, one a goal, found 1"):
        solver.solve_many([GOAL, GOAL], goal_turns=[TURN])
    with pytest.raises(InputError, match="goal turns: every number must be finite"):
        solver.solve(GOAL, goal_turn=[0.0, np.inf, 0.0])


SCENE = b"""\
limbik: 1
chain:
  joints:
    - {name: elbow}
    - {name: wrist, offset: [0, 0, 1]}
    - {name: hand, offset: [0, 0, 1]}
options: {end_orientation: 1}
goals:
  - {position: [0.5, 0.5, 1], rotation: [40, -25, 70]}
  - {position: [0.5, 0.6, 1]}
"""


@pytest.mark.parametrize("trace", [False, True])
def test_a_scene_turns_the_end_with_the_goals_that_have_a_rotation(trace: bool) -> None:
    scene = scene_from(read_yaml(SCENE, "hand.yaml"), Path(), REGISTRY)
    first, second = solve_scene(scene, REGISTRY, trace)
    assert angle_between(first.rotations[-1], hpb_to_matrix(TURN)) < 1e-9
    np.testing.assert_array_equal(second.angles[-1], 0.0)
