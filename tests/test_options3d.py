"""Every option of the 3D solver does what the document says (rows E-01 to E-14).

Each test fails when its option is ignored.
"""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solution import Solution
from limbik.tests.limbs import (
    GOAL,
    LIMB,
    Array,
    ball,
    degrees_between,
    joint,
    reachable,
    rotations,
    solve,
    solver,
    stages,
)


def bent(solution: Solution) -> Array:
    """Return how far each inner joint lies off the line base→goal toward the bend vector."""
    away = solution.positions[1:-1] - solution.positions[0]
    off: Array = away @ solution.bend_vector
    return off


def manual(angle: float, **more: Any) -> dict[str, Any]:
    return {"use": "manual", "angle": angle, **more}


def test_the_chain_bends_from_the_joint_before_the_reference_on() -> None:
    """E-01: the joints before stay on the line base→goal."""
    for reference in (1, 2):
        solution = solve(bend_reference=reference, max_iterations=0)
        off = degrees_between(np.diff(solution.positions, axis=0), GOAL)
        assert (off[: reference - 1] < 1e-6).all()
        assert off[reference - 1] > 1.0


@pytest.mark.parametrize("angle", [0.0, 55.0, -120.0])
def test_manual_bends_at_an_angle_from_the_roots_y_axis_in_the_aim_pose(angle: float) -> None:
    """E-02A, E-12, E-14."""
    solution = solve(bend_vector=manual(angle), max_iterations=0)
    frame = rotations(stages(bend_vector=manual(angle), max_iterations=0)["aim"])[0]
    turn = np.radians(angle)
    np.testing.assert_allclose(
        solution.bend_vector, frame @ [np.sin(turn), np.cos(turn), 0.0], atol=1e-12
    )
    assert (bent(solution) > 1.0).all()


def test_auto_bends_toward_where_the_aimed_end_misses_the_goal() -> None:
    """E-02B, E-11E: a root that cannot aim leaves the end to one side; strength 1 bends there."""
    limits: Any = ((-10.0, 10.0), (-10.0, 10.0), None)
    chain = Chain(
        [
            joint("root", (0, 0, 0), *limits),
            *[joint(f"j{k}", (0.0, 0.0, 20.0), (-5.0, 5.0), (-5.0, 5.0), None) for k in range(3)],
        ]
    )
    goal = np.array([30.0, 0.0, 30.0])
    aim = solve(chain, goal, max_iterations=-1)
    miss = aim.positions[-1] - goal
    line = goal / np.linalg.norm(goal)
    side = miss - line * (miss @ line)
    for strength, share in ((1.0, 1.0), (0.5, 0.5), (0.0, 0.0)):
        auto = {"use": "auto", "strength": strength}
        found = solve(chain, goal, bend_vector=auto, max_iterations=-1).bend_vector
        start = solve(chain, goal, bend_vector="manual", max_iterations=-1).bend_vector
        whole = degrees_between(start, side)
        assert degrees_between(start, found) == pytest.approx(share * whole, abs=1e-6)
    off = {"use": "auto", "strength": 1.0, "sensitivity": 10.0}
    weak = solve(chain, aim.positions[-1] + [0.5, 0.0, 0.0], bend_vector=off, max_iterations=-1)
    plain = solve(chain, aim.positions[-1] + [0.5, 0.0, 0.0], max_iterations=-1)
    np.testing.assert_allclose(weak.bend_vector, plain.bend_vector, atol=1e-12)


def test_global_bends_toward_a_direction_of_the_world_however_the_base_is_turned() -> None:
    """E-02C, E-06, 3D A-13: unit length, across the line root→goal."""
    wish = np.array([0.2, -3.0, 0.4])
    chain = Chain(LIMB.joints, (4.0, 5.0, 6.0), (0.5, 0.6, 0.7))
    solution = solve(chain, bend_vector={"use": "global", "direction": wish.tolist()})
    line = (GOAL - [4.0, 5.0, 6.0]) / np.linalg.norm(GOAL - [4.0, 5.0, 6.0])
    across = wish - line * (wish @ line)
    np.testing.assert_allclose(solution.bend_vector, across / np.linalg.norm(across), atol=1e-12)


def over_the_top(**options: Any) -> Array:
    """Return the root's pitch along a path that climbs over the pole, continuity on [deg]."""
    t = np.radians(np.linspace(60.0, 175.0, 60))
    path = 40.0 * np.stack([np.zeros(60), np.sin(t), np.cos(t)], axis=1)
    options = {"bend_vector": manual(180.0), "max_iterations": 100, **options}
    followed = solver(LIMB, **options).follow(path)
    assert np.all(followed.reached)
    return np.degrees(followed.angles[:, 0])


def test_root_control_none_lets_the_pitch_pass_90_degrees() -> None:
    """E-03A: the heading need not jump."""
    angles = over_the_top(aim_from="previous")
    assert angles[:, 1].max() > 100.0
    assert np.abs(np.diff(angles[:, 1])).max() < 10.0


def test_suppress_flip_keeps_the_roots_pitch_within_90_degrees() -> None:
    """E-03B."""
    assert np.abs(over_the_top(root_control="suppress-flip")[:, 1]).max() <= 90.0 + 1e-9


def test_suppress_flip_reaches_all_reachable_goals_of_a_ball_chain() -> None:
    """E-03B, 3D A-54: the root's pitch stops, the rest keeps moving; no goal is lost."""
    for chain in (ball(20.0, 20.0), LIMB):
        run = solver(chain, root_control="suppress-flip", max_iterations=100)
        goals = reachable(chain, 500, 1)
        for solution in (run.solve_many(goals), run.follow(goals)):
            assert np.all(solution.reached)
            assert np.abs(solution.angles[:, 0, 1]).max() <= np.pi / 2 + 1e-9


def test_prefer_flip_holds_the_heading_so_that_the_pitch_goes_over() -> None:
    """E-03C."""
    run = solver(LIMB, root_control="prefer-flip", max_iterations=100)
    first = run.solve((0.0, 30.0, 20.0))
    second = run.solve((0.0, 30.0, -20.0), continuity=first.continuity)
    assert second.reached
    assert second.angles[0, 0] == pytest.approx(first.angles[0, 0], abs=1e-9)
    assert np.degrees(abs(second.angles[0, 1])) > 90.0


@pytest.mark.parametrize(
    ("axis", "column", "sign"), [("x+", 0, 1), ("x-", 0, -1), ("y+", 1, 1), ("y-", 1, -1)]
)
def test_the_reference_axis_faces_the_bend_vector(axis: str, column: int, sign: int) -> None:
    """E-04: seen along the root's Z axis, in the aim pose that is the answer."""
    options: dict[str, Any] = {"bend_vector": manual(33.0), "aim_twist": True}
    solution = solve(reference_axis=axis, max_iterations=-1, **options)
    facing = sign * solution.rotations[1][:, column]
    assert degrees_between(facing, solution.bend_vector) == pytest.approx(0.0, abs=1e-6)


def test_a_free_reference_axis_turns_nothing() -> None:
    """E-04."""
    options: dict[str, Any] = {"bend_vector": manual(33.0), "max_iterations": -1}
    twisted = solve(reference_axis="free", aim_twist=True, **options)
    np.testing.assert_allclose(twisted.angles, solve(**options).angles, atol=1e-12)


@pytest.mark.parametrize("axis", ["free", "y+"])
def test_twist_turns_the_root_about_its_z_axis(axis: str) -> None:
    """E-05, 3D A-25: on top of the reference axis."""
    options: dict[str, Any] = {"reference_axis": axis, "aim_twist": True, "max_iterations": -1}
    plain, twisted = solve(**options), solve(twist=25.0, **options)
    np.testing.assert_allclose(
        twisted.rotations[0],
        plain.rotations[0] @ hpb_to_matrix((0, 0, np.radians(25.0))),
        atol=1e-12,
    )


def test_limits_are_relative_to_the_frozen_rotation() -> None:
    """E-07, A-04: a range about zero lets a joint frozen at 90° stay near 90°."""
    frozen = Joint.degrees("a", frozen=(0.0, 90.0, 0.0), heading=(0, 0), pitch=(-5, 5), bank=(0, 0))
    chain = Chain([frozen, Joint("b", (0.0, 0.0, 20.0))])
    solution = solve(chain, (0.0, 1.0, 100.0))
    assert np.degrees(solution.angles[0, 1]) == pytest.approx(-5.0)
    assert degrees_between(solution.positions[1], np.array([0.0, 1.0, 0.0])) == pytest.approx(5.0)


def test_a_free_limb_aims_at_the_goal_and_stretches() -> None:
    """E-08."""
    ends = solve(max_iterations=-1).positions
    np.testing.assert_allclose(ends[-1], 60.0 * GOAL / np.linalg.norm(GOAL), atol=1e-9)


def test_a_round_turns_about_the_axis_across_end_and_goal() -> None:
    """E-09: the last joint of a free limb turns in the plane of its end and the goal."""
    traced = stages(max_iterations=1, smoothing=1.0, held={"base": 2})
    before, _ = forward_kinematics(LIMB, np.radians(traced["bend"]))
    after, _ = forward_kinematics(LIMB, np.radians(traced["round 1"]))
    end, goal, moved = (point - before[2] for point in (before[3], GOAL, after[3]))
    assert degrees_between(moved, goal) == pytest.approx(0.0, abs=1e-6)
    assert np.cross(end, goal) @ moved == pytest.approx(0.0, abs=1e-9)


def test_locked_banks_stay_where_the_initial_pose_has_them() -> None:
    """E-11A: from the reference joint on; otherwise the rounds twist them."""
    goal = (25.0, 20.0, -10.0)
    chain = Chain(
        [Joint("a"), *[Joint.degrees(f"j{k}", (0, 0, 20), rest=(0, 0, 7)) for k in range(3)]]
    )
    free = stages(chain, goal, max_iterations=20)
    locked = stages(chain, goal, max_iterations=20, bank_lock=True)
    assert np.abs(free["round 5"][1:3, 2] - 7.0).max() > 0.1
    for angles in locked.values():
        np.testing.assert_allclose(angles[1:3, 2], 7.0, atol=1e-6)


def test_a_held_bend_vector_stays_while_its_option_changes() -> None:
    """E-11B."""
    past = solve(bend_vector=manual(20.0))
    goal = (9.0, 12.0, 31.0)
    held = solver(LIMB, bend_vector=manual(90.0), hold_bend_vector=True)
    free = solver(LIMB, bend_vector=manual(90.0))
    kept = held.solve(goal, continuity=past.continuity).bend_vector
    np.testing.assert_allclose(kept, past.bend_vector, atol=1e-12)
    assert degrees_between(free.solve(goal, continuity=past.continuity).bend_vector, kept) > 60.0


def test_excluding_the_bank_turns_the_bend_back_by_the_banks_change() -> None:
    """E-11C: with parallel transport the bank drifts on a loop, the bend vector then does not."""
    t = np.linspace(0.0, 2.0 * np.pi, 121)
    loop = np.stack([20 * np.cos(t), 20 * np.sin(t), np.full_like(t, 30.0)], axis=1)
    for exclude, drift in ((True, 0.0), (False, 60.0)):
        vector = manual(0.0, exclude_bank=exclude)
        found = solver(LIMB, bend_vector=vector, aim_from="previous").follow(loop).bend_vector
        turned = degrees_between(found[0], found[-1])
        assert turned == pytest.approx(drift, abs=1e-6 if exclude else 1.0)


def test_bank_suppression_changes_no_bank_within_its_angle() -> None:
    """E-11G, E-11L: a limb that already points at the goal within 2° turns no bank."""
    chain = Chain(
        [Joint.degrees("a", rest=(0, 80, 0)), Joint("b", (0, 0, 20)), Joint("c", (0, 0, 20))]
    )
    aimed = forward_kinematics(chain, chain.rest)[0][-1]
    goal = np.add(aimed, [0.9, 0.0, 0.0])
    off: dict[str, Any] = {"reference_axis": "free", "max_iterations": -1}
    on = {"use": "threshold", "angle": 2.0, "all_stages": True}
    free, kept = solve(chain, goal, **off), solve(chain, goal, bank_suppression=on, **off)
    assert np.degrees(abs(free.angles[0, 2])) > 1.0
    assert kept.angles[0, 2] == pytest.approx(0.0, abs=1e-12)
    ccd_only = {**on, "all_stages": False}
    again = solve(chain, goal, bank_suppression=ccd_only, **off)
    np.testing.assert_allclose(again.angles, free.angles, atol=1e-12)


def test_heading_takes_over_the_suppressed_bank_near_a_pitch_of_90_degrees() -> None:
    """E-11H: heading += sin(pitch) x dropped bank, so the end misses the goal's way by less."""
    chain = Chain(
        [Joint.degrees("a", rest=(0, 80, 0)), Joint("b", (0, 0, 20)), Joint("c", (0, 0, 20))]
    )
    goal = np.add(forward_kinematics(chain, chain.rest)[0][-1], [0.9, 0.0, 0.0])
    off: dict[str, Any] = {"reference_axis": "free", "max_iterations": -1}
    on = {"use": "threshold", "angle": 2.0, "all_stages": True}
    free = solve(chain, goal, **off).angles[0]
    plain = solve(chain, goal, bank_suppression=on, **off).angles[0]
    corrected = solve(chain, goal, bank_suppression={**on, "heading_correction": True}, **off)
    dropped = free[2]
    expected = plain[0] + np.sin(np.radians(80.0)) * dropped
    assert corrected.angles[0, 0] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("smoothing", [0.1, 0.4, 1.0])
def test_ccd_smoothing_scales_the_first_rounds_turn(smoothing: float) -> None:
    """E-11J: round 1 makes this share of the last joint's turn."""
    traced = stages(max_iterations=1, smoothing=smoothing, held={"base": 2})
    before, _ = forward_kinematics(LIMB, np.radians(traced["bend"]))
    after, _ = forward_kinematics(LIMB, np.radians(traced["round 1"]))
    whole = degrees_between(before[3] - before[2], GOAL - before[2])
    made = degrees_between(before[3] - before[2], after[3] - after[2])
    assert made == pytest.approx(smoothing * whole)


def test_off_axis_aims_each_joints_direction_to_the_end() -> None:
    """E-11K: bones along X; with the Z layout the Z axes would point at the goal instead."""
    chain = Chain([Joint("a"), *[Joint(f"j{k}", (20.0, 0.0, 0.0)) for k in range(3)]])
    aimed = solve(chain, max_iterations=-1, off_axis=True).positions[-1]
    assert degrees_between(aimed, GOAL) == pytest.approx(0.0, abs=1e-6)
    wrong = solve(chain, max_iterations=-1).positions[-1]
    assert degrees_between(wrong, GOAL) > 45.0


def test_aim_twist_twists_the_root_of_an_aim_pose_that_is_the_answer() -> None:
    """E-11M."""
    options: dict[str, Any] = {"max_iterations": -1, "twist": 40.0, "reference_axis": "free"}
    plain, twisted = solve(**options), solve(aim_twist=True, **options)
    turned = plain.rotations[0] @ hpb_to_matrix((0, 0, np.radians(40.0)))
    np.testing.assert_allclose(twisted.rotations[0], turned, atol=1e-12)


def test_a_re_aimed_turn_never_makes_the_angle_larger_and_ends_nearer_than_a_plain_one() -> None:
    """3D A-51: one turn of one joint with limits from a random rest to a random direction."""
    rng = np.random.default_rng(4)
    most = np.radians([60.0, 60.0, 40.0])
    left: dict[str, list[float]] = {"plain": [], "re-aim": []}
    for _ in range(200):
        rest, goal = tuple(rng.uniform(-most, most)), rng.normal(size=3)
        limits = [(-float(angle), float(angle)) for angle in most]
        chain = Chain([Joint("a", (0, 0, 0), (0, 0, 0), rest, *limits), Joint("b", (0, 0, 10.0))])
        before = degrees_between(forward_kinematics(chain, chain.rest)[0][-1], goal)
        for clamp, found in left.items():
            end = solve(chain, goal, clamp=clamp, max_iterations=-1).positions[-1]
            found.append(float(degrees_between(end, goal)))
            assert clamp == "plain" or found[-1] <= before + 1e-9
    assert np.median(left["re-aim"]) < 0.9 * np.median(left["plain"])
