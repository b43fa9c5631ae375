"""The measures of motion find what they are made to find, and nothing where there is nothing."""

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.motion import turn_between
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solver import Solver
from limbik.plugins.judging import (
    curve,
    limits,
    mirror,
    motion,
    reach,
    replay,
    roundtrip,
    soundness,
)
from limbik.plugins.judging.catalogue import BY_NAME, METRICS
from limbik.plugins.judging.run import NotJudged, Run
from limbik.plugins.judging.smoothness import log_jerk

Array = NDArray[np.float64]
REGISTRY = Registry(third_party=False)


def arm(**elbow: Any) -> Chain:
    return Chain(
        [
            Joint("shoulder"),
            Joint.degrees("elbow", (0, 0, 0.5), **elbow),
            Joint("wrist", (0, 0, 0.5)),
        ]
    )


def spine() -> Chain:
    return Chain([Joint(f"s{k}", (0, 0, 0.2 if k else 0.0)) for k in range(6)])


def circle(count: int = 61, radius: float = 0.8, seconds: float = 1.0) -> Array:
    t = np.linspace(0.0, seconds, count)
    return radius * np.stack([0 * t, np.sin(2 * pi * t), np.cos(2 * pi * t)], axis=1)


def run(goals: Array, chain: Chain | None = None, follow: bool = False, **options: Any) -> Run:
    """Solve a path; the pole is off the circle's plane unless told."""
    given: dict[str, Any] = {
        "initial_bend": "two-bone",
        "tolerance": 1e-6,
        "bend_vector": {"use": "global", "direction": (1.0, 0.0, 0.0)},
    } | options
    solver = Solver(arm() if chain is None else chain, registry=REGISTRY, **given)
    many = solver.follow if follow else solver.solve_many
    return Run(solver, goals, np.zeros((len(solver.chain), 3)), follow, 60.0, many(goals))


def with_angles(judged: Run, angles: Array) -> Run:
    return replace(judged, solution=replace(judged.solution, angles=angles))


def test_a_smooth_circle_is_reached_without_pops_or_flips() -> None:
    judged = run(circle())
    assert reach.reach_errors(judged).max() < 1e-6
    assert motion.pops(judged) == replay.flips(judged) == 0.0
    assert motion.gains(judged).max() < 2.0
    assert motion.plane_speeds(judged).max() == pytest.approx(0.0, abs=1e-9)


def test_the_bend_plane_turns_fast_past_a_pole_near_the_path() -> None:
    near = run(circle(), bend_vector={"use": "global", "direction": (0.2, -1.0, -0.6)})
    far = run(circle(), bend_vector={"use": "global", "direction": (2.0, -1.0, -0.6)})
    assert motion.plane_speeds(near).max() > 3.0 * motion.plane_speeds(far).max()


def test_a_joint_that_turns_at_once_in_one_frame_pops() -> None:
    judged = run(circle())
    angles = judged.solution.angles.copy()
    angles[30:, 1, 0] += np.radians(40.0)
    popped = with_angles(judged, angles)
    assert motion.pops(popped) == 1.0
    assert motion.gains(popped).max() > 5.0 * motion.gains(judged).max()
    assert motion.accelerations(popped).max() > np.radians(30.0) * 60.0**2


def test_a_pole_in_the_plane_of_the_circle_flips_at_every_crossing() -> None:
    judged = run(circle(), bend_vector={"use": "global", "direction": (0.0, -1.0, -0.6)})
    assert replay.flips(judged) == 2.0


def test_a_fast_turn_that_finer_steps_remove_is_no_flip() -> None:
    assert motion.joint_turns(run(circle(9))).max() > replay.JUMP
    assert replay.flips(run(circle(9))) == 0.0


def test_a_path_by_continuity_depends_on_its_order_and_one_without_does_not() -> None:
    assert replay.history(run(circle(21))) == 0.0
    goals = np.random.default_rng(5).uniform(-0.5, 0.5, (20, 3))
    carried = run(goals, follow=True, aim_from="previous", bend_vector="manual")
    assert replay.history(carried) > np.radians(1.0)
    assert replay.drift(run(circle(21))) == 0.0


def test_gain_is_the_turn_over_the_way_in_lengths() -> None:
    """A rigid turn about the shoulder: way = radius x turn."""
    judged = run(circle(radius=1.0), initial_bend="two-bone")
    assert np.median(motion.gains(judged)) == pytest.approx(1.0, rel=0.01)


def test_goals_that_stand_still_have_no_gain() -> None:
    with pytest.raises(NotJudged, match="moves less"):
        motion.gains(run(np.full((5, 3), 0.3)))


def test_chatter_counts_reversals_of_limited_axes_only() -> None:
    judged = run(circle(), arm(heading=(0, 0), pitch=(-145, 0)))
    angles = np.zeros_like(judged.solution.angles)
    angles[::2, 1, 1] = np.radians(-1.0)
    angles[::2, 0, 0] = np.radians(50.0)
    shaken = with_angles(judged, angles)
    assert limits.chatter(shaken) == pytest.approx(59 / (61 / 60))
    with pytest.raises(NotJudged, match="no joint has a range"):
        limits.chatter(run(circle()))


def test_limit_excess_is_the_angle_beyond_the_range() -> None:
    judged = run(circle(), arm(pitch=(-145, 0)))
    angles = judged.solution.angles.copy()
    angles[3, 1, 1] = np.radians(2.5)
    assert limits.limit_excess(judged) == 0.0
    assert limits.limit_excess(with_angles(judged, angles)) == pytest.approx(np.radians(2.5))


def test_curl_and_unevenness_of_known_bends() -> None:
    judged = run(circle(5))
    turns = np.radians([[10.0, 10.0, 10.0], [0.0, 0.0, 60.0]])
    ways = np.cumsum(np.hstack([np.zeros((2, 1)), turns]), axis=1)
    bones = np.stack([0 * ways, np.sin(ways), np.cos(ways)], axis=2)
    places = np.concatenate([np.zeros((2, 1, 3)), np.cumsum(bones, axis=1)], axis=1)
    even, hooked = (
        replace(judged, solution=replace(judged.solution, positions=places[k : k + 1]))
        for k in (0, 1)
    )
    assert curve.curl(even) == pytest.approx(1.0)
    assert curve.unevenness(even) == pytest.approx(0.0, abs=1e-9)
    assert curve.curl(hooked) == pytest.approx(3.0)
    assert curve.unevenness(hooked) == pytest.approx(np.sqrt(2.0))


def test_the_middle_of_an_s_is_found_and_an_arc_has_none() -> None:
    judged = run(circle(5))
    for turns, off in (([20.0, 20.0, -20.0, -20.0], 0.0), ([20.0, -20.0, -20.0, -20.0], 0.2)):
        ways = np.radians(np.cumsum([0.0, *turns]))
        bones = np.stack([0 * ways, np.sin(ways), np.cos(ways)], axis=1)
        places = np.concatenate([np.zeros((1, 3)), np.cumsum(bones, axis=0)])[None]
        bent = replace(judged, solution=replace(judged.solution, positions=places))
        assert curve.s_shape(bent) == pytest.approx(off, abs=1e-9)
    assert curve.s_shape(run(circle(5), spine(), initial_bend="uniform-arc")) == 0.5


def test_a_round_trip_is_exact_for_what_ik_can_make_and_shows_what_it_cannot() -> None:
    assert np.degrees(roundtrip.round_trip(run(circle(7)))) < 0.01
    bent = run(circle(7), spine(), initial_bend="uniform-arc")
    angles = bent.solution.angles.copy()
    angles[:, 1, 0] += 0.5
    assert np.degrees(roundtrip.round_trip(with_angles(bent, angles))) > 1.0


def test_a_status_that_is_not_true_is_counted() -> None:
    judged = run(np.array([[0.0, 0.0, 0.8], [0.0, 0.0, 1.5], [0.0, 0.8, 0.0]]))
    assert reach.false_statuses(judged) == 0.0
    lying = replace(judged, solution=replace(judged.solution, status=np.zeros(3, np.int64)))
    assert reach.false_statuses(lying) == 1.0


def test_the_unavoidable_miss_is_no_excess() -> None:
    judged = run(np.array([[0.0, 0.0, 0.8], [0.0, 0.0, 1.5]]))
    assert reach.excess_errors(judged).max() < 1e-6
    assert len(reach.reach_errors(judged)) == 1


def test_stretch_and_unsound_poses_are_found() -> None:
    judged = run(circle(5))
    assert soundness.stretch(judged) < 1e-12
    assert soundness.unsound_poses(judged) == 0.0
    places, angles = judged.solution.positions.copy(), judged.solution.angles.copy()
    places[2, 1] *= 1.1
    angles[1, 0, 0] = np.nan
    broken = replace(judged, solution=replace(judged.solution, positions=places, angles=angles))
    assert soundness.stretch(broken) > 0.01
    assert soundness.unsound_poses(broken) == 1.0


@pytest.mark.parametrize(
    "options",
    [
        {"bend_vector": {"use": "manual", "angle": 30.0}},
        {"bend_vector": {"use": "global", "direction": (1.0, -1.0, 0.2)}, "twist": 20.0},
        {"reference_axis": "x+", "bend_vector": {"use": "manual", "angle": 100.0}},
        {"forbidden_cone": {"axis": "x+", "half_angle": 60.0}},
    ],
)
def test_limbs_of_all_options_are_symmetrical(options: dict[str, Any]) -> None:
    goals = np.random.default_rng(3).uniform(-0.5, 0.5, (20, 3))
    assert mirror.asymmetry(run(goals, **options)) < 1e-9


def test_turns_are_measured_exactly_from_tiny_to_half() -> None:
    for angle in (1e-9, 0.3, 3.0, pi):
        found = turn_between(np.eye(3), hpb_to_matrix([angle, 0.0, 0.0]))
        assert found == pytest.approx(angle, rel=1e-6)


def test_a_jerky_speed_is_farther_from_zero_than_a_smooth_one() -> None:
    t = np.linspace(0.0, 1.0, 120)
    smooth = np.sin(pi * t) ** 2
    assert log_jerk(smooth + 0.05 * np.sin(60 * t), 120.0) < log_jerk(smooth, 120.0) - 2.0


def test_metric_names_are_unique_and_the_numbers_known() -> None:
    assert len(BY_NAME) == len(METRICS)
    assert {metric.number for metric in METRICS} <= {f"M{k}" for k in range(1, 24)}
