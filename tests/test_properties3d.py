"""What holds for every chain, goal and option of the 3D solver."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import hpb_to_matrix
from limbik.core.settings import Settings
from limbik.core.solution import Solution
from limbik.core.solver import Solver
from limbik.tests.limbs import (
    ARM_OPTIONS,
    OPTIONS,
    REGISTRY,
    Array,
    arm,
    ball,
    chains,
    goals,
    interpreted,
    reachable,
    solver,
)


def built(chain: Chain, options: dict[str, Any]) -> Solver:
    """Return a solver, or pass over chains without length from the bend root on."""
    try:
        return solver(chain, **options)
    except ChainError:
        assume(False)
        raise


def poses(solution: Solution) -> list[tuple[Array, Array]]:
    """Return angles and positions of every stage and of the answer."""
    stages = [(stage.angles, stage.positions) for stage in solution.trace or ()]
    return [*stages, (solution.angles, solution.positions)]


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_bones_keep_their_length_in_every_stage(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    solution = built(chain, options).solve(data.draw(goals(chain)), trace=True)

    for _, positions in poses(solution):
        lengths = np.linalg.norm(np.diff(positions, axis=0), axis=1)
        np.testing.assert_allclose(lengths, chain.lengths, rtol=1e-12, atol=1e-12 * chain.length)


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_limits_hold_in_every_stage(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    offsets = np.full((len(chain), 3), 0.5)
    run = built(chain, options)
    path = [data.draw(goals(chain)) for _ in range(2)]
    first = run.solve(path[0], fk_offsets=offsets, trace=True)
    second = run.solve(path[1], fk_offsets=offsets, continuity=first.continuity, trace=True)

    for angles, _ in [*poses(first), *poses(second)]:
        assert (angles >= chain.low - 1e-9).all()
        assert (angles <= chain.high + 1e-9).all()


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_no_number_is_nan_and_free_angles_stay_within_180_degrees(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    solution = built(chain, options).solve(data.draw(goals(chain)))

    assert np.isfinite(solution.positions).all()
    assert (np.abs(solution.angles) <= np.pi + 1e-12).all()
    assert np.isfinite(solution.rotations).all()
    assert np.isfinite(solution.distance)
    assert np.isfinite(solution.bend_angle)
    length = np.linalg.norm(solution.bend_vector)
    assert length == pytest.approx(0.0 if options["max_iterations"] == -2 else 1.0)


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_the_answer_is_the_forward_kinematics_of_its_angles(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    goal = data.draw(goals(chain))
    solution = built(chain, options).solve(goal)
    positions, rotations = forward_kinematics(chain, solution.angles)

    np.testing.assert_allclose(solution.positions, positions, atol=1e-12 * chain.length)
    np.testing.assert_allclose(solution.rotations, rotations, atol=1e-12)
    distance = np.linalg.norm(solution.goal - positions[-1])
    assert solution.distance == pytest.approx(distance, rel=1e-12, abs=1e-12 * chain.length)


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_same_input_gives_the_same_bits_whatever_was_solved_before(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    goal, other = data.draw(goals(chain)), data.draw(goals(chain))
    run = built(chain, options)
    first = run.solve(goal)
    run.solve(other)
    again = run.solve(goal)
    elsewhere = built(chain, options).solve_many([other, goal], threads=1)

    assert first.angles.tobytes() == again.angles.tobytes() == elsewhere.angles[1].tobytes()
    assert first.positions.tobytes() == again.positions.tobytes()
    assert first.bend_vector.tobytes() == elsewhere.bend_vector[1].tobytes()


@given(data=st.data(), chain=chains(), options=OPTIONS)
def test_follow_is_a_loop_of_solve_with_continuity(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    run = built(chain, options)
    path = [data.draw(goals(chain)) for _ in range(3)]
    followed = run.follow(path)
    continuity = None
    for number, goal in enumerate(path):
        solution = run.solve(goal, continuity=continuity)
        continuity = solution.continuity
        assert solution.angles.tobytes() == followed.angles[number].tobytes()
        assert solution.status == np.asarray(followed.status)[number]
    assert continuity is not None
    assert followed.continuity is not None
    assert continuity.memory.tobytes() == followed.continuity.memory.tobytes()


@pytest.mark.parametrize("chain", [ball(20.0, 20.0, 20.0), arm()], ids=["ball", "arm"])
@pytest.mark.parametrize("threads", [1, 2, None])
def test_many_goals_give_bit_for_bit_what_single_ones_do(chain: Chain, threads: int | None) -> None:
    """600 goals are enough for two threads to be started."""
    run = solver(chain, **ARM_OPTIONS)
    wanted = reachable(chain, 600, 7)
    many = run.solve_many(wanted, threads=threads)

    for number, goal in enumerate(wanted):
        single = run.solve(goal)
        assert single.angles.tobytes() == many.angles[number].tobytes()
        assert single.distance == np.asarray(many.distance)[number]


MIRRORED_AXES = {"x+": "x-", "x-": "x+"}


def mirrored_options(options: dict[str, Any]) -> dict[str, Any]:
    """Return settings as the YZ plane shows them: angles about Y and Z and x change sign."""
    twin = dict(options)
    twin["twist"] = -options.get("twist", 0.0)
    axis = options.get("reference_axis", "y+")
    twin["reference_axis"] = MIRRORED_AXES.get(axis, axis)
    vector = options.get("bend_vector", {"use": "manual"})
    if vector["use"] == "global":
        x, y, z = vector["direction"]
        twin["bend_vector"] = {**vector, "direction": (-x, y, z)}
    else:
        twin["bend_vector"] = {**vector, "angle": -vector.get("angle", 0.0)}
    if cone := options.get("forbidden_cone"):
        axis = MIRRORED_AXES.get(cone["axis"], cone["axis"])
        twin["forbidden_cone"] = {**cone, "axis": axis}
    return twin


def comparable(options: dict[str, Any]) -> dict[str, Any]:
    """Leave out what turns rounding into another pose.

    Between angles 180° apart either way round is right for the FK mix, a twist by 180° leaves the
    two ends of the root's bank equally far, and a finish stops where its search first finds the
    goal. A chain that bends in a plane of its own has both ends of a range equally far when its
    goal lies behind: its bend is tilted.
    """
    left_out = {"fk_mix", "finish"} | (
        {"twist"} if abs(options.get("twist", 0.0)) == 180.0 else set()
    )
    vector = options.get("bend_vector", {"use": "manual"})
    if vector["use"] != "global":
        vector = {**vector, "angle": 0.9 * vector.get("angle", 0.0) + 7.0}
    kept = {key: value for key, value in options.items() if key not in left_out}
    return {**kept, "bend_vector": vector}


def generic_goal(data: st.DataObject, chain: Chain) -> Array:
    """Draw a goal in front, within reach, that lies on no axis and in no plane of symmetry.

    Behind, a range's ends can be equally far; then its upper end is taken, mirrored or not.
    """
    part = st.floats(0.1, 0.5).map(lambda value: round(value, 3))
    x, y = (data.draw(st.sampled_from([-1.0, 1.0])) * data.draw(part) for _ in range(2))
    return np.array([x, 0.83 * y, 1.21 * data.draw(part)]) * chain.length


@given(data=st.data(), chain=chains(generic=True), options=OPTIONS.map(comparable))
def test_a_mirrored_limb_takes_the_mirrored_pose(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    goal = generic_goal(data, chain)
    one = solver(chain, **options).solve(goal)
    other = solver(chain.mirrored(), **mirrored_options(options)).solve(goal * [-1, 1, 1])

    expected = one.positions * [-1, 1, 1]
    np.testing.assert_allclose(other.positions, expected, atol=1e-9 * chain.length)


@given(data=st.data(), chain=chains(generic=True), options=OPTIONS.map(comparable))
def test_moving_the_base_moves_the_result(
    data: st.DataObject, chain: Chain, options: dict[str, Any]
) -> None:
    if options.get("bend_vector", {}).get("use") == "global":
        options = {**options, "bend_vector": {"use": "manual"}}  # not fastened to the base
    turn, place = (0.7, -0.4, 2.1), (3.0, -40.0, 17.0)
    turned = hpb_to_matrix(turn)
    goal = generic_goal(data, chain)
    moved = Chain(chain.joints, place, turn)
    one = solver(chain, **options).solve(goal)
    other = solver(moved, **options).solve(turned @ goal + place)

    expected = one.positions @ turned.T + place
    np.testing.assert_allclose(other.positions, expected, atol=1e-9 * chain.length)


FIXED = ((0.0, 0.0),) * 3


def stiff() -> Chain:
    return Chain([Joint(f"j{k}", (0.0, 0.0, 10.0), (0, 0, 0), (0, 0, 0), *FIXED) for k in range(4)])


DEGENERATE: dict[str, tuple[Chain, tuple[float, float, float]]] = {
    "goal on the base": (ball(20.0, 20.0, 20.0), (0.0, 0.0, 0.0)),
    "goal on a joint": (ball(20.0, 20.0, 20.0), (0.0, 0.0, 20.0)),
    "goal on the end": (ball(20.0, 20.0, 20.0), (0.0, 0.0, 60.0)),
    "goal exactly behind": (ball(20.0, 20.0, 20.0), (0.0, 0.0, -35.0)),
    "goal straight above": (ball(20.0, 20.0, 20.0), (0.0, 35.0, 0.0)),
    "goal a hair beside the base": (ball(20.0, 20.0, 20.0), (1e-300, 0.0, 0.0)),
    "goal far away": (ball(20.0, 20.0, 20.0), (1e99, 0.0, 0.0)),
    "a bone without length": (ball(20.0, 0.0, 20.0), (5.0, 5.0, 20.0)),
    "only the last bone has length": (ball(0.0, 0.0, 20.0), (5.0, 5.0, 5.0)),
    "tiny bones": (ball(1e-8, 1e-8, 1e-8), (5e-9, 5e-9, 5e-9)),
    "huge bones": (ball(1e12, 1e12, 1e12), (5e11, 5e11, 5e11)),
    "all axes fixed": (stiff(), (5.0, 5.0, 20.0)),
    "2 joints": (ball(20.0), (5.0, 5.0, 5.0)),
    "256 joints": (ball(*[1.0] * 255), (50.0, 60.0, 70.0)),
}


@pytest.mark.parametrize("name", DEGENERATE)
@pytest.mark.parametrize("off_axis", [False, True])
@pytest.mark.parametrize("mode", ["manual", "auto", "global"])
def test_degenerate_input_gives_numbers(name: str, off_axis: bool, mode: str) -> None:
    chain, goal = DEGENERATE[name]
    run = solver(chain, off_axis=off_axis, bend_vector=mode, max_iterations=30)
    solution = run.solve(goal, trace=True)
    again = run.solve(goal, continuity=solution.continuity)

    for each in (solution, again):
        assert np.isfinite(each.positions).all()
        assert np.isfinite(each.angles).all()
        assert np.isfinite(each.bend_vector).all()
    lengths = np.linalg.norm(np.diff(solution.positions, axis=0), axis=1)
    np.testing.assert_allclose(lengths, chain.lengths, rtol=1e-12, atol=1e-12 * chain.length)


SAMPLE = """
import json, sys
from limbik.tests.test_properties3d import sample_poses
print(json.dumps(sample_poses()))
"""


def sample_poses() -> list[Any]:
    """Solve a few goals with many options on; used compiled and in the interpreter."""
    extras: list[dict[str, Any]] = [
        {},
        {"bend_vector": {"use": "auto", "strength": 0.7}, "bank_lock": True, "off_axis": True},
        {
            "root_control": "suppress-flip",
            "bank_suppression": {"use": "threshold", "heading_correction": True},
            "forbidden_cone": {"axis": "y+", "half_angle": 40.0, "entry": "go-around"},
            "bend_smoothing": 7.0,
            "clamp": "plain",
        },
        {"root_control": "prefer-flip", "max_violations": 2, "fk_mix": 0.2, "twist": 30.0},
    ]
    found = []
    for chain in (ball(20.0, 20.0, 20.0), arm()):
        for options in extras:
            run = Solver(chain, Settings(**(ARM_OPTIONS | options)), REGISTRY)
            found.append(run.follow(reachable(chain, 4, 3)).angles.tolist())
    return found


def test_the_interpreter_gives_what_compiled_code_gives() -> None:
    """With `NUMBA_DISABLE_JIT=1` the kernels are plain Python: same poses to 1e-12 rad."""
    for plain, compiled in zip(interpreted(SAMPLE), sample_poses(), strict=True):
        np.testing.assert_allclose(plain, compiled, rtol=0.0, atol=1e-12)
