"""`limbik judge` with solvers of plug-ins, goals that are turned, and limits of joints' own."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from limbik.core.jointlimits import margin_of
from limbik.core.scene import Scene, read_scene, scene_from
from limbik.core.solution import Status
from limbik.core.yamlfile import read_yaml
from limbik.plugins.judging.catalogue import BY_NAME, METRICS
from limbik.plugins.judging.report import NOT_JUDGED, judge
from limbik.plugins.judging.run import NotJudged, run_scene
from limbik.tests.limbs import REGISTRY

CONFIGS = Path(__file__).parents[1] / "configs"
IK_AND_FK = {"round_trip", "mix_detour"}  # only limbik's own solver mixes them
NEVER = {"swivel_error", "rate_dependence"}  # of a scene
POSES = {"flips", "limit_error"}


def lamp() -> Scene:
    """FABRIK in 3D on an arc."""
    goals = "".join(
        f"  - {{position: [{10 * np.sin(a):.6f}, 5, {12 + 9 * np.cos(a):.6f}]}}\n"
        for a in np.linspace(0, 2, 12)
    )
    text = "limbik: 1\nsolver: fabrik\noptions: {tolerance: 0.001}\nchain:\n  joints:\n"
    text += "    - {name: a}\n    - {name: b, offset: [0, 0, 12], pitch: [-150, 150]}\n"
    text += "    - {name: c, offset: [0, 0, 9]}\n    - {name: d, offset: [0, 0, 7]}\n"
    return scene_from(read_yaml(text + "goals:\n" + goals, "lamp.yaml"), Path(), REGISTRY)


def scene(name: str) -> Scene:
    return lamp() if name == "lamp" else read_scene(CONFIGS / f"{name}.yaml", REGISTRY)


@pytest.mark.parametrize("name", ["planar", "cosine-arm", "lambda-leg", "arm7-pose", "lamp"])
def test_a_plugins_solver_is_judged_but_for_what_it_does_not_know(name: str) -> None:
    found = {verdict.metric.name: verdict for verdict in judge(scene(name), REGISTRY)}
    refused = {key for key, verdict in found.items() if verdict.word == NOT_JUDGED}
    assert refused >= IK_AND_FK | NEVER
    for key in IK_AND_FK:
        assert "knows no mix of IK and FK" in found[key].reason
    assert refused.isdisjoint(
        {"excess_error", "false_statuses", "unsound_poses", "stretch", "latency", "pops"}
        | {"history", "drift", "limit_excess", "acceleration"}
    )
    assert ("asymmetry" in refused) == (name == "cosine-arm")  # its shoulder is on one side
    assert found["false_statuses"].value == 0.0
    assert found["unsound_poses"].value == 0.0
    stretch, excess = found["stretch"].value, found["limit_excess"].value
    assert stretch is not None
    assert excess is not None
    assert stretch < 1e-9
    assert excess < 1e-6
    assert (refused >= POSES) == (name == "arm7-pose")


@pytest.mark.parametrize("name", ["arm7-pose", "planar", "lamp"])
def test_solvers_without_a_past_depend_on_none(name: str) -> None:
    run = run_scene(scene(name), REGISTRY)
    for key in ("history", "drift"):
        assert BY_NAME[key].measure(run) == pytest.approx(0.0, abs=1e-6)


def test_a_pose_solvers_mirror_image_is_turned_too() -> None:
    """Free joints alone have a chain that is its own image; a seven-hinge arm's is another arm."""
    assert BY_NAME["asymmetry"].measure(run_scene(scene("arm7-pose"), REGISTRY)) < 1e-6


def test_a_status_that_lies_about_the_angle_is_found() -> None:
    run = run_scene(scene("arm7-pose"), REGISTRY)
    assert run.turns is not None
    aside = run.turns + np.radians([0.0, 0.0, 1.0])
    lied = BY_NAME["false_statuses"].measure(replace(run, turns=aside))
    turned = np.isfinite(aside).all(axis=1)
    said = np.asarray(run.solution.status) == Status.REACHED
    assert lied == (said & turned).sum() > 0


def test_the_miss_of_a_plugins_solver_is_held_against_long_solves() -> None:
    run = run_scene(lamp(), REGISTRY)
    far = replace(run.solution, distance=np.asarray(run.solution.distance) + 2.8)
    measured = BY_NAME["limit_error"].measure(replace(run, solution=far))
    assert measured == pytest.approx(10.0, abs=0.1)


def test_a_joints_own_limit_counts_as_a_limit() -> None:
    text = "limbik: 1\nchain:\n  joints:\n"
    text += "    - {name: a, limit: {use: cone, swing: [30, 30], twist: [-10, 10]}}\n"
    text += "    - {name: b, offset: [0, 0, 1]}\n    - {name: c, offset: [0, 0, 1]}\n"
    text += "goals: [{position: [0, 0, 1.5]}, {position: [0.5, 0, 1.5]}, {position: [0, 1, 1.4]}]\n"
    run = run_scene(scene_from(read_yaml(text, "cone.yaml"), Path(), REGISTRY), REGISTRY)
    assert run.is_limited
    assert BY_NAME["limit_excess"].measure(run) < 1e-6
    out = run.solution.angles.copy()
    out[1, 0] = np.radians([0.0, 50.0, 0.0])
    assert run.solution.limits is not None
    limit = run.solution.limits[0]
    assert limit is not None
    assert margin_of(limit, False, out[1, 0]) == pytest.approx(-np.radians(20.0))
    wrong = replace(run, solution=replace(run.solution, angles=out))
    assert BY_NAME["limit_excess"].measure(wrong) == pytest.approx(20.0)
    with pytest.raises(NotJudged, match="no joint has a range"):
        BY_NAME["chatter"].measure(run)


def test_turned_goals_are_replayed_with_their_turns() -> None:
    """The end takes an orientation: it comes back in any order."""
    text = "limbik: 1\noptions: {end_orientation: 1}\nchain:\n  joints:\n    - {name: a}\n"
    text += "    - {name: b, offset: [0, 0, 1]}\n    - {name: c, offset: [0, 0, 1]}\ngoals:\n"
    for k in range(6):
        text += f"  - {{position: [0.{k}, 1, 1], rotation: [{20 * k}, 10, {9 * k}]}}\n"
    run = run_scene(scene_from(read_yaml(text, "turns.yaml"), Path(), REGISTRY), REGISTRY)
    order = np.arange(6)[::-1]
    assert run.turns is not None
    again = run.solve(run.goals[order], run.turns[order])
    np.testing.assert_array_equal(again.angles, run.solution.angles[order])
    for metric in METRICS:
        if metric.name in ("history", "drift", "asymmetry"):
            assert metric.measure(run) == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(NotJudged, match="no others between"):
        BY_NAME["flips"].measure(run)
