"""Continuity is one plain value: got, set, reset, copied, made of a pose; and the getters."""

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.core.solution import Continuity
from limbik.tests.limbs import Array, ball, solver

LIMB = ball(20.0, 20.0, 20.0)
GOALS = [(10.0, 5.0, 40.0), (-8.0, 12.0, 35.0), (4.0, -20.0, 25.0)]


def test_a_fresh_continuity_solves_like_none() -> None:
    run = solver(LIMB, aim_from="previous", bend_smoothing=5.0)
    one, other = run.solve(GOALS[0]), run.solve(GOALS[0], continuity=Continuity.fresh(LIMB))
    assert one.angles.tobytes() == other.angles.tobytes()
    assert one.bend_vector.tobytes() == other.bend_vector.tobytes()


def test_a_solve_leaves_the_continuity_it_is_given_alone() -> None:
    run = solver(LIMB, aim_from="previous")
    before = run.solve(GOALS[0]).continuity
    assert before is not None
    kept = before.memory.copy()
    after = run.solve(GOALS[1], continuity=before).continuity
    assert before.memory.tobytes() == kept.tobytes()
    assert after is not None
    assert after.memory.tobytes() != kept.tobytes()


def test_continuity_holds_the_finished_pose_the_aim_and_the_bend_vector() -> None:
    solution = solver(LIMB).solve(GOALS[0], trace=True)
    assert solution.continuity is not None
    assert solution.trace is not None
    np.testing.assert_array_equal(solution.continuity.angles, solution.angles)
    np.testing.assert_array_equal(solution.continuity.bend_vector, solution.bend_vector)
    aim = solution.trace[1].angles
    np.testing.assert_allclose(solution.continuity.aim_base, aim[0], atol=1e-12)
    np.testing.assert_allclose(solution.continuity.aim_root, aim[0], atol=1e-12)


def test_reset_forgets_and_a_copy_does_not_notice() -> None:
    run = solver(LIMB, aim_from="previous")
    past = run.follow(GOALS).continuity
    assert past is not None
    copy = past.copy()
    past.reset()
    fresh = run.solve(GOALS[0]).angles
    assert run.solve(GOALS[0], continuity=past).angles.tobytes() == fresh.tobytes()
    assert run.solve(GOALS[0], continuity=copy).angles.tobytes() != fresh.tobytes()


def test_a_bend_vector_written_into_a_continuity_is_the_previous_one() -> None:
    """The property is a view: `hold_bend_vector` keeps what was put there."""
    given = Continuity.fresh(LIMB)
    given.bend_vector[:] = [1.0, 0.0, 0.0]
    solution = solver(LIMB, hold_bend_vector=True).solve(GOALS[0], continuity=given)
    np.testing.assert_allclose(solution.bend_vector, [1.0, 0.0, 0.0], atol=1e-15)


def test_a_pose_set_as_continuity_decides_the_form_of_the_angles() -> None:
    """From a pose turned by 180° in all of the base's angles the same rotation keeps that form."""
    run = solver(LIMB)
    plain = run.solve(GOALS[0]).angles
    pose = plain.copy()
    pose[0] = [plain[0, 0] - np.pi * np.sign(plain[0, 0]), np.pi - plain[0, 1], np.pi]
    found = run.solve(GOALS[0], continuity=Continuity.from_pose(pose)).angles
    assert abs(found[0, 1]) > np.pi / 2 > abs(plain[0, 1])


def test_from_pose_aims_from_the_base_and_the_root_of_the_pose() -> None:
    pose = np.arange(12.0).reshape(4, 3) / 10.0
    made = Continuity.from_pose(pose, bend_reference=2)
    np.testing.assert_array_equal(made.aim_base, pose[0])
    np.testing.assert_array_equal(made.aim_root, pose[1])
    np.testing.assert_array_equal(made.bend_vector, np.zeros(3))
    np.testing.assert_array_equal(made.angles, pose)


@pytest.mark.parametrize(
    ("pose", "reference", "message"),
    [
        (np.zeros((4, 2)), 1, "pose: expected shape (m, 3), found (4, 2)"),
        (np.full((4, 3), np.nan), 1, "pose: every number must be finite"),
        (np.zeros((4, 3)), 0, "bend_reference must be 1 to 3 for a pose of 4 joints, not 0"),
        (np.zeros((4, 3)), 4, "bend_reference must be 1 to 3 for a pose of 4 joints, not 4"),
    ],
)
def test_from_pose_refuses_what_is_no_pose(pose: Array, reference: int, message: str) -> None:
    with pytest.raises(InputError) as caught:
        Continuity.from_pose(pose, reference)
    assert message in str(caught.value)


def test_a_continuity_of_another_chain_is_refused() -> None:
    """The compiled code trusts its shape: a shorter one would be read past its end."""
    past = solver(ball(20.0, 20.0)).solve(GOALS[0]).continuity
    with pytest.raises(InputError, match="of a chain of 3 joints, this one has 4"):
        solver(LIMB).solve(GOALS[0], continuity=past)
    with pytest.raises(InputError, match="of a chain of 3 joints, this one has 4"):
        solver(LIMB).follow(GOALS, continuity=past)


def test_a_continuity_that_is_not_finite_is_refused() -> None:
    past = Continuity.fresh(LIMB)
    past.angles[0, 0] = np.nan
    with pytest.raises(InputError, match="continuity: every number must be finite"):
        solver(LIMB).solve(GOALS[0], continuity=past)


def test_a_solve_stopped_at_the_initial_pose_keeps_the_bend_vector() -> None:
    """3D A-46: the source wipes it there."""
    past = solver(LIMB).solve(GOALS[0]).continuity
    after = solver(LIMB, max_iterations=-2).solve(GOALS[1], continuity=past).continuity
    assert past is not None
    assert after is not None
    np.testing.assert_array_equal(after.bend_vector, past.bend_vector)


def test_getters_give_bend_direction_world_vector_and_positions() -> None:
    """E-14: asked for 40° from the root's Y axis, the aim pose says 40°."""
    options = {"bend_vector": {"use": "manual", "angle": 40.0}, "max_iterations": -1}
    solution = solver(LIMB, **options).solve(GOALS[0])
    x, y, _ = solution.rotations[0].T @ solution.bend_vector
    assert np.degrees(solution.bend_angle) == pytest.approx(40.0)
    assert np.degrees(np.arctan2(x, y)) == pytest.approx(40.0)
    assert solution.bend_vector @ GOALS[0] == pytest.approx(0.0, abs=1e-12)
    assert solution.positions.shape == (4, 3)
