"""The bend vector over time: forbidden cone, smoothing, and coming back to the same pose."""

from itertools import product
from typing import Any

import numpy as np
import pytest

from limbik.tests.limbs import Array, ball, degrees_between, solver

LIMB = ball(20.0, 20.0, 20.0)
AXES = {"x": 0, "y": 1, "z": 2}
MODES: list[dict[str, Any]] = [
    {"use": "manual", "angle": 77.0},
    {"use": "auto", "angle": -20.0, "strength": 1.0},
    {"use": "global", "direction": [0.3, -0.9, 0.5]},
]


def wander(seed: int, steps: int = 40) -> Array:
    """Return a random walk of goals about the limb."""
    steps_taken = np.random.default_rng(seed).normal(size=(steps, 3)) * 4.0
    walk: Array = np.add(np.cumsum(steps_taken, axis=0), [0.0, 0.0, 30.0])
    return walk


def axis_of(name: str) -> Array:
    axis = np.zeros(3)
    axis[AXES[name[0]]] = 1.0 if name[1] == "+" else -1.0
    return axis


@pytest.mark.parametrize("entry", ["stop", "go-around"])
@pytest.mark.parametrize("mode", MODES, ids=lambda mode: str(mode["use"]))
@pytest.mark.parametrize("smoothing", [0.0, 3.0, 30.0])
def test_the_bend_vector_is_never_inside_the_forbidden_cone(
    entry: str, mode: dict[str, Any], smoothing: float
) -> None:
    """E-11D, 3D A-16 to A-18: in every mode, along walks, with and without smoothing (E-11I)."""
    entered = 0
    for number, (axis, half) in enumerate(product(("x+", "y+", "y-", "z-"), (10.0, 45.0, 90.0))):
        goals = wander(number)
        cone = {"axis": axis, "half_angle": half, "entry": entry}
        options: dict[str, Any] = {"bend_vector": mode, "bend_smoothing": smoothing}
        found = solver(LIMB, forbidden_cone=cone, **options).follow(goals).bend_vector
        free = solver(LIMB, **options).follow(goals).bend_vector
        entered += int((degrees_between(free, axis_of(axis)) < half).sum())
        assert degrees_between(found, axis_of(axis)).min() >= half - 1e-9
        if smoothing:
            assert degrees_between(found[1:], found[:-1]).max() <= smoothing + 1e-6
    assert entered > 20  # without the cone these would have been inside


def test_stop_turns_out_to_the_previous_side_and_go_around_to_the_new_one() -> None:
    """E-11D: at the rim, in the plane of the cone's axis and of that vector."""
    goal = (0.0, 0.0, 30.0)
    before = solver(LIMB, bend_vector={"use": "manual", "angle": -60.0}).solve(goal)
    for entry, side in (("stop", -50.0), ("go-around", 50.0)):
        cone = {"axis": "y+", "half_angle": 50.0, "entry": entry}
        run = solver(LIMB, bend_vector={"use": "manual", "angle": 10.0}, forbidden_cone=cone)
        found = run.solve(goal, continuity=before.continuity).bend_vector
        assert np.degrees(np.arctan2(found[0], found[1])) == pytest.approx(side, abs=1e-6)


@pytest.mark.parametrize("mode", MODES, ids=lambda mode: str(mode["use"]))
@pytest.mark.parametrize("most", [0.5, 10.0, 45.0])
def test_the_bend_vector_turns_by_no_more_than_its_smoothing_in_a_solve(
    mode: dict[str, Any], most: float
) -> None:
    """E-11I: the whole angle while far, the rest when near."""
    goals = wander(9)
    start = solver(LIMB, bend_vector={"use": "manual", "angle": 200.0}).solve(goals[0])
    run = solver(LIMB, bend_vector=mode, bend_smoothing=most)
    found = run.follow(goals, continuity=start.continuity).bend_vector
    steps = degrees_between(found, np.concatenate([start.bend_vector[None], found[:-1]]))
    assert steps.max() <= most + 1e-6
    gap = degrees_between(
        solver(LIMB, bend_vector=mode).solve(goals[0]).bend_vector, start.bend_vector
    )
    assert steps[0] == pytest.approx(min(most, gap), abs=1e-6)


def test_smoothing_arrives_where_the_bend_vector_would_be_without_it() -> None:
    """E-11I: 100° in steps of 30° is done in four solves."""
    goal = (0.0, 0.0, 30.0)
    run = solver(LIMB, bend_vector={"use": "manual", "angle": 100.0}, bend_smoothing=30.0)
    past = solver(LIMB).solve(goal).continuity
    turned = []
    for _ in range(5):
        solution = run.solve(goal, continuity=past)
        past = solution.continuity
        x, y, _ = solution.bend_vector
        turned.append(float(np.degrees(np.arctan2(x, y))))
    assert turned == pytest.approx([30.0, 60.0, 90.0, 100.0, 100.0])


def loops(count: int, steps: int = 120) -> Array:
    """Return goals on circles of radius 20 at a distance of 30 about the shoulder's axis."""
    t = np.linspace(0.0, 2.0 * np.pi * count, steps * count + 1)
    circle: Array = np.stack([20.0 * np.cos(t), 20.0 * np.sin(t), np.full_like(t, 30.0)], axis=1)
    return circle


def test_a_goal_that_circles_the_shoulder_comes_back_to_the_same_pose() -> None:
    """M-02, 3D A-39: stateless and with continuity, three times round, to 1e-6°."""
    run = solver(LIMB)
    followed = run.follow(loops(3)).angles
    alone = run.solve_many(loops(3)).angles
    for turn in (120, 240, 360):
        assert np.degrees(np.abs(followed[turn] - followed[0]).max()) < 1e-6
        assert np.degrees(np.abs(alone[turn] - followed[0]).max()) < 1e-6


def test_aiming_from_the_previous_pose_drifts_by_the_solid_angle_of_the_path() -> None:
    """3D A-39: 2π(1 - 30/√1300) = 60.5° a loop; the price of the document's parallel transport."""
    found = solver(LIMB, aim_from="previous").follow(loops(2)).bend_vector
    solid = 360.0 * (1.0 - 30.0 / np.sqrt(1300.0))
    assert solid == pytest.approx(60.5, abs=0.1)
    assert degrees_between(found[0], found[120]) == pytest.approx(solid, abs=0.5)
    assert degrees_between(found[0], found[240]) == pytest.approx(2.0 * solid, abs=1.0)


def test_bank_suppression_leaves_every_bank_alone_within_its_angle() -> None:
    """E-11G: the last joint's vector to the end is its Z axis, so no round turns its bank."""
    vector = {"use": "manual", "angle": 50.0}
    options: dict[str, Any] = {"max_iterations": 30, "tolerance": 1e-6, "bend_vector": vector}
    options["reference_axis"] = "free"
    kept = solver(LIMB, bank_suppression={"use": "threshold", "angle": 2.0}, **options)
    free = solver(LIMB, **options)
    twisted = 0
    for goal in wander(3, 20):
        banks = []
        for run in (kept, free):
            trace = run.solve(goal, trace=True).trace
            assert trace is not None
            banks.append(np.array([stage.angles[2, 2] for stage in trace[2:]]))
        np.testing.assert_allclose(banks[0], banks[0][0], atol=1e-9)
        twisted += int(np.ptp(banks[1]) > 1e-3)
    assert twisted > 10
