"""The soft zone: a limb does not snap straight, and says truthfully that it stays behind."""

from math import e, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.solution import Solution, Status
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D

Array = NDArray[np.float64]
RATE = 60.0
BENDS = ("two-bone", "solved-arc", "uniform-arc")


def arm(scale: float = 1.0) -> Chain:
    """Upper arm 0.52 and forearm 0.48, along z."""
    return Chain(
        [
            Joint("shoulder"),
            Joint("elbow", (0.0, 0.0, 0.52 * scale)),
            Joint("wrist", (0.0, 0.0, 0.48 * scale)),
        ]
    )


def soft(zone: float, bend: str = "solved-arc", scale: float = 1.0) -> Solver:
    return Solver(
        arm(scale), initial_bend=bend, soft_zone=zone, tolerance=1e-9 * scale, smoothing=1.0
    )


def radial(distances: Array) -> Array:
    way = np.array([0.36, -0.48, 0.8])
    return np.asarray(np.multiply.outer(distances, way))


def out_and_back() -> Array:
    """0.85 to 1.15 of the reach and back in two seconds, as a sine."""
    t = np.arange(121) / RATE
    return radial(1.0 + 0.15 * np.sin(pi * (t - 0.5)))


def elbow_angles(solution: Solution) -> Array:
    bones = np.diff(solution.positions, axis=1)
    bones /= np.linalg.norm(bones, axis=2, keepdims=True)
    sine = np.linalg.norm(np.cross(bones[:, 0], bones[:, 1]), axis=1)
    return np.asarray(np.degrees(np.arctan2(sine, (bones[:, 0] * bones[:, 1]).sum(1))))


def largest_acceleration(angles: Array) -> float:
    return float(np.abs(np.diff(angles, 2)).max() * RATE**2)


@pytest.mark.parametrize("bend", BENDS)
def test_full_extension_and_back_stays_below_the_acceleration_of_a_limb(bend: str) -> None:
    elbow = elbow_angles(soft(0.04, bend).solve_many(out_and_back()))
    steps = np.abs(np.diff(elbow))

    assert largest_acceleration(elbow) <= 1500.0
    for frame, step in enumerate(steps):
        around = np.median(steps[max(frame - 4, 0) : frame + 5])
        assert step <= 3.0 or step <= 4.0 * around


def test_without_the_zone_the_same_path_snaps() -> None:
    elbow = elbow_angles(soft(0.0).solve_many(out_and_back()))
    assert largest_acceleration(elbow) > 10_000.0


def test_the_pose_is_the_same_going_out_and_coming_in() -> None:
    solution = soft(0.04).solve_many(out_and_back())
    assert solution.positions == pytest.approx(solution.positions[::-1], abs=1e-9)


@given(distance=st.floats(0.0, 3.0), zone=st.floats(0.001, 0.5))
def test_the_end_follows_the_exponential_law(distance: float, zone: float) -> None:
    solver = soft(round(zone, 6))
    zone = solver.settings.soft_zone
    start = 1.0 - zone
    law = distance if distance <= start else 1.0 - zone * np.exp(-(distance - start) / zone)

    solution = solver.solve(radial(np.array([distance]))[0])

    inner = max(law, 0.04)  # bones of 0.52 and 0.48 come no nearer
    assert np.linalg.norm(solution.positions[-1]) == pytest.approx(inner, abs=1e-7)


@given(distance=st.floats(0.1, 3.0), zone=st.floats(0.001, 0.5), bend=st.sampled_from(BENDS))
def test_in_2d_the_end_follows_the_same_law(distance: float, zone: float, bend: str) -> None:
    solver = Solver2D(arm(1.0), pole=(0.3, 2.0, 0.1), initial_bend=bend, soft_zone=round(zone, 6))
    zone = solver.settings.soft_zone
    start = 1.0 - zone
    law = distance if distance <= start else 1.0 - zone * np.exp(-(distance - start) / zone)
    goal = radial(np.array([distance]))[0]

    solution = solver.altered(max_iterations=200, tolerance=1e-9, smoothing=1.0).solve(goal)

    assert np.linalg.norm(solution.positions[-1]) == pytest.approx(law, abs=1e-5)
    assert np.cross(solution.positions[-1], goal) == pytest.approx(np.zeros(3), abs=1e-5)
    assert solution.distance == pytest.approx(abs(distance - law), abs=1e-5)


def test_the_zone_is_a_share_of_the_reach_whatever_the_unit() -> None:
    lags = [
        soft(0.04, scale=scale).solve(radial(np.array([scale]))[0]).distance / scale
        for scale in (1.0, 60.0)
    ]
    assert lags == pytest.approx([0.04 / e, 0.04 / e])


def test_the_lag_is_small_where_a_limb_is_almost_straight() -> None:
    assert soft(0.04).solve(radial(np.array([0.999]))[0]).distance <= 0.015


def test_status_and_distance_are_those_of_the_real_goal() -> None:
    solution = soft(0.04).solve_many(radial(np.array([0.9, 0.95, 0.97, 1.0])))
    statuses = np.asarray(solution.status)
    assert statuses[:2].tolist() == [Status.REACHED, Status.REACHED]
    assert not (statuses[2:] == Status.REACHED).any()
    assert [Status(status).label for status in statuses[2:]] == ["stopped", "stopped"]
    assert soft(0.04).solve(radial(np.array([1.1]))[0]).status is Status.OUT_OF_REACH
    ends = np.linalg.norm(solution.positions[:, -1] - solution.goal, axis=1)
    assert solution.distance == pytest.approx(ends, abs=1e-12)
    assert ends[2] > 1e-3


def test_reach_is_counted_from_the_bend_root() -> None:
    joints = [Joint("chest"), Joint("shoulder", (0.0, 0.0, 0.5)), *arm().joints[1:]]
    solver = Solver(Chain(joints), initial_bend="solved-arc", bend_reference=2, soft_zone=0.04)

    solution = solver.solve((0.0, 0.0, 1.5))

    assert solution.distance == pytest.approx(0.04 / e, abs=1e-6)
