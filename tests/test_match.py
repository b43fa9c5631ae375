"""IK and FK take over from each other, and bend-vector modes too, without a jump."""

from math import radians
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError
from limbik.core.match import Mode, convert_bend_vector, match_fk, match_ik
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.solver import Solver

Array = NDArray[np.float64]
REGISTRY = Registry(third_party=False)
SMALL = radians(0.01)
MODES: tuple[Mode, ...] = ("manual", "global")


def arm(**options: Any) -> Solver:
    """A ball shoulder on a turned base and a hinge elbow."""
    elbow: dict[str, Any] = {"heading": (0, 0), "pitch": (0, 145), "bank": (0, 0)}
    joints = [
        Joint.degrees("shoulder", frozen=(20, 10, 30)),
        Joint.degrees("elbow", (0, 0, 0.52), **elbow),
        Joint("wrist", (0, 0, 0.48)),
    ]
    chain = Chain(joints, (0.1, 0.2, 0.3), (0.4, -0.2, 0.1))
    given: dict[str, Any] = {"initial_bend": "solved-arc", "tolerance": 1e-9}
    return Solver(chain, registry=REGISTRY, **(given | {"reference_axis": "y-"} | options))


def poses(count: int = 50, straight: int = 10) -> list[Array]:
    """Random poses of the arm, some of them dead straight."""
    rng = np.random.default_rng(10)
    found = []
    for k in range(count):
        pose = np.zeros((3, 3))
        pose[0] = rng.uniform(-1.2, 1.2, 3)
        pose[1, 1] = 0.0 if k < straight else rng.uniform(0.05, 2.5)
        found.append(pose)
    return found


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("axis", ["y-", "x+", "free"])
def test_ik_takes_over_an_fk_pose_without_a_jump(mode: Mode, axis: str) -> None:
    for pose in poses():
        found = match_ik(arm(reference_axis=axis), pose, mode)
        assert found.difference < SMALL
        _, rotations = forward_kinematics(found.solver.chain, pose)
        np.testing.assert_allclose(found.solution.rotations[:-1], rotations[:-1], atol=SMALL)
        choice = found.solver.settings.bend_vector
        assert isinstance(choice, dict)
        assert choice["use"] == mode


def test_the_matched_bend_vector_points_to_the_elbow() -> None:
    for pose in poses(straight=0):
        found = match_ik(arm(), pose)
        positions, _ = forward_kinematics(found.solver.chain, pose)
        line = positions[2] - positions[0]
        assert found.bend_vector @ line == pytest.approx(0.0, abs=1e-12)
        assert found.bend_vector @ (positions[1] - positions[0]) > 0.0
        np.testing.assert_allclose(found.goal, positions[-1])


def test_fk_takes_over_an_ik_pose_and_gives_it_back() -> None:
    """Match to FK, mix from 0 to 1, match back: the pose stays, the plane too."""
    solver = match_ik(arm(), poses()[20]).solver
    goal = forward_kinematics(solver.chain, poses()[20])[0][-1]
    before = solver.solve(goal)
    offsets = match_fk(solver.chain, before.angles)

    for mix in (0.0, 0.3, 0.7, 1.0):
        given = solver.settings.model_dump(exclude_unset=True)
        mixed = Solver(
            solver.chain, registry=REGISTRY, **(given | {"fk_mix": mix, "fk_strength": 0.0})
        )
        np.testing.assert_allclose(
            mixed.solve(goal, fk_offsets=offsets).rotations, before.rotations, atol=1e-9
        )
    switched = Solver(solver.chain, registry=REGISTRY, **(given | {"ik": False}))
    after = switched.solve(goal, fk_offsets=offsets)
    np.testing.assert_allclose(after.rotations, before.rotations, atol=1e-9)
    back = match_ik(arm(), after.angles)
    np.testing.assert_allclose(back.bend_vector, before.bend_vector, atol=1e-6)


def test_offsets_count_from_a_rest_pose_inside_the_limits() -> None:
    joints = [Joint("a", rest=(0.3, 0, 0)), Joint.degrees("b", (0, 0, 1), pitch=(10, 90))]
    chain = Chain([*joints, Joint("c", (0, 0, 1))])
    angles = np.array([[0.5, 0.1, 0.0], [0.0, 0.6, 0.0], [0.0, 0.0, 0.0]])
    solver = Solver(chain, registry=REGISTRY, ik=False)
    solution = solver.solve((0, 0, 1), fk_offsets=match_fk(chain, angles))
    np.testing.assert_allclose(solution.angles, angles, atol=1e-12)


@pytest.mark.parametrize("count", [4, 7])
@pytest.mark.parametrize("mode", MODES)
def test_a_pose_the_solver_made_itself_comes_back_from_any_limb(count: int, mode: Mode) -> None:
    offsets = [(0.0, 0.0, 0.0), *[(0.0, 0.0, 1.0 / (count - 1))] * (count - 1)]
    chain = Chain([Joint(f"j{k}", offset) for k, offset in enumerate(offsets)])
    options: dict[str, Any] = {"initial_bend": "uniform-arc", "tolerance": 1e-9}
    vector = {"use": "manual", "angle": 70.0}
    solver = Solver(chain, registry=REGISTRY, bend_vector=vector, twist=25.0, **options)
    plain = Solver(chain, registry=REGISTRY, **options)
    for goal in np.random.default_rng(count).uniform(-0.45, 0.45, (12, 3)):
        pose = solver.solve(goal).angles
        assert match_ik(plain, pose, mode).difference < SMALL


@pytest.mark.parametrize("exclude_bank", [False, True])
@pytest.mark.parametrize("limited", [False, True])
def test_manual_and_global_are_exchanged_without_a_jump(exclude_bank: bool, limited: bool) -> None:
    solver = arm(bend_vector={"use": "manual", "angle": 33.0, "exclude_bank": exclude_bank})
    if limited:
        shoulder = Joint.degrees("shoulder", (0, 0, 0), (0, 0, 0), (0, 0, 20), (-40, 60), (-30, 50))
        chain = Chain([shoulder, *solver.chain.joints[1:]])
        solver = Solver(chain, solver.settings, REGISTRY)
    for goal in np.random.default_rng(4).uniform(-0.5, 0.5, (20, 3)):
        before = solver.solve(goal)
        world = convert_bend_vector(solver, goal, "global")
        back = convert_bend_vector(world, goal, "manual")
        for other in (world, back):
            after = other.solve(goal)
            np.testing.assert_allclose(after.bend_vector, before.bend_vector, atol=1e-9)
            np.testing.assert_allclose(after.positions, before.positions, atol=1e-6)


def test_a_conversion_holds_at_its_goal_and_the_modes_differ_elsewhere() -> None:
    solver = arm(bend_vector={"use": "manual", "angle": 33.0})
    world = convert_bend_vector(solver, (0.4, 0.5, 0.3), "global")
    there = (-0.2, 0.1, 0.9)
    assert np.abs(world.solve(there).bend_vector - solver.solve(there).bend_vector).max() > 0.01


def test_angles_that_are_not_finite_are_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        match_ik(arm(), np.full((3, 3), np.nan))
