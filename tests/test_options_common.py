"""Every option common to both solvers does what the document says (rows C-01 to C-17)."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.tests.limbs import (
    ARM_OPTIONS,
    GOAL,
    LIMB,
    Array,
    arm,
    degrees_between,
    rotations,
    solve,
    stages,
)


def test_without_ik_the_pose_is_rest_plus_fk_within_limits() -> None:
    """C-01, C-03, B-01."""
    fk = np.radians([[10.0, 20.0, 30.0], [5.0, 10.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 0.0]])
    solution = solve(arm(), ik=False, fk=fk)
    assert np.degrees(solution.angles) == pytest.approx(
        np.array([[10.0, 20.0, 30.0], [0.0, 10.0, 0.0], [0.0, 70.0, 0.0], [0.0, 0.0, 0.0]])
    )
    assert solution.iterations == -2


def test_the_initial_pose_is_the_rest_pose_within_limits() -> None:
    """C-03, B-03: a solve stopped at -2 shows it."""
    rest = Joint.degrees("a", rest=(10.0, -20.0, 30.0), pitch=(-5.0, 5.0))
    chain = Chain([rest, *LIMB.joints[1:]])
    found = solve(chain, max_iterations=-2)
    assert np.degrees(found.angles[0]) == pytest.approx([10.0, -5.0, 30.0])


@pytest.mark.parametrize("strength", [1.0, 0.5, 0.0])
def test_fk_offsets_are_added_to_the_initial_bend_at_their_strength(strength: float) -> None:
    """C-04, C-06."""
    fk = np.radians([[0.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 6.0], [0.0, 0.0, 0.0]])
    before = stages(max_iterations=0)["bend"]
    after = stages(max_iterations=0, fk=fk, fk_strength=strength)["bend"]
    assert (after - before)[1, 1] == pytest.approx(8.0 * strength)
    # Joint 2 aims anew after joint 1 has been offset; its own offset is its bank's.
    untwisted = stages(max_iterations=0, fk=fk * [[1], [1], [0], [1]], fk_strength=strength)["bend"]
    assert (after - untwisted)[2, 2] == pytest.approx(6.0 * strength, abs=1e-9)


@pytest.mark.parametrize("mix", [0.0, 0.25, 1.0])
def test_fk_mix_lies_between_ik_and_fk_in_joint_angles(mix: float) -> None:
    """C-05: 0 is IK, 1 is FK; FK angles are taken in the form nearest to the solved ones."""
    fk = np.radians([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0], [0.0, 0.0, 0.0]])
    ik = solve(arm(), fk=fk, **ARM_OPTIONS).angles
    mixed = solve(arm(), fk=fk, fk_mix=mix, **ARM_OPTIONS).angles
    posed = np.clip(fk, arm().low, arm().high)
    np.testing.assert_allclose(mixed, (1 - mix) * ik + mix * posed, atol=1e-2 if mix else 0.0)
    if mix == 1.0:
        np.testing.assert_allclose(mixed, posed, atol=1e-12)


def test_more_rounds_stop_later_and_nearer() -> None:
    """C-08, C-09A: rounds never make a ball chain's distance larger."""
    far = np.array([20.0, 30.0, 47.0])
    found = [solve(goal=far, max_iterations=count, tolerance=1e-9) for count in (0, 1, 3, 9)]
    assert [solution.iterations for solution in found] == [0, 1, 3, 9]
    distances = [float(solution.distance) for solution in found]
    assert sorted(distances, reverse=True) == distances


def test_each_stage_can_be_the_answer() -> None:
    """B-03, B-04: the pose asked for by number is the one the trace holds."""
    traced = stages(max_iterations=2, tolerance=1e-9)
    assert list(traced) == ["initial", "aim", "bend", "round 1", "round 2"]
    for number, name in ((-2, "initial"), (-1, "aim"), (0, "bend"), (1, "round 1")):
        alone = np.degrees(solve(max_iterations=number, tolerance=1e-9).angles)
        np.testing.assert_allclose(rotations(alone), rotations(traced[name]), atol=1e-12)


@pytest.mark.parametrize("tolerance", [1.0, 0.1, 0.001])
def test_rounds_end_within_the_tolerance_and_not_before(tolerance: float) -> None:
    """C-09B."""
    solution = solve(goal=(20.0, 30.0, 40.0), tolerance=tolerance, max_iterations=500)
    one_less = solve(
        goal=(20.0, 30.0, 40.0), tolerance=1e-12, max_iterations=int(solution.iterations) - 1
    )
    assert solution.reached
    assert solution.distance < tolerance <= one_less.distance


def test_a_joint_past_its_violations_leaves_the_rounds() -> None:
    """C-09C, E-11F: after its second turn into a limit the elbow rests; unbounded it goes on."""
    options: dict[str, Any] = {"tolerance": 1e-9, "clamp": "plain", "max_iterations": 40}
    goal = (-23.9, 3.6, 12.0)
    free = stages(arm(), goal, **options)
    bounded = stages(arm(), goal, max_violations=1, **options)
    later = [name for name in bounded if name.startswith("round")][3:]
    elbow = np.array([[found[name][1] for name in later] for found in (free, bounded)])
    assert len(later) > 5
    assert np.ptp(elbow[0], axis=0).max() > 10.0
    np.testing.assert_array_equal(np.ptp(elbow[1], axis=0), 0.0)


@pytest.mark.parametrize(("base", "end"), [(1, 0), (0, 1), (1, 1)])
def test_held_joints_keep_their_bend_angles_through_the_rounds(base: int, end: int) -> None:
    """C-10."""
    traced = stages(held={"base": base, "end": end}, max_iterations=9, tolerance=1e-9)
    changed = np.abs(traced["round 9"] - traced["bend"]).max(axis=1) > 1e-6
    held = [True] * base + [False] * (3 - base - end) + [True] * end
    assert changed[:3].tolist() == [not one for one in held]


@pytest.mark.parametrize(("side", "number"), [("base", 0), ("end", 2)])
def test_held_joints_stay_out_of_the_bend_only_where_it_says_so(side: str, number: int) -> None:
    """C-10, 3D A-23: both ends alike."""
    held = {side: 1}
    bends = stages(max_iterations=0, held=held)
    stays = stages(max_iterations=0, held={**held, f"bend_{side}": True})
    assert np.abs(bends["bend"] - bends["aim"])[number].max() > 1.0
    np.testing.assert_allclose(stays["bend"][number], stays["aim"][number], atol=1e-9)


def pitch_of_bend(**options: Any) -> Array:
    """Return the angle of each bone from the line base→goal after the bend [deg]."""
    solution = solve(goal=(0.0, 0.0, 30.0), max_iterations=0, **options)
    angles: Array = degrees_between(np.diff(solution.positions, axis=0), np.array([0.0, 0.0, 1.0]))
    return angles


def test_nth_root_lays_the_bones_from_the_bend_angle_to_its_opposite() -> None:
    """C-11: P = acos(30/60) = 60°; three bones turn by P (2 - 3^(k/2))."""
    assert pitch_of_bend() == pytest.approx([60.0, 60.0 * (3**0.5 - 2) * -1, 60.0])


@pytest.mark.parametrize("base", [0.0, 0.5, 2.0])
def test_bend_coefficient_follows_its_formula(base: float) -> None:
    """C-12: (1 - P / 90°)(1 - base) + base with P = 60°."""
    factor = (1.0 - 60.0 / 90.0) * (1.0 - base) + base
    expected = np.abs(pitch_of_bend() * factor)
    found = pitch_of_bend(coefficient_base=base)
    np.testing.assert_allclose(found, expected, atol=1e-9)


def test_bend_weights_follow_their_formula() -> None:
    """C-13: 1 + min + C³ (max - min), C = 1 - |apex - way| / length, apex = 0.5 here."""
    way = np.array([0.0, 1.0, 2.0]) / 3.0
    c = 1.0 - np.abs(0.5 - way)
    factor = 1.0 + (-0.4 + c**3 * (0.3 + 0.4))
    np.testing.assert_allclose(
        pitch_of_bend(weight_range=(-0.4, 0.3)), pitch_of_bend() * factor, atol=1e-9
    )


def test_a_bent_bind_is_detected_and_bends_by_its_bone_lengths() -> None:
    """C-15, 3D A-06: the Z layout counts bones, the off-axis layout the distance at rest."""
    joints = [Joint("a"), Joint.degrees("b", (0, 0, 20), rest=(0, 90, 0)), Joint("c", (0, 0, 20))]
    chain = Chain(joints)
    assert not chain.is_straight
    goal = (0.0, 0.0, 20.0)
    straight = solve(chain, goal, max_iterations=0)
    assert straight.distance == pytest.approx(0.0, abs=1e-12)  # P = acos(20 / 40): exact for two
    bent_bind = solve(chain, goal, max_iterations=0, off_axis=True)
    assert bent_bind.distance > 1.0  # P = acos(20 / 28.3)


def test_a_solve_reports_rounds_and_the_distance_of_its_end() -> None:
    """C-16."""
    solution = solve(tolerance=0.5, max_iterations=50)
    assert 0 < solution.iterations < 50
    away = np.linalg.norm(forward_kinematics(LIMB, solution.angles)[0][-1] - GOAL)
    assert solution.distance == pytest.approx(away)
