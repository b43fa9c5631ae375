"""The cosine arm of source 004: every branch, never NaN, ticks that never wrap."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.errors import InputError
from limbik.plugins.output.servo import Servo
from limbik.plugins.solvers.cosine_arm import kernels
from limbik.plugins.solvers.cosine_arm.arm import CosineArm

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
FILE = FOLDER / "cosine_arm.json"
CASES = json.loads(FILE.read_text(encoding="utf-8"))["cases"] if FILE.exists() else []
INVERSE = [case for case in CASES if case["kind"] == "ik"]
FORWARD = [case for case in CASES if case["kind"] == "fk"]
ARM = CosineArm()
SERVOS = (Servo(id=1), Servo(id=2), Servo(id=3, direction=-1))
PRINTED = tuple(Servo(id=s.id, direction=s.direction, rounding="truncate") for s in SERVOS)


def ticks(servos: tuple[Servo, ...], angles: Any) -> list[int]:
    return [servo.tick(angle) for servo, angle in zip(servos, angles, strict=True)]


def agrees(found: list[int], expected: list[int | None]) -> bool:
    """Compare ticks; null stands for a conversion the printed program leaves undefined."""
    return all(e is None or f == e for f, e in zip(found, expected, strict=True))


def turn(first: Any, second: Any) -> Any:
    """Difference of angles modulo a turn [deg]."""
    return (np.asarray(first) - np.asarray(second) + 180.0) % 360.0 - 180.0


@pytest.mark.parametrize("case", INVERSE, ids=lambda case: case["id"])
def test_branches_are_the_golden_ones(case: dict[str, Any]) -> None:
    expect = case["expect"]
    found = ARM.branches(case["input"]["pos"])
    if expect["status"] == "unreachable":
        assert found.status != "ok"
        assert len(found.angles) == 0
        numbers = [found.distance, found.inner, found.outer, *found.nearest]
        wanted = [expect["distance"], expect["inner"], expect["outer"], *expect["nearest"]]
        np.testing.assert_allclose(numbers, wanted, atol=case["tol"])
        return
    assert found.status == "ok"
    assert len(found.angles) == len(expect["solutions"])
    for pose, solution in zip(np.degrees(found.angles), expect["solutions"], strict=True):
        assert abs(turn(pose, solution["deg"])).max() < case["tol"]
        assert len(found.singular) == len(solution["singular"])
        rounded = ticks(SERVOS, np.radians(solution["deg"]))
        assert rounded == solution["ticks_rounded"]
        in_range = all(s.accepts(t) for s, t in zip(SERVOS, rounded, strict=True))
        assert in_range == solution["in_range"]


@pytest.mark.parametrize("case", INVERSE, ids=lambda case: case["id"])
def test_the_first_branch_truncated_is_what_the_printed_program_commands(
    case: dict[str, Any],
) -> None:
    """Where it computes a number at all."""
    found = ARM.branches(case["input"]["pos"])
    if found.status == "ok":
        assert agrees(ticks(PRINTED, found.angles[0]), case["expect"]["printed_ticks"])


@pytest.mark.parametrize("case", FORWARD, ids=lambda case: case["id"])
def test_forward_kinematics_and_ticks_are_the_golden_ones(case: dict[str, Any]) -> None:
    angles = np.radians(case["input"]["deg"])
    np.testing.assert_allclose(ARM.forward(angles), case["expect"]["pos"], atol=case["tol"])
    assert agrees(ticks(PRINTED, angles), case["expect"]["printed_ticks"])
    assert ticks(SERVOS, angles) == case["expect"]["ticks_rounded"]


def test_the_printed_example_gives_the_printed_ticks() -> None:
    found = ARM.branches((70.0, 70.0, 130.0))
    assert ticks(PRINTED, found.angles[0]) == [665, 623, 284]


place = st.floats(-150.0, 150.0)


@given(x=place, y=place, z=place, yaw=st.floats(-3.0, 3.0))
def test_every_branch_reaches_the_goal_or_the_nearest_point(
    x: float, y: float, z: float, yaw: float
) -> None:
    found = ARM.branches((x, y, z), yaw)
    assert np.isfinite(found.angles).all()
    for pose in found.angles:
        np.testing.assert_allclose(ARM.forward(pose), (x, y, z), atol=1e-6)
    away = np.linalg.norm(found.nearest - [0.0, 0.0, ARM.shoulder])
    assert found.inner - 1e-9 <= away <= found.outer + 1e-9


def test_above_the_shoulder_the_yaw_is_the_one_given() -> None:
    found = ARM.branches((0.0, 0.0, 150.0), yaw=0.7)
    np.testing.assert_allclose(found.angles[:2, 0], 0.7)
    assert "D1" in found.singular[0]


def test_a_million_goals_give_no_nan_and_no_wrapped_tick() -> None:
    """Also beside the places where the printed program divides by zero."""
    random = np.random.default_rng(4)
    goals = random.uniform(-160.0, 230.0, (1_000_000, 3))
    goals[::10, 2] = 69.0
    goals[::11, :2] = 0.0
    goals[::13] = [0.0, 0.0, 69.0]
    span = np.radians([SERVOS[0].span, SERVOS[1].span, SERVOS[2].span])
    angles, codes = np.empty((len(goals), 3)), np.empty((len(goals), 2))
    low, high = np.ascontiguousarray(span[:, 0]), np.ascontiguousarray(span[:, 1])
    kernels.solve_goals(
        ARM.size, low, high, np.zeros(3), goals, False, np.empty((4, 3)), angles, codes
    )
    assert np.isfinite(angles).all()
    signs = np.array([servo.direction for servo in SERVOS])
    exact = 512.0 + signs * np.degrees(angles) * (1023.0 / 300.0)
    assert exact.min() > -0.5
    assert np.rint(exact).max() <= 1023
    reached = codes[:, 0] == kernels.OK
    assert 0.1 < reached.mean() < 0.9
    np.testing.assert_allclose(ARM.forward(angles[reached]), goals[reached], atol=1e-6)


@pytest.mark.parametrize("lengths", [(69.0, 0.0, 55.0), (69.0, 83.0, float("nan"))])
def test_an_arm_without_a_link_is_refused(lengths: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="need a length"):
        CosineArm(*lengths)
