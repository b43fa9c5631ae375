"""The leg of source 002: forward, level foot, tilts, and all eight branches of the inverse."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.plugins.solvers.lambda_leg.leg import MIRROR, LambdaLeg, level_pose
from limbik.plugins.solvers.lambda_leg.posture import (
    ankle_for_tilt,
    foot_posture,
    level_ankle,
    printed_offsets,
    shank_in_level,
    turn_x,
    turn_y,
)

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
FILE = FOLDER / "lambda_leg.json"
CASES = json.loads(FILE.read_text(encoding="utf-8"))["cases"] if FILE.exists() else []
LEG = LambdaLeg(1.0, 0.9)


def of(*kinds: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize(
        "case", [c for c in CASES if c["kind"] in kinds], ids=lambda case: case["id"]
    )


def turn(first: Any, second: Any) -> Any:
    """Size of the difference of angles modulo a turn [deg]."""
    return abs((np.asarray(first) - np.asarray(second) + 180.0) % 360.0 - 180.0)


def leg_of(case: dict[str, Any]) -> LambdaLeg:
    return LambdaLeg(case["input"]["l1"], case["input"]["l2"])


def pose_error(leg: LambdaLeg, angles: Any, ankle: Any, foot: Any) -> float:
    """Largest error of position and rotation of angles (..., 6)."""
    _, reached, turned = leg.forward(angles)
    return float(max(abs(reached - ankle).max(), abs(turned - foot).max()))


@of("fk")
def test_forward_kinematics_and_foot_posture_are_the_golden_ones(case: dict[str, Any]) -> None:
    given, expect = case["input"], case["expect"]
    j, bp, bt = np.radians(given["j"]), *np.radians([given["bp"], given["bt"]])
    knee, ankle, foot = leg_of(case).forward(j)
    torso = turn_y(bp) @ turn_x(bt)
    shank = shank_in_level(j, bp, bt)
    places = {"knee": knee, "ankle": ankle, "ankle_level": torso @ ankle, "shank_level": shank}
    for name, found in {**places, "foot": foot}.items():
        np.testing.assert_allclose(found, expect[name], atol=1.1e-9, err_msg=name)
    assert turn(np.degrees(foot_posture(torso @ foot)), expect["foot_rtp"]).max() < 1e-6
    for level, wanted in zip(level_ankle(shank), expect["level_all"], strict=True):
        assert turn(np.degrees([level.j5, level.j6, level.r]), wanted).max() < 1e-6
    offsets = [expect["printed_offsets"][name] for name in ("fp", "ft", "r")]
    assert turn(np.degrees(printed_offsets(j, shank)), offsets).max() < 1e-6


def pose_of(case: dict[str, Any]) -> tuple[Any, Any]:
    given = case["input"]
    if case["kind"] != "ik_level":
        return np.array(given["P"]), np.array(given["R"])
    bp, bt = np.radians([given["bp"], given["bt"]])
    return level_pose(given["P_level"], np.radians(given["rtp"]), bp, bt)


@of("ik", "ik_level")
def test_all_branches_are_the_golden_ones(case: dict[str, Any]) -> None:
    expect = case["expect"]
    ankle, foot = pose_of(case)
    found = leg_of(case).branches(ankle, foot)
    assert len(found.angles) == expect["count"]
    if not expect["count"]:
        assert found.status in ("too-far", "too-near")
        return
    for solution in expect["solutions"]:
        away = turn(np.degrees(found.angles), solution["j"]).max(axis=1)
        assert away.min() < 1e-5, solution["j"]  # the poses are given with nine digits


@of("ik_level")
def test_the_chosen_branch_is_the_natural_one(case: dict[str, Any]) -> None:
    solution = leg_of(case).solve(*pose_of(case))
    assert solution.status == "ok"
    assert turn(np.degrees(solution.angles), case["expect"]["natural"]).max() < 1e-7


@of("ik_singular")
def test_a_singular_pose_is_reached_and_named(case: dict[str, Any]) -> None:
    ankle, foot = pose_of(case)
    leg = leg_of(case)
    found = leg.branches(ankle, foot)
    assert len(found.angles) == case["expect"]["count"]
    named = {words.split(":")[0] for singular in found.singular for words in singular}
    assert {flag.split(":")[0] for flag in case["expect"]["flags"]} <= named
    for angles in found.angles:  # the golden pose is rounded to nine digits
        assert pose_error(leg, angles, ankle, foot) < 5e-9


@of("ankle_for_tilt")
def test_the_ankle_for_a_tilt_is_the_golden_one_and_gives_that_tilt(case: dict[str, Any]) -> None:
    given = case["input"]
    j, (bp, bt, t, p) = (
        np.radians(given["j"]),
        np.radians([given[k] for k in ("bp", "bt", "t", "p")]),
    )
    shank = shank_in_level(j, bp, bt)
    solutions = ankle_for_tilt(shank, t, p)
    expect = case["expect"]["solutions_j5_j6_r"]
    assert len(solutions) == len(expect)
    for ankle, wanted in zip(solutions, expect, strict=True):
        assert turn(np.degrees([ankle.j5, ankle.j6, ankle.r]), wanted).max() < 1e-6
        posture = foot_posture(shank @ turn_x(-ankle.j5) @ turn_y(-ankle.j6))
        assert turn(np.degrees(posture), np.degrees([ankle.r, t, p])).max() < 1e-6


def test_a_tilt_past_the_ankle_s_reach_has_no_solution() -> None:
    """With the shin leaning sideways by 60 degrees the foot tilts about x by 30 at most."""
    shank = shank_in_level(np.radians([60.0, 0.0, 0.0, 0.0]), 0.0, 0.0)
    assert ankle_for_tilt(shank, np.radians(31.0), 0.0) == ()
    assert len(ankle_for_tilt(shank, np.radians(29.0), 0.0)) == 2


def test_a_hundred_thousand_random_configurations_come_back() -> None:
    """One of the eight branches is the configuration itself, and the pose is met to 1e-9."""
    random = np.random.default_rng(2)
    angles = random.uniform(-np.pi, np.pi, (100_000, 6))
    _, ankle, foot = LEG.forward(angles)
    poses = np.concatenate([ankle[:, None], foot], axis=1)
    free = LambdaLeg(1.0, 0.9, np.full(6, -np.inf), np.full(6, np.inf))
    found, codes = np.empty_like(angles), np.empty((len(angles), 2))
    for row in range(len(angles)):
        solution = free._solve(poses[row : row + 1], angles[row].copy(), False)
        found[row], codes[row] = solution[0][0], solution[1][0]
    assert (codes[:, 0] == 0).all()
    assert pose_error(LEG, found, ankle, foot) < 1e-9
    # Nearest to itself: the same branch; its angles lose digits only beside singular poses.
    away = turn(np.degrees(found), np.degrees(angles)).max(axis=1)
    assert np.quantile(away, 0.999) < 1e-9
    assert away.max() < 1e-4


def test_all_eight_branches_make_the_pose_and_differ() -> None:
    random = np.random.default_rng(3)
    for angles in random.uniform(-np.pi, np.pi, (2000, 6)):
        _, ankle, foot = LEG.forward(angles)
        found = LEG.branches(ankle, foot)
        assert found.angles.shape == (8, 6)
        assert pose_error(LEG, found.angles, ankle, foot) < 1e-9
        for first in range(8):
            for second in range(first):
                assert turn(*np.degrees(found.angles[[first, second]])).max() > 1e-4


def test_nearness_decides_between_branches_and_limits_exclude() -> None:
    angles = np.radians([10.0, -25.0, 15.0, 50.0, -20.0, 5.0])
    _, ankle, foot = LEG.forward(angles)
    free = LambdaLeg(1.0, 0.9, np.full(6, -np.inf), np.full(6, np.inf))
    for branch in free.branches(ankle, foot).angles:
        np.testing.assert_allclose(free.solve(ankle, foot, branch).angles, branch, atol=1e-12)
    backward = free.branches(ankle, foot).angles[4]
    np.testing.assert_allclose(LEG.solve(ankle, foot, backward).angles, angles, atol=1e-9)
    low, high = np.radians([[-5.0, -180, -180, 0, -180, -180], [5.0, 180, 180, 180, 180, 180]])
    narrow = LambdaLeg(1.0, 0.9, low, high)
    solution = narrow.solve(ankle, foot)
    assert solution.status in ("ok", "beyond-limits")
    assert (solution.angles >= low).all()
    assert (solution.angles <= high).all()
    assert (
        LambdaLeg(1.0, 0.9, low, np.radians([5.0, 9, 9, 9, 9, 9])).solve(ankle, foot).status
        == "beyond-limits"
    )


SINGULAR = {
    "hip gimbal": (20.0, 90.0, 30.0, 60.0, -20.0, 5.0),
    "knee straight": (10.0, -25.0, 15.0, 0.0, -20.0, 5.0),
    "hip on the axis of j6": (10.0, -25.0, 15.0, 60.0, np.nan, 5.0),
}


@pytest.mark.parametrize("name", SINGULAR)
def test_every_singularity_is_named_and_undetermined_angles_stay(name: str) -> None:
    """Solved near the configuration itself, it comes back."""
    degrees = np.array(SINGULAR[name])
    if np.isnan(degrees[4]):  # turn the ankle until the hip is on the axis of j6
        j4 = np.radians(degrees[3])
        degrees[4] = -np.degrees(np.arctan2(-np.cos(j4) - 0.9, np.sin(j4)))
    angles = np.radians(degrees)
    _, ankle, foot = LEG.forward(angles)
    solution = LEG.solve(ankle, foot, angles)
    assert any(words.startswith(name) for words in solution.singular)
    assert pose_error(LEG, solution.angles, ankle, foot) < 1e-9
    np.testing.assert_allclose(solution.angles, angles, atol=1e-7)


def test_the_left_leg_is_the_right_one_mirrored() -> None:
    angles = np.radians([12.0, -30.0, 8.0, 55.0, -22.0, 6.0])
    _, right, right_foot = LEG.forward(angles)
    _, left, left_foot = LEG.forward(angles * MIRROR)
    flip = np.diag([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(left, flip @ right, atol=1e-12)
    np.testing.assert_allclose(left_foot, flip @ right_foot @ flip, atol=1e-12)


def test_a_pose_out_of_reach_stretches_the_leg_toward_it() -> None:
    solution = LEG.solve((0.0, 3.0, -3.0), np.eye(3))
    assert solution.status == "too-far"
    _, ankle, _ = LEG.forward(solution.angles)
    np.testing.assert_allclose(ankle, np.array([0.0, 1.0, -1.0]) * 1.9 / np.sqrt(2.0), atol=1e-6)
    assert LEG.solve((0.0, 0.0, 0.0), np.eye(3)).status == "too-near"


@pytest.mark.parametrize("lengths", [(0.0, 1.0), (1.0, -0.9), (float("inf"), 1.0)])
def test_a_leg_without_length_is_refused(lengths: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="need lengths above 0"):
        LambdaLeg(*lengths)


def test_a_pose_that_is_not_a_number_is_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        LEG.solve((0.0, float("nan"), -1.0), np.eye(3))
