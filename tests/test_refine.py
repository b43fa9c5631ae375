"""Pose goals by `refine`: reached within limits, the same each time, and truthful where not."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError, InputError
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import read_scene
from limbik.core.solution import Status
from limbik.plugins.solvers.refine.descent import Goal, measure
from limbik.plugins.solvers.refine.hinges import read_hinges, read_span
from limbik.plugins.solvers.refine.place import (
    ANGLE,
    MOVES,
    WIDTH,
    place,
    rotation_vector,
    write_motions,
)
from limbik.plugins.solvers.refine.solver import PoseSolver
from limbik.tests.limbs import interpreted

CONFIGS = Path(__file__).parents[1] / "configs"
EXACT = 1e-6
UNITS = {"arm7.yaml": 1.0, "weld.yaml": 0.01}
WRIST = np.zeros((7, 3))
WRIST[3, 2], WRIST[5, 2] = 60.0, 30.0
"""Turns of the welding arm's wrist [deg] that have a second fold within the limits."""
NONE = (0.0, 0.0, 0.0)
SAMPLE = "import json, test_refine as t; print(json.dumps(t.sample_poses()))"


def arm(name: str = "arm7.yaml") -> Chain:
    return read_scene(CONFIGS / name).chain


def poses(chain: Chain, count: int, seed: int = 1) -> tuple[Array, Array]:
    """Return positions and rotations of the end at random angles within the limits."""
    low, high = (np.clip(end, -np.pi, np.pi) for end in (chain.low, chain.high))
    angles = np.random.default_rng(seed).uniform(low, high, (count, len(chain), 3))
    places, turns = forward_kinematics(chain, angles)
    return places[:, -1].copy(), turns[:, -1].copy()


def errors(chain: Chain, angles: Array, places: Array, turns: Array) -> tuple[Array, Array]:
    """Return distances and angles left, by forward kinematics that the solver does not use."""
    found, turned = forward_kinematics(chain, angles)
    apart = np.linalg.norm(found[..., -1, :] - places, axis=-1)
    chord = np.linalg.norm(turned[..., -1, :, :] - turns, axis=(-1, -2)) / np.sqrt(8.0)
    return apart, 2.0 * np.arcsin(np.minimum(chord, 1.0))


def narrowed(chain: Chain, share: float) -> Chain:
    """Return a chain whose hinges keep a share of their ranges around their middles."""

    def less(limit: Any) -> Any:
        middle, half = (limit[0] + limit[1]) / 2.0, share * (limit[1] - limit[0]) / 2.0
        return middle - half, middle + half

    joints = [
        replace(j, heading=less(j.heading), pitch=less(j.pitch), bank=less(j.bank))
        for j in chain.joints
    ]
    return Chain(joints, chain.base_position, chain.base_turn)


@pytest.mark.parametrize("name", UNITS)
def test_reachable_poses_are_reached_to_a_micrometre_within_the_limits(name: str) -> None:
    chain, exact = arm(name), EXACT / UNITS[name]
    places, turns = poses(chain, 1000)
    found = PoseSolver(chain, tolerance=exact, angle=EXACT).solve_many(places, turns)
    apart, turned = errors(chain, found.angles, places, turns)
    met = (apart < exact) & (turned < EXACT)

    assert met.mean() >= 0.999
    assert (met == np.asarray(found.reached)).all()
    np.testing.assert_allclose(found.distance, apart, atol=1e-9)
    np.testing.assert_allclose(found.rotation_error, turned, atol=1e-9)
    assert (found.angles >= chain.low).all()
    assert (found.angles <= chain.high).all()


def test_a_goal_gives_the_same_bits_alone_and_among_others() -> None:
    solver = PoseSolver(arm())
    places, turns = poses(solver.chain, 40)
    many = solver.solve_many(places, turns)
    for row in (39, 0, 17):
        one = solver.solve(places[row], turns[row])
        np.testing.assert_array_equal(one.angles, many.angles[row])
        assert one.status == np.asarray(many.status)[row]


def sample_poses() -> list[Any]:
    """Solve a few poses, reachable and not; used compiled and in the interpreter."""
    chain = arm("weld.yaml")
    places, turns = poses(chain, 12)
    found = PoseSolver(chain, starts=4).solve_many(np.vstack([places[:10], 9 * places[10:]]), turns)
    return [found.angles.tolist(), np.asarray(found.status).tolist()]


def test_the_interpreter_gives_what_compiled_code_gives() -> None:
    angles, status = interpreted(SAMPLE)
    here = sample_poses()
    np.testing.assert_allclose(angles, here[0], atol=1e-6)
    assert status == here[1]


def test_a_pose_no_bones_span_is_out_of_reach() -> None:
    solver = PoseSolver(arm())
    place = [0.0, 0.3, 2.0]
    found = solver.solve(place, np.eye(3))
    apart, turned = errors(solver.chain, found.angles, np.array(place), np.eye(3))

    assert found.status == Status.OUT_OF_REACH
    assert found.distance == pytest.approx(apart)
    assert found.rotation_error == pytest.approx(turned, abs=1e-6)


def test_the_orientation_alone_can_put_a_pose_out_of_reach() -> None:
    """The flange reaches the place, but not from outside: the wrist would be beyond the bones."""
    solver = PoseSolver(arm())
    place = np.array([0.85, 0.34, 0.0])
    outward, inward = hpb_to_matrix(np.radians([[0.0, 0.0, 90.0], [0.0, 0.0, -90.0]]))
    found = solver.solve_many([place, place], np.array([outward, inward]))

    assert np.asarray(found.status).tolist() == [Status.REACHED, Status.OUT_OF_REACH]
    assert "turned off by" in found.notes[1]


@given(st.integers(0, 10_000))
def test_whatever_pose_an_arm_has_its_bones_span_it(seed: int) -> None:
    """Random axes and offsets, some parallel, some crossing: the shell is never too small."""
    rng = np.random.default_rng(seed)
    joints = []
    for k in range(7):
        turning = rng.integers(3)
        spans = [(-2.0, 2.5) if axis == turning else (0.0, 0.0) for axis in range(3)]
        offset = rng.normal(size=3) * (rng.random(3) < 0.5)
        frozen = rng.normal(size=3) * (rng.random() < 0.5)
        joints.append(Joint(f"j{k}", tuple(offset), tuple(frozen), NONE, *spans))
    still = (0.0, 0.0)
    joints.append(Joint("end", (0.3, 0.2, 0.5), (0.5, 0.0, 0.0), NONE, still, still, still))
    chain = Chain(joints, (1.0, 2.0, 3.0))
    span = read_span(read_hinges(chain))
    places, turns = poses(chain, 100, seed)
    apart = np.linalg.norm(places + turns @ span.hand[0] - span.start[0], axis=1)
    total, longest = span.bones

    assert (apart <= total + 1e-9).all()
    assert (apart >= 2.0 * longest - total - 1e-9).all()


def test_the_span_of_an_arm_is_that_of_shoulder_elbow_and_wrist() -> None:
    span = read_span(read_hinges(arm()))
    np.testing.assert_allclose(span.start, [[0.0, 0.34, 0.0]], atol=1e-12)
    np.testing.assert_allclose(span.bones, [0.8, 0.4], atol=1e-12)
    assert np.linalg.norm(span.hand) == pytest.approx(0.126)


def test_blocked_means_that_the_arm_without_limits_reaches_it() -> None:
    chain = arm()
    places, turns = poses(chain, 60)
    tight = PoseSolver(narrowed(chain, 0.3)).solve_many(places, turns)
    blocked = np.asarray(tight.status) == Status.BLOCKED
    free = Chain(
        [
            replace(
                j,
                pitch=j.pitch if j.pitch == (0.0, 0.0) else None,
                bank=j.bank if j.bank == (0.0, 0.0) else None,
            )
            for j in chain.joints
        ]
    )
    loose = PoseSolver(free).solve_many(places[blocked], turns[blocked])

    assert blocked.sum() > 30
    assert np.asarray(loose.reached).all()
    assert set(np.unique(tight.status)) <= {Status.REACHED, Status.BLOCKED}
    assert (tight.angles >= tight.chain.low).all()
    assert (tight.angles <= tight.chain.high).all()


def walk(chain: Chain, count: int, step: float) -> Array:
    """Return poses of a walk through the ranges, HPB, (count, n, 3) [rad]."""
    rng = np.random.default_rng(3)
    middle, half = (chain.high + chain.low) / 2.0, 0.6 * (chain.high - chain.low) / 2.0
    phase, rate = rng.uniform(0, 6.3, half.shape), rng.uniform(0.3, 1.0, half.shape)
    time = np.arange(count)[:, None, None] * step
    return middle + half * np.sin(phase + rate * time)


def test_a_path_is_followed_without_jumps() -> None:
    chain = arm()
    way = walk(chain, 2000, 0.002)
    places, turns = (part[:, -1] for part in forward_kinematics(chain, way))
    found = PoseSolver(chain, EXACT, EXACT).follow(places, turns, near=way[0])
    steps = np.abs(np.diff(found.angles, axis=0)).max(axis=(1, 2))

    assert np.asarray(found.reached).all()
    assert not np.asarray(found.jumped).any()
    assert steps.max() < 0.1  # the way passes a straight elbow and a straight wrist


def test_a_path_goes_on_in_the_pose_it_is_given() -> None:
    """The same goal has several folds; the one near the pose before is kept."""
    chain = arm("weld.yaml")
    one = chain.rest + np.radians(WRIST)
    place, turn = (part[-1] for part in forward_kinematics(chain, one))
    other = one.copy()
    other[3:6] -= np.radians([[0, 0, 180], [0, 2 * WRIST[4, 1] - 80, 0], [0, 0, 180]])
    solver = PoseSolver(chain, EXACT, EXACT)
    for fold in (one, other):
        found = solver.solve(place, turn, near=fold + 0.02)
        assert found.reached
        np.testing.assert_allclose(found.angles, fold, atol=1e-5)


def test_where_no_way_leads_on_the_jump_is_told() -> None:
    """The wrist has to turn on past its limit; only another fold goes on."""
    chain = narrowed(arm("weld.yaml"), 0.999)
    start = chain.rest + np.radians(WRIST)
    start[5, 2] = np.radians(150.0)
    place, turn = (part[-1] for part in forward_kinematics(chain, start))
    twists = np.radians(np.linspace(0.0, 60.0, 61))
    turns = turn @ hpb_to_matrix(np.stack([0 * twists, 0 * twists, twists], -1))
    found = PoseSolver(chain, EXACT, EXACT).follow(np.repeat(place[None], 61, 0), turns, near=start)

    assert np.asarray(found.reached).all()
    (row,) = np.flatnonzero(found.jumped)
    assert found.notes[row] == "another fold than before"


def test_without_an_orientation_the_position_alone_is_solved() -> None:
    solver = PoseSolver(arm(), 1e-9)
    places, turns = poses(solver.chain, 50)
    free = turns.copy()
    free[::2] = np.nan
    found = solver.solve_poses(places, free, False)

    assert np.asarray(found.reached).all()
    assert np.asarray(found.distance).max() < 1e-9
    assert (np.asarray(found.rotation_error)[::2] == 0.0).all()
    np.testing.assert_array_equal(found.angles[::2], solver.solve_many(places).angles[::2])


def test_the_weight_turns_the_end_a_share_of_the_way() -> None:
    chain = arm()
    places, turns = poses(chain, 20)
    left = {}
    for weight in (0.0, 0.25, 0.5, 1.0):
        found = PoseSolver(chain, weight=weight, starts=300).solve_many(places, turns)
        assert np.asarray(found.reached).mean() > 0.8
        met = np.asarray(found.reached)
        left[weight] = np.where(met, errors(chain, found.angles, places, turns)[1], np.nan)
    for weight in (0.25, 0.5, 1.0):
        both = np.isfinite(left[weight] + left[0.0])
        assert both.sum() > 10
        expected = (1.0 - weight) * left[0.0][both]
        np.testing.assert_allclose(left[weight][both], expected, atol=1e-3)


def test_a_tolerance_finer_than_the_usual_precision_is_met_without_more_starts() -> None:
    goals = poses(arm(), 100)
    usual, fine = (PoseSolver(arm(), t, t).solve_many(*goals) for t in (1e-6, 1e-12))

    assert np.asarray(fine.reached).all()
    np.testing.assert_array_equal(fine.iterations, usual.iterations)


def test_an_arm_of_five_hinges_is_refused() -> None:
    joints = list(arm("weld.yaml").joints)
    joints[5] = replace(joints[5], bank=(0.0, 0.0))
    with pytest.raises(ChainError, match="refine needs 6 axes that turn, or more; this chain has"):
        PoseSolver(Chain(joints))


@pytest.mark.parametrize(
    ("rotation", "words"),
    [
        (np.full((3, 3), np.nan), "finite"),
        (np.eye(4), "shape"),
        (np.diag([1.0, 1.0, -1.0]), "not mirror"),
        (1.01 * np.eye(3), "length 1"),
    ],
)
def test_what_is_no_rotation_is_refused(rotation: Array, words: str) -> None:
    with pytest.raises(InputError, match=words):
        PoseSolver(arm()).solve([0.3, 0.3, 0.3], rotation)


@pytest.mark.parametrize(
    "wrong",
    [{"tolerance": 0.0}, {"angle": np.nan}, {"weight": 1.5}, {"steps": 0}, {"starts": -1}],
)
def test_what_is_out_of_its_range_is_refused_by_name(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=f"{next(iter(wrong))}: must be"):
        PoseSolver(arm(), **wrong)


@given(st.integers(0, 10_000), st.floats(0.0, np.pi))
def test_the_rotation_vector_turns_one_rotation_into_the_other(seed: int, angle: float) -> None:
    rng = np.random.default_rng(seed)
    first = hpb_to_matrix(rng.uniform(-3.0, 3.0, 3))
    axis = rng.normal(size=3)
    axis /= np.linalg.norm(axis)
    skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    turn = np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew
    goal, before = (tuple(map(tuple, matrix.tolist())) for matrix in (turn @ first, first))
    found: Array = np.array(rotation_vector(goal, before))  # type: ignore[arg-type]

    if angle > np.pi - 1e-6:  # half a turn has two axes
        found *= np.sign(found @ axis)
    np.testing.assert_allclose(found, angle * axis, atol=1e-7)


@given(st.integers(0, 10_000))
def test_the_motions_are_the_derivatives_of_the_pose(seed: int) -> None:
    rng = np.random.default_rng(seed)
    chain = Chain(
        [Joint(f"j{k}", tuple(rng.normal(size=3)), tuple(rng.normal(size=3))) for k in range(3)],
        tuple(rng.normal(size=3)),
        tuple(rng.normal(size=3)),
    )
    hinges = read_hinges(chain)
    angles = rng.uniform(-3.0, 3.0, (3, 3))
    rows, step, room = np.zeros((9, WIDTH)), 1e-6, np.zeros(6)
    rows[:, ANGLE] = angles.ravel()
    end, frame = place(ANGLE, hinges, rows)
    positions, rotations = forward_kinematics(chain, angles)
    np.testing.assert_allclose(end, positions[-1], atol=1e-12)
    np.testing.assert_allclose(frame, rotations[-1], atol=1e-12)
    write_motions(end, 2.0, True, rows)
    expected = rows[:, MOVES : MOVES + 6].copy()
    for k in range(9):
        rows[k, ANGLE] += step
        ahead, turned = place(ANGLE, hinges, rows)
        rows[k, ANGLE] -= step
        measure(Goal(ahead, turned, True, 2.0), end, frame, room)
        np.testing.assert_allclose(room / step, expected[k], atol=1e-4)


def test_the_end_s_own_axes_take_part() -> None:
    """A hand that can turn follows the orientation (M-05); the rest of the arm stays."""
    joints = [
        Joint.degrees("shoulder", heading=(-90, 90), pitch=(-90, 90), bank=(-90, 90)),
        Joint.degrees("elbow", (0, 0, 30), heading=(0, 0), pitch=(0, 145), bank=(-80, 80)),
        Joint.degrees("hand", (0, 0, 26), heading=(-60, 60), pitch=(-60, 60), bank=(-60, 60)),
    ]
    chain = Chain(joints)
    places, turns = poses(chain, 200)
    found = PoseSolver(chain, EXACT, EXACT).solve_many(places, turns)
    assert np.asarray(found.reached).mean() >= 0.99
