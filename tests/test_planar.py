"""Planar CCD and FABRIK of source 001: the article's variants, and what can be reached is."""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.core.rotation import Array
from limbik.plugins.solvers.planar import solve as kernels
from limbik.plugins.solvers.planar.arm import PlanarArm

FOLDER = Path(os.environ.get("LIMBIK_GOLDEN") or Path(__file__).parent / "golden")
FILE = FOLDER / "planar.json"
CASES = json.loads(FILE.read_text(encoding="utf-8"))["cases"] if FILE.exists() else []
OUT_OF_REACH = 2


def of(kind: str) -> pytest.MarkDecorator:
    cases = [case for case in CASES if case["kind"] == kind]
    return pytest.mark.parametrize("case", cases, ids=lambda case: case["id"])


def method_of(name: str) -> str:
    return name.replace("_fwd", "_forward").replace("_", "-")


def turn(first: Any, second: Any) -> Any:
    """Size of the difference of angles modulo a turn [deg]."""
    return abs((np.asarray(first) - np.asarray(second) + 180.0) % 360.0 - 180.0)


def one_sided(low: float, high: float, links: int) -> PlanarArm:
    return PlanarArm(np.ones(links), np.radians(low), np.radians(high))


ARMS: dict[str, Callable[[int], PlanarArm]] = {
    "article": PlanarArm.article,
    "0..120": lambda links: one_sided(0.0, 120.0, links),
    "10..100": lambda links: one_sided(10.0, 100.0, links),
    "free": lambda links: PlanarArm(np.ones(links)),
}


def reachable_goals(arm: PlanarArm, count: int) -> Array:
    """Goals sampled by forward kinematics inside the limits."""
    free = np.isinf(arm.high)
    low, high = np.where(free, -np.pi, arm.low), np.where(free, np.pi, arm.high)
    random = np.random.default_rng(1)
    return arm.places(random.uniform(low, high, (count, len(low))))[:, -1]


@of("conv_theta")
def test_the_article_s_wrap_is_the_golden_one(case: dict[str, Any]) -> None:
    found = np.degrees(kernels.wrapped(float(np.radians(case["input"]["deg"]))))
    assert found == pytest.approx(case["expect"]["deg"], abs=case["tol"])


@of("angle_limit")
def test_both_clamps_are_the_golden_ones(case: dict[str, Any]) -> None:
    angle, low, high = np.radians([case["input"]["relative"], *case["input"]["limits"]]).tolist()
    for name, printed in (("printed", True), ("nearest", False)):
        found = np.degrees(kernels.clamped(angle, low, high, printed))
        assert turn(found, case["expect"][name]) < 1e-9, name


@of("backward2")
def test_one_link_pulled_to_a_goal_is_clamped_as_printed(case: dict[str, Any]) -> None:
    """The printed method for one link: direction, clamp, then the near end from the goal."""
    given, expect = case["input"], case["expect"]
    goal, near = np.array(given["target"]), np.array(given["a"])
    low, high = np.radians(given["limits"]).tolist()
    direction = float(np.arctan2(*(goal - near)[::-1]))
    before = float(np.radians(given["prev"]))
    angle = before + kernels.clamped(direction - before, low, high, True)
    end = goal - given["length"] * np.array([np.cos(angle), np.sin(angle)])
    assert turn(np.degrees(angle), expect["angle"]) < 1e-9
    np.testing.assert_allclose(end, expect["a"], atol=1e-9)
    np.testing.assert_allclose(goal, expect["b"], atol=1e-9)


@of("one_sweep")
def test_one_sweep_is_the_golden_one(case: dict[str, Any]) -> None:
    given = case["input"]
    arm = PlanarArm.article(len(given["lengths"]))
    start = np.radians(given["start_relative"])
    pose, used, _ = arm.sweeps(method_of(given["method"]), given["target"], start, -1.0, 1)
    assert used == 1
    assert turn(np.degrees(pose), case["expect"]["relative"]).max() < 2e-9
    np.testing.assert_allclose(arm.places(pose)[-1], case["expect"]["tip"], atol=2e-9)


@of("solve")
def test_goals_are_decided_and_reached_as_the_golden_cases_say(case: dict[str, Any]) -> None:
    given, expect = case["input"], case["expect"]
    arm = PlanarArm.article(len(given["lengths"]))
    assert arm.is_reachable(given["target"]) == expect["reachable"]
    for method in ("ccd", "fabrik"):
        result = arm.solve([given["target"]], method)
        assert bool(result.reached[0]) == expect["robust_reached"]
        assert (result.status[0] == OUT_OF_REACH) == (not expect["reachable"])
    if expect.get("best_margin") is not None:
        margin = np.degrees(arm.best_margin(given["target"]))
        assert margin == pytest.approx(expect["best_margin"], abs=case["tol"]["margin"])


@of("solve")
def test_the_article_s_own_methods_end_where_the_golden_cases_say(case: dict[str, Any]) -> None:
    given = case["input"]
    arm = PlanarArm.article(len(given["lengths"]))
    start = np.zeros(len(given["lengths"]))
    start[0] = np.pi / 2
    for name, expect in case["expect"].items():
        if not name.startswith("printed_"):
            continue
        method = method_of(name.removeprefix("printed_"))
        _, _, left = arm.sweeps(method, given["target"], start, 1e-3, given["max_sweeps"])
        assert (left <= 1e-3) == expect["reached"], name
        if expect["error"] is not None:
            assert left == pytest.approx(expect["error"], abs=1e-6), name


@pytest.mark.parametrize("method", ["ccd", "fabrik"])
@pytest.mark.parametrize("links", [2, 3, 4, 5, 8])
@pytest.mark.parametrize("limits", ARMS)
def test_every_goal_that_can_be_reached_is_reached_within_limits(
    limits: str, links: int, method: str
) -> None:
    """1,000 goals from forward kinematics; the article's own loops reach 50 to 99 %."""
    arm = ARMS[limits](links)
    goals = reachable_goals(arm, 1000)
    result = arm.solve(goals, method)

    assert result.reached.all()
    assert np.linalg.norm(arm.places(result.angles)[:, -1] - goals, axis=1).max() <= 1e-3
    assert (result.angles >= arm.low).all()
    assert (result.angles <= arm.high).all()


def scan(arm: PlanarArm, goals: Array) -> Array:
    """Decide reach by brute force for three links: the first joint in steps of 0.02 degrees."""
    steps = np.linspace(arm.low[0], arm.high[0], 9001)
    found = np.zeros(len(goals), bool)
    first = arm.lengths[0] * np.stack([np.cos(steps), np.sin(steps)], axis=-1)
    a, b = arm.lengths[1:]
    for row, goal in enumerate(goals):
        away = goal - first
        cosine = ((away**2).sum(axis=-1) - a * a - b * b) / (2.0 * a * b)
        bend = np.arccos(np.clip(cosine, -1.0, 1.0))
        for third in (bend, -bend):
            inner = np.arctan2(b * np.sin(third), a + b * np.cos(third))
            second = np.arctan2(away[:, 1], away[:, 0]) - inner - steps
            second = (second + np.pi) % (2.0 * np.pi) - np.pi
            ok = (abs(cosine) <= 1.0) & (second >= arm.low[1]) & (second <= arm.high[1])
            found[row] |= bool((ok & (third >= arm.low[2]) & (third <= arm.high[2])).any())
    return found


@pytest.mark.parametrize("limits", ["article", "0..120", "10..100"])
def test_the_verdict_is_that_of_brute_force(limits: str) -> None:
    """Goals all over the disc; left out are those a hundredth of a degree decides about."""
    arm = ARMS[limits](3)
    random = np.random.default_rng(7)
    radius, way = 3.1 * np.sqrt(random.random(300)), random.uniform(-np.pi, np.pi, 300)
    goals = np.stack([radius * np.cos(way), radius * np.sin(way)], axis=-1)
    clear = np.array([abs(np.degrees(arm.best_margin(goal))) > 0.05 for goal in goals])
    verdict = np.array([arm.is_reachable(goal) for goal in goals])
    expected = scan(arm, goals)

    assert clear.mean() > 0.9
    assert 20 < expected.sum() < 280
    np.testing.assert_array_equal(verdict[clear], expected[clear])
    result = arm.solve(goals)
    np.testing.assert_array_equal(result.reached[clear], expected[clear])
    np.testing.assert_array_equal(result.status[clear] == OUT_OF_REACH, ~expected[clear])


def test_four_links_never_call_a_goal_out_of_reach_that_is_not() -> None:
    for limits in ("article", "0..120", "10..100"):
        arm = ARMS[limits](4)
        assert all(arm.is_reachable(goal) for goal in reachable_goals(arm, 300))


def eight(size: float) -> Array:
    t = np.linspace(0.0, 2.0 * np.pi, 400)
    return np.stack([1.5 * size * np.sin(t), size * (1.6 + 0.6 * np.sin(2.0 * t))], axis=-1)


@pytest.mark.parametrize("links", [3, 4, 6])
def test_a_moving_goal_is_followed_with_bounded_steps(links: int) -> None:
    """A figure of eight in 400 frames, joints turning 5 degrees a frame at most (G-02)."""
    arm = PlanarArm.article(links)
    result = arm.solve(eight(links / 3.0), follow=True, step=np.radians(5.0))

    assert result.distance.max() < 0.05
    assert np.degrees(abs(np.diff(result.angles, axis=0)).max()) <= 5.0 + 1e-9


def test_without_a_bound_the_joints_may_jump() -> None:
    result = PlanarArm.article(3).solve(eight(1.0), follow=True)
    assert np.degrees(abs(np.diff(result.angles, axis=0)).max()) > 5.0


def test_a_range_across_180_is_a_range() -> None:
    """The article wraps it to one nobody can meet (reading A-2)."""
    arm = PlanarArm(np.ones(2), np.radians([0.0, 135.0]), np.radians([90.0, 225.0]))
    goals = reachable_goals(arm, 200)
    assert arm.solve(goals).reached.all()


def test_the_same_goals_give_the_same_poses() -> None:
    arm = one_sided(10.0, 100.0, 4)
    goals = reachable_goals(arm, 200)
    np.testing.assert_array_equal(arm.solve(goals).angles, arm.solve(goals).angles)


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: PlanarArm([1.0]), "two or more links"),
        (lambda: PlanarArm([1.0, -1.0]), "lengths above 0"),
        (lambda: PlanarArm([1.0, 1.0], 1.0, 0.0), "above its maximum"),
        (lambda: PlanarArm([1.0, 1.0]).sweeps("ccdd", (1, 1), (0, 0)), "no sweep is called"),
        (lambda: PlanarArm([1.0, 1.0]).solve([[np.nan, 0.0]]), "finite numbers"),
        (lambda: PlanarArm(np.ones(7)).is_reachable((1, 1)), "up to 6 links"),
    ],
)
def test_a_wrong_arm_or_goal_is_refused(build: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        build()
