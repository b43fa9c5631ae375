"""The 2D solver's options count, its degenerate cases end well, its errors say what is wrong."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError, InputError
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solution import Status
from limbik.core.solution2d import PlanarSolution, PlaneFrom
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D

REGISTRY = Registry(third_party=False)
GOAL, POLE = (14.0, -10.0, 40.0), (10.0, 80.0, 15.0)


def chain(lengths: tuple[float, ...] = (30, 26, 18), **last: Any) -> Chain:
    """A straight limb; keywords go to the joint after the base."""
    joints = [Joint.degrees("hip")]
    for number, length in enumerate(lengths):
        given = last if number == 0 else {}
        joints.append(Joint.degrees(f"j{number + 1}", (0.0, 0.0, float(length)), **given))
    return Chain(joints)


def solve(limb: Chain | None = None, goal: Any = GOAL, **options: Any) -> PlanarSolution:
    """Solve with some options, `fk` in degrees."""
    fk = options.pop("fk", None)
    pole = options.pop("pole", POLE)
    solver = Solver2D(limb or chain(), registry=REGISTRY, pole=pole, **options)
    return solver.solve(goal, fk_offsets=None if fk is None else np.radians(fk), trace=True)


def in_plane(solution: PlanarSolution) -> Any:
    return (solution.positions - solution.positions[0]) @ solution.plane


OPTIONS: list[dict[str, Any]] = [
    {"twist": 30.0},
    {"bend_reference": 0, "reference_axis": "x+"},
    {"reference_axis": "x+"},
    {"reference_axis": "x-"},
    {"reference_axis": "y-"},
    {"reference_axis": "free"},
    {"coefficient_base": 0.5, "max_iterations": 0},
    {"weight_range": (-0.5, 0.5), "max_iterations": 0},
    {"max_iterations": -1},
    {"max_iterations": 0},
    {"max_iterations": 3},
    {"smoothing": 0.5},
    {"tolerance": 5.0},
    {"held": {"base": 1}},
    {"held": {"end": 1}},
    {"held": {"base": 1, "bend_base": True}},
    {"held": {"end": 1, "bend_end": True}, "max_iterations": 0},
    {"fk": [[0, 0, 0], [0, 20, 0], [0, -10, 0], [0, 0, 0]]},
    {"fk": [[0, 0, 0], [0, 20, 0], [0, -10, 0], [0, 0, 0]], "fk_strength": 0.5},
    {"fk_mix": 0.5},
    {"ik": False},
    {"pole": (10.0, -80.0, 15.0)},
]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_every_option_changes_the_pose(options: dict[str, Any]) -> None:
    plain = {key: value for key, value in options.items() if key == "max_iterations"}
    if "fk_strength" in options:
        plain["fk"] = options["fk"]
    if len(options) == 1:
        plain = {}
    changed, usual = solve(**options), solve(**plain)

    assert np.abs(hpb_to_matrix(changed.angles) - hpb_to_matrix(usual.angles)).max() > 1e-3


def test_max_violations_drops_a_joint_that_keeps_hitting_its_limit() -> None:
    spans = (None, (-20.0, 20.0), (-20.0, 20.0), (-90.0, 90.0), None)
    limb = Chain(
        [
            Joint.degrees(f"j{k}", (0.0, 0.0, 20.0 if k else 0.0), planar=span)
            for k, span in enumerate(spans)
        ]
    )
    free, dropped = (solve(limb, (30.0, -20.0, 48.0), max_violations=most) for most in (0, 1))

    assert np.abs(free.planar_angles - dropped.planar_angles).max() > 1e-3


@pytest.mark.parametrize(
    ("axis", "column", "sign"), [("x+", 0, 1), ("x-", 0, -1), ("y+", 1, 1), ("y-", 1, -1)]
)
def test_the_reference_axis_faces_the_pole_in_the_aim_pose(
    axis: str, column: int, sign: int
) -> None:
    """Across the line base to goal; the twist turns it on from there."""
    for twist in (0.0, 40.0):
        solution = solve(chain((30, 26, 18), frozen=(10, 20, 90)), reference_axis=axis,
                         twist=twist, max_iterations=-1)  # fmt: skip
        faced = sign * solution.rotations[1, :, column] @ solution.plane
        assert np.degrees(np.arctan2(faced[2], faced[1])) == pytest.approx(-twist, abs=1e-9)


def test_the_ik_space_has_x_to_the_goal_and_the_pole_on_the_side_of_y() -> None:
    plane = solve().plane

    np.testing.assert_allclose(plane[:, 0], np.array(GOAL) / np.linalg.norm(GOAL), atol=1e-15)
    np.testing.assert_allclose(plane.T @ plane, np.eye(3), atol=1e-15)
    assert np.array(POLE) @ plane[:, 1] > 0
    assert np.array(POLE) @ plane[:, 2] == pytest.approx(0.0, abs=1e-12)


def test_positions_angles_and_planar_angles_tell_one_pose() -> None:
    limb = chain((30, 26, 18), rest=(5, -30, 10))
    solution = solve(limb)
    positions, rotations = forward_kinematics(limb, solution.angles)
    bones = np.diff(in_plane(solution)[:, :2], axis=0)
    ways = np.arctan2(bones[:, 1], bones[:, 0])

    np.testing.assert_allclose(positions, solution.positions, atol=1e-12)
    np.testing.assert_allclose(rotations, solution.rotations, atol=1e-12)
    np.testing.assert_allclose(solution.planar_angles[:-1], np.diff(ways, prepend=0.0), atol=1e-12)


def test_the_trace_holds_every_stage_of_the_source() -> None:
    solution = solve(max_iterations=3)
    assert solution.trace is not None

    names = [stage.name for stage in solution.trace]
    early = ["initial", "simple aim", "reference axis", "fk", "aim", "bend"]
    assert names == [*early, "round 1", "round 2", "round 3"]
    np.testing.assert_allclose(solution.trace[-1].positions, solution.positions, atol=1e-12)
    np.testing.assert_allclose(
        solution.trace[4].positions, solve(max_iterations=-1).positions, atol=1e-12
    )


def test_fk_behind_a_turned_frozen_frame_leaves_the_next_bone_alone() -> None:
    """A heading of the knee, seen by an ankle frozen by 90°: only the shin turns (2D 13)."""
    joints = [
        Joint.degrees("hip"),
        Joint.degrees("knee", (0.0, 0.0, 30.0)),
        Joint.degrees("ankle", (0.0, 0.0, 26.0), frozen=(90.0, 0.0, 0.0)),
        Joint.degrees("toe", (18.0, 0.0, 0.0)),
    ]
    limb = Chain(joints)
    offset = [[0, 0, 0], [20, 0, 0], [0, 0, 0], [0, 0, 0]]
    trace = solve(limb, fk=offset, max_iterations=-1).trace
    assert trace is not None
    before, after = (np.diff(trace[k].positions, axis=0) for k in (2, 3))

    def turn(bone: int) -> float:
        a, b = before[bone], after[bone]
        return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))

    assert [turn(bone) for bone in range(3)] == pytest.approx([0.0, 20.0, 0.0], abs=1e-6)


def test_a_goal_on_the_base_keeps_the_plane_it_had() -> None:
    solver = Solver2D(chain((30, 30, 30)), registry=REGISTRY, pole=POLE)
    before = solver.solve(GOAL)
    here = solver.solve((0.0, 0.0, 0.0), continuity=before.continuity)
    fresh = solver.solve((0.0, 0.0, 0.0))

    np.testing.assert_allclose(here.plane, before.plane, atol=1e-12)
    assert (here.plane_from, fresh.plane_from) == (PlaneFrom.PREVIOUS, PlaneFrom.REST)
    assert (here.remark, before.remark) == ("plane of the previous pose", "")
    np.testing.assert_allclose(fresh.plane[:, 0], [0.0, 0.0, 1.0])  # the rest pose's line
    assert np.isfinite(here.angles).all()
    assert np.isfinite(fresh.angles).all()


@pytest.mark.parametrize("pole", [(28.0, -20.0, 80.0), (0.0, 0.0, 0.0), (-14.0, 10.0, -40.0)])
def test_a_pole_on_the_line_keeps_the_last_plane_or_takes_the_reference_axis(pole: Any) -> None:
    solver = Solver2D(chain(), registry=REGISTRY, pole=POLE)
    before = solver.solve(GOAL)
    kept = solver.solve(GOAL, continuity=before.continuity, pole=pole)
    fresh = solver.solve(GOAL, pole=pole)

    np.testing.assert_allclose(kept.plane, before.plane, atol=1e-9)
    assert (kept.plane_from, fresh.plane_from) == (PlaneFrom.PREVIOUS, PlaneFrom.REST)
    assert fresh.reached
    assert fresh.plane[:, 1] @ [0.0, 1.0, 0.0] > 0.9  # the knee's Y axis at rest


def test_the_status_tells_goals_no_pose_gets_to() -> None:
    far, hole = (0.0, 0.0, 75.0), (0.0, 0.0, 30.0)
    unequal = chain((60, 10, 10))

    assert solve(goal=far).status == Status.OUT_OF_REACH
    assert solve(goal=far).distance == pytest.approx(1.0, abs=1e-9)
    assert solve(unequal, hole).status == Status.OUT_OF_REACH
    assert 10.0 <= solve(unequal, hole, max_iterations=200).distance < 10.2
    assert solve(goal=(0.0, 0.0, 60.0), max_iterations=1).status == Status.STOPPED
    assert solve(goal=(0.0, 0.0, 74.0)).status == Status.REACHED


def test_reach_limit_pulls_the_goal_to_where_the_end_gets() -> None:
    far = (0.0, 0.0, 100.0)

    assert solve(goal=far, reach_limit=True).status == Status.REACHED
    assert solve(goal=far).status == Status.OUT_OF_REACH


def test_one_link_aims_and_a_chain_without_a_turning_joint_only_aims() -> None:
    one = solve(chain((40,)))
    stiff = [Joint.degrees("a", planar=(0, 0)), Joint.degrees("b", (0, 0, 30.0), planar=(0, 0))]
    locked = solve(Chain([*stiff, Joint.degrees("c", (0, 0, 30.0))]))

    for solution, length in ((one, 40.0), (locked, 60.0)):
        end = length * np.array(GOAL) / np.linalg.norm(GOAL)
        np.testing.assert_allclose(solution.positions[-1], end, atol=1e-12)
    assert (one.status, locked.status) == (Status.OUT_OF_REACH, Status.BLOCKED)


def test_a_locked_base_leaves_the_bend_to_the_joints_after_it() -> None:
    joints = [Joint.degrees("a", planar=(0, 0))]
    joints += [Joint.degrees(f"b{k}", (0, 0, 20.0)) for k in range(4)]
    solution = solve(Chain(joints), (0.0, 0.0, 60.0), max_iterations=0)

    assert solution.planar_angles[0] == 0.0
    spread = np.arccos(40.0 / 60.0)
    assert solution.planar_angles[1] == pytest.approx(spread)
    assert solution.planar_angles[:4].sum() == pytest.approx(-spread)


def test_angles_stay_nearest_to_the_pose_before() -> None:
    """Round and round about the base, heading runs on instead of jumping by 360° (D-10)."""
    turn = np.linspace(0.0, 4.0 * np.pi, 200)
    path = 50.0 * np.stack([np.sin(turn), 0.0 * turn, np.cos(turn)], -1)
    solution = Solver2D(chain(), registry=REGISTRY, pole=(0.0, 80.0, 0.0)).follow(path)

    assert np.abs(np.diff(solution.angles, axis=0)).max() < 0.1
    assert abs(solution.angles[-1, 0, 0]) == pytest.approx(4.0 * np.pi, abs=1e-6)


def test_pitch_stands_in_for_a_planar_limit_and_y_minus_turns_it_over() -> None:
    def limits(axis: str, **joint: Any) -> list[float]:
        found = solve(chain(**joint), reference_axis=axis).planar_limits[:, 1]
        return [float(angle) for angle in np.degrees(found)]

    assert limits("y+", pitch=(-140, 5)) == pytest.approx([-140, 5])
    assert limits("y-", pitch=(-5, 140)) == pytest.approx([-140, 5])
    assert limits("y-", pitch=(-5, 140), planar=(-90, 0)) == pytest.approx([-90, 0])
    assert limits("y+", pitch=(-5, 140), planar=(-180, 180)) == [-np.inf, np.inf]


def test_limits_that_only_let_a_chain_bend_away_from_the_pole_turn_the_bend_over() -> None:
    limb = chain((30, 30, 10), planar=(5.0, 120.0))
    solution = solve(limb, max_iterations=100)

    assert in_plane(solution)[1, 1] < 0.0
    assert np.degrees(solution.planar_angles[1]) >= 5.0


def test_limits_touched_names_planar_joints() -> None:
    assert solve(chain(planar=(-20.0, 0.0)), (5, 5, 40)).limits_touched() == ("j1 planar",)


def test_many_and_single_solves_agree_to_the_bit() -> None:
    goals = np.random.default_rng(5).normal(size=(9, 3)) * 30.0
    solver = Solver2D(chain(planar=(-150.0, 0.0)), registry=REGISTRY, pole=POLE)
    many = solver.solve_many(goals)

    for row, goal in enumerate(goals):
        one = solver.solve(goal)
        np.testing.assert_array_equal(many.angles[row], one.angles)
        single = many.single(row)
        assert isinstance(single, PlanarSolution)
        assert (single.status, single.plane_from) == (one.status, one.plane_from)
        np.testing.assert_array_equal(single.plane, one.plane)


@pytest.mark.parametrize("name", ["nth-root"])
def test_both_solvers_get_the_same_bend_from_a_strategy(name: str) -> None:
    """From the base, toward one side: bone by bone the two solvers' initial bends agree."""
    straight = Solver(chain(), registry=REGISTRY, max_iterations=0, initial_bend=name)
    space = straight.solve(GOAL)
    pole = np.array(GOAL) + 90.0 * space.bend_vector
    plane = solve(pole=pole, max_iterations=0, initial_bend=name)

    np.testing.assert_allclose(plane.positions, space.positions, atol=1e-9)


def test_a_strategy_that_is_unknown_is_named() -> None:
    with pytest.raises(InputError, match="nth-rot"):
        solve(initial_bend="nth-rot")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"bend_vector": "auto"}, "bend_vector: belongs to the 3D solver; the pole gives the bend"),
        ({"off_axis": True}, "off_axis: belongs to the 3D solver"),
        ({"start": "current"}, "start: belongs to the 3D solver"),
        ({"finish": "other"}, "finish: belongs to the 3D solver; in 2D it can only be none"),
        ({"root_control": "none"}, "root_control: belongs to the 3D solver"),
        ({"max_iterations": -2}, "max_iterations: must be -1 or more in 2D, not -2"),
        ({"pole": (0.0, np.nan, 1.0)}, "pole: every number must be finite"),
        ({"pole": (0.0, 1.0)}, "pole: expected shape"),
        ({"goal": (np.inf, 0.0, 0.0)}, "goal: every number must be finite"),
    ],
    ids=str,
)
def test_a_bad_value_is_refused_with_its_name(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        solve(**options)


def test_a_reference_or_held_joint_that_is_not_there_is_refused() -> None:
    with pytest.raises(ChainError, match="bend_reference 4: this chain of 4 joints allows 0 to 3"):
        solve(bend_reference=4)
    with pytest.raises(ChainError, match="allows 1 to 3"):
        Solver(chain(), registry=REGISTRY, bend_reference=0)
    with pytest.raises(ChainError, match="held: 5 joints held"):
        solve(held={"base": 5})


def test_a_planar_range_across_180_is_refused() -> None:
    with pytest.raises(ChainError, match=r"planar range .* crosses ±180°"):
        chain(planar=(-200.0, 0.0))


def test_poles_and_turns_come_one_a_goal() -> None:
    solver = Solver2D(chain(), registry=REGISTRY, pole=POLE)
    with pytest.raises(InputError, match="poles: expected 2, one a goal, found 1"):
        solver.solve_many([GOAL, GOAL], poles=[POLE])
    with pytest.raises(InputError, match="goal turns: expected 2, one a goal, found 1"):
        solver.follow([GOAL, GOAL], goal_turns=[(0, 0, 0)])
