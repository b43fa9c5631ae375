"""The initial bends that solve for the goal: exact, continuous, the same compiled."""

from math import acos, degrees, pi
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.solver import Solver
from limbik.core.strategy import unflatten
from limbik.testing import check_strategy, run_native

Array = NDArray[np.float64]
REGISTRY = Registry(third_party=False)
SOLVED = ("solved-arc", "uniform-arc", "two-bone")
ARCS = SOLVED[:2]


def bend(choice: Any, lengths: Any, ratio: float, weights: Any = None) -> Array:
    """Angles of a strategy, run by its native code."""
    bound = REGISTRY.bind("initial_bend", choice)
    bones = np.asarray(lengths, float)
    given = np.ones(len(bones)) if weights is None else np.asarray(weights, float)
    arguments = (bones / bones.sum(), ratio, given, None, np.full(len(bones), np.nan))
    angles: Array = run_native("initial_bend", bound.strategy, bound.params, arguments)[-1]
    return angles


def end(lengths: Any, angles: Array) -> complex:
    """Where the end lies: along the line root→goal, and across it times i."""
    bones = np.asarray(lengths, float)
    return complex((bones / bones.sum() * np.exp(1j * angles)).sum())


def hole(lengths: Any) -> float:
    bones = np.asarray(lengths, float)
    return max(0.0, 2.0 * float(bones.max() / bones.sum()) - 1.0)


bones = st.lists(st.floats(0.2, 1.0), min_size=2, max_size=28)


@pytest.mark.parametrize("name", ARCS)
@given(lengths=bones, share=st.floats(0.0, 1.0), seed=st.integers(0, 99))
def test_the_end_lies_on_the_goal_whatever_the_lengths_and_weights(
    name: str, lengths: list[float], share: float, seed: int
) -> None:
    weights = np.random.default_rng(seed).uniform(0.3, 2.0, len(lengths))
    # At the very rim of the hole the bones lie on one line and rounding decides.
    least = hole(lengths) + 1e-3 * (hole(lengths) > 0.0)
    ratio = least + share * (1.0 - least)

    angles = bend(name, lengths, ratio, weights)

    assert end(lengths, angles) == pytest.approx(ratio, rel=0, abs=1e-12)


@given(lengths=bones, share=st.floats(0.0, 1.0), knee=st.integers(1, 27))
def test_two_bone_is_an_exact_triangle_about_any_knee(
    lengths: list[float], share: float, knee: int
) -> None:
    knee = min(knee, len(lengths) - 1)
    least = abs(sum(lengths[:knee]) - sum(lengths[knee:])) / sum(lengths)
    ratio = least + share * (1.0 - least)

    angles = bend({"use": "two-bone", "joint": knee}, lengths, ratio)

    assert end(lengths, angles) == pytest.approx(ratio, rel=0, abs=1e-12)
    assert len(set(angles[:knee])) == len(set(angles[knee:])) == 1
    assert angles[0] >= 0.0 >= angles[-1]


def test_two_bone_takes_the_middle_of_the_length_by_default() -> None:
    angles = bend("two-bone", [1.0, 1.0, 1.0, 3.0], 0.5)
    assert angles == pytest.approx(np.array([1, 1, 1, -1]) * acos(0.5))


def test_two_bone_scales_by_the_weights() -> None:
    assert bend("two-bone", [1.0, 1.0], 0.5, [0.5, 2.0]) == pytest.approx(
        [0.5 * acos(0.5), -2.0 * acos(0.5)]
    )


@pytest.mark.parametrize("name", SOLVED)
def test_two_equal_bones_bend_as_the_document_says(name: str) -> None:
    assert bend(name, [1.0, 1.0], 0.6) == pytest.approx([acos(0.6), -acos(0.6)], abs=1e-12)


def test_uniform_arc_bends_every_joint_alike() -> None:
    turns = np.diff(bend("uniform-arc", np.ones(9), 0.4))
    assert np.ptp(turns) == pytest.approx(0.0, abs=1e-12)
    assert turns[0] < -0.1


def test_solved_arc_keeps_the_shape_of_the_nth_root() -> None:
    ratio = 0.8
    solved = np.diff(bend("solved-arc", np.ones(6), ratio))
    document = np.diff(bend("nth-root", np.ones(6), ratio))
    assert solved / solved[0] == pytest.approx(document / document[0])
    assert abs(end(np.ones(6), bend("nth-root", np.ones(6), ratio)) - ratio) > 0.05


@pytest.mark.parametrize("name", ARCS)
def test_weights_shift_the_bend_and_their_common_factor_does_not(name: str) -> None:
    lengths, even = np.ones(5), np.ones(5)
    uneven = np.array([2.0, 1.0, 1.0, 1.0, 0.5])
    assert bend(name, lengths, 0.7, 0.3 * even) == pytest.approx(bend(name, lengths, 0.7))
    assert bend(name, lengths, 0.7, 0.0 * even) == pytest.approx(bend(name, lengths, 0.7))
    shifted, plain = bend(name, lengths, 0.7, uneven), bend(name, lengths, 0.7)
    assert abs(shifted[0] - shifted[1]) > 2.0 * abs(plain[0] - plain[1])


@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.parametrize("ratio", [1.0, 1.5, 100.0])
def test_a_goal_out_of_reach_leaves_the_bones_straight(name: str, ratio: float) -> None:
    assert bend(name, [0.3, 0.3, 0.4], ratio) == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize("name", SOLVED)
def test_a_single_bone_stays_on_the_line(name: str) -> None:
    assert bend(name, [1.0], 0.3).tolist() == [0.0]


@pytest.mark.parametrize("name", SOLVED)
def test_a_goal_inside_the_hole_is_approached_as_near_as_the_bones_come(name: str) -> None:
    angles = bend(name, [0.7, 0.1, 0.2], 0.1)
    assert end([0.7, 0.1, 0.2], angles) == pytest.approx(0.4, abs=1e-6)


@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.parametrize("lengths", [[1.0] * 2, [1.0] * 6, [1.0] * 28, [3.0, 3.0, 4.0]])
def test_the_bend_has_no_jump_from_the_root_to_beyond_the_reach(
    name: str, lengths: list[float]
) -> None:
    """Ten times finer steps of the distance make the largest turn at least twice smaller."""
    if name == "two-bone" and len(lengths) == 3:
        lengths = [3.0, 3.0, 6.0]  # a knee off the middle makes a hole with a vertical rim

    def largest_turn(steps: int) -> float:
        poses = [bend(name, lengths, ratio) for ratio in np.linspace(0.0, 1.05, steps)]
        return float(np.abs(np.diff(poses, axis=0)).max())

    coarse, fine = largest_turn(200), largest_turn(2000)
    assert fine < 0.5 * coarse
    assert degrees(fine) < 4.0


@pytest.mark.parametrize("name", SOLVED)
@pytest.mark.parametrize("lengths", [[1.0] * 7, [0.5, 0.2, 0.6, 0.4], [0.7, 0.1, 0.2]])
def test_compiled_and_interpreted_bends_agree(name: str, lengths: list[float]) -> None:
    bound = REGISTRY.bind("initial_bend", name)
    check_strategy("initial_bend", bound.strategy)
    share = np.array(lengths) / sum(lengths)
    for ratio in (0.0, 0.05, 0.45, 0.7, 0.95, 0.9999, 1.1):
        plain = np.full(len(share), np.nan)
        weights = np.linspace(0.8, 1.2, len(share))
        params = unflatten(bound.strategy.params, bound.values)
        bound.strategy.function()(share, ratio, weights, params, plain)
        np.testing.assert_allclose(bend(name, share, ratio, weights), plain, rtol=0, atol=1e-7)


def ball_chain(count: int) -> Chain:
    offset = (0.0, 0.0, 1.0 / (count - 1))
    return Chain([Joint(f"j{k}", offset if k else (0.0, 0.0, 0.0)) for k in range(count)])


@pytest.mark.parametrize("name", ARCS)
@pytest.mark.parametrize("count", [3, 4, 7, 15, 28])
def test_the_solver_needs_no_rounds_for_a_chain_without_limits(name: str, count: int) -> None:
    rng = np.random.default_rng(count)
    goals = rng.normal(size=(40, 3))
    goals *= (rng.uniform(0.02, 0.999, 40) / np.linalg.norm(goals, axis=1))[:, None]
    solver = Solver(
        ball_chain(count), registry=REGISTRY, initial_bend=name, max_iterations=0, tolerance=1e-9
    )

    solution = solver.solve_many(goals)

    assert np.max(solution.distance) < 1e-9


def joint_bends(positions: Array) -> Array:
    """Angles between neighbouring bones, (..., n-2) [rad]."""
    way = np.diff(positions, axis=-2)
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    cosines: Array = (way[..., 1:, :] * way[..., :-1, :]).sum(-1)
    return np.asarray(np.arccos(np.clip(cosines, -1.0, 1.0)))


def bow(name: str) -> tuple[float, float, float]:
    """Largest miss, curl and unevenness of a spine of six bones whose tip bows in a figure."""
    turn = np.linspace(0.0, 2.0 * pi, 121)
    path = np.stack([0.45 * np.sin(turn), np.full(121, 0.8), 0.1 * np.sin(2 * turn)], axis=1)
    solver = Solver(
        ball_chain(7), registry=REGISTRY, initial_bend=name, tolerance=1e-6, smoothing=1.0
    )
    solution = solver.solve_many(path)
    bends = joint_bends(solution.positions)
    mean = bends.mean(axis=1)
    curl, unevenness = (bends[:, -1] / mean).max(), (bends.std(axis=1) / mean).max()
    return float(np.max(solution.distance)), float(curl), float(unevenness)


@pytest.mark.parametrize("name", ARCS)
def test_a_bowing_spine_curves_evenly_and_reaches(name: str) -> None:
    miss, curl, unevenness = bow(name)
    assert miss < 1e-6
    assert curl <= 1.6
    assert unevenness <= 0.35


def test_ccd_from_the_nth_root_curls_the_same_spine_at_its_end() -> None:
    _, curl, unevenness = bow("nth-root")
    assert curl > 2.0
    assert unevenness > 0.6
