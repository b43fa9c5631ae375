"""Whole solvers in scenes: chosen by name, refused where the chain does not fit."""

import shutil
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.body import solve_body
from limbik.core.bodyscene import BodyScene, read_any
from limbik.core.chain import Chain
from limbik.core.errors import PluginError, SceneError
from limbik.core.pose import forward_kinematics
from limbik.core.posegoals import WholeSolver
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import Scene, read_scene
from limbik.core.settings import Settings
from limbik.core.solution import Continuity, Solution, Status
from limbik.core.solving import solve_scene
from limbik.core.strategy import Strategy
from limbik.core.whole import prepare

CONFIGS = Path(__file__).parents[1] / "configs"
REGISTRY = Registry(third_party=False)


def changed(tmp_path: Path, name: str, *changes: tuple[str, str]) -> Scene:
    """Read a shipped scene with some text exchanged."""
    text = (CONFIGS / name).read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return read_scene(path, REGISTRY)


def batch(scene: Scene, chain: Chain | None = None) -> Any:
    """The scene's solver, ready for its chain or another one."""
    assert scene.solver is not None
    return prepare(scene.solver, chain or scene.chain, scene.settings)


FEET = {
    "level": ("r: 0, t: 0, p: 0", (0.0, 0.0, 0.0)),
    "toes in": ("r: 12, t: 0, p: 0", (12.0, 0.0, 0.0)),
    "heel up": ("r: 0, t: -15, p: 0", (0.0, -15.0, 0.0)),
    "on the edge": ("r: 5, t: -4, p: -8", (5.0, -4.0, -8.0)),
}


@pytest.mark.parametrize("name", FEET)
def test_the_leg_walks_with_its_foot_as_the_scene_says(tmp_path: Path, name: str) -> None:
    """Right-handed Rz(r) Rx(t) Ry(p) is RY(r) RX(t) RZ(p) here: axes swapped, numbers kept."""
    text, (r, t, p) = FEET[name]
    scene = changed(tmp_path, "lambda-leg.yaml", ("r: 0, t: 0, p: 0", text))
    foot = hpb_to_matrix(np.radians((r, t, p)))
    down, ankle = hpb_to_matrix((0.0, -np.pi / 2, 0.0)), hpb_to_matrix((np.pi / 2, np.pi / 2, 0.0))
    for solution in solve_scene(scene, REGISTRY):
        assert solution.status == Status.REACHED
        assert solution.distance < 1e-9
        stands = solution.rotations[2] @ (down @ ankle).T
        np.testing.assert_allclose(stands, foot, atol=1e-9)


def test_the_left_leg_solves_the_mirrored_goals_with_the_mirrored_pose() -> None:
    scene = read_scene(CONFIGS / "lambda-leg.yaml", REGISTRY)
    flip = np.array([-1.0, 1.0, 1.0])
    right = batch(scene)(scene.goals, True)
    left = batch(scene, scene.chain.mirrored())(scene.goals * flip, True)
    np.testing.assert_allclose(left.positions, right.positions * flip, atol=1e-9)
    assert (np.asarray(left.status) == Status.REACHED).all()


def test_a_leg_that_is_not_reached_says_why(tmp_path: Path) -> None:
    scene = changed(tmp_path, "lambda-leg.yaml")
    found = batch(scene)(np.array([[9.0, -30.0, 0.0], [70.0, 20.0, 0.0]]), False)
    assert np.asarray(found.status).tolist() == [Status.OUT_OF_REACH, Status.OUT_OF_REACH]
    assert found.notes[0].startswith("too far")
    assert found.notes[1].startswith("beyond the joint limits")
    assert (found.angles >= scene.chain.low - 1e-9).all()


def test_the_arm_keeps_its_yaw_above_the_shoulder_on_a_path() -> None:
    scene = read_scene(CONFIGS / "cosine-arm.yaml", REGISTRY)
    goals = np.array([[70.0, 130.0, 70.0], [0.0, 150.0, 0.0]])
    followed, apart = batch(scene)(goals, True), batch(scene)(goals, False)
    assert np.degrees(followed.angles[:, 0, 0]) == pytest.approx([45.0, 45.0])
    assert np.degrees(apart.angles[:, 0, 0]) == pytest.approx([45.0, 0.0])
    assert "D1" in followed.notes[1]


@pytest.mark.parametrize("solver", ["planar-ccd", "planar-fabrik"])
def test_planar_solvers_reach_every_goal_of_the_shipped_scene(tmp_path: Path, solver: str) -> None:
    scene = changed(tmp_path, "planar.yaml", ("solver: planar-fabrik", f"solver: {solver}"))
    for solution in solve_scene(scene, REGISTRY):
        assert solution.reached
        assert solution.distance <= 0.001
        assert (solution.angles >= scene.chain.low).all()
        assert (solution.angles <= scene.chain.high).all()


def test_offsets_frozen_rotations_and_a_turned_base_make_the_same_plane(tmp_path: Path) -> None:
    scene = changed(
        tmp_path,
        "planar.yaml",
        ("chain:\n", "chain:\n  base: {position: [3, 4, 5], rotation: [30, 20, 10]}\n"),
        (
            "- name: link 2\n      offset: [0, 0, 1]",
            "- name: link 2\n      offset: [0, 0.6, 0.8]\n      frozen: [0, 25, 0]",
        ),
    )
    chain = scene.chain
    angles = np.zeros((4, 3))
    angles[:3, 1] = np.radians([70.0, -30.0, 40.0])
    from limbik.core.pose import forward_kinematics

    positions, _ = forward_kinematics(chain, angles)
    beside = positions[-1] + 0.5 * chain.base_rotation[:, 0]
    found = batch(scene)(np.array([positions[-1], beside]), False)
    assert np.asarray(found.status).tolist() == [Status.REACHED, Status.OUT_OF_REACH]
    assert found.notes == ("", "the goal is not in the plane")


def test_a_goal_no_pose_within_limits_reaches_is_out_of_reach() -> None:
    scene = read_scene(CONFIGS / "planar.yaml", REGISTRY)
    found = batch(scene)(np.array([[0.0, -0.5, 0.3]]), False)
    assert Status(int(np.asarray(found.status)[0])).label == "out-of-reach"


def path(count: int) -> Array:
    t = np.linspace(0.0, 2.0 * np.pi, count)
    return np.stack([0.0 * t, 1.6 + 0.6 * np.sin(2.0 * t), 1.5 * np.sin(t)], axis=-1)


def test_the_step_bounds_every_joint_on_a_path(tmp_path: Path) -> None:
    free = changed(tmp_path, "planar.yaml")
    bound = changed(
        tmp_path, "planar.yaml", ("solver: planar-fabrik", "solver: {use: planar-fabrik, step: 6}")
    )
    steps = [
        np.degrees(abs(np.diff(batch(scene)(path(400), True).angles, axis=0)).max())
        for scene in (free, bound)
    ]
    assert steps[1] <= 6.0 + 1e-9 < steps[0]


def test_the_article_s_loops_are_selectable_and_break_limits_where_they_have_none(
    tmp_path: Path,
) -> None:
    free = changed(tmp_path, "planar.yaml", ("solver: planar-fabrik", "solver: article-ccd"))
    limited = changed(tmp_path, "planar.yaml", ("planar-fabrik", "article-ccd-limit"))
    goals = np.array([[0.0, 1.2, 1.5]])
    low, high = free.chain.low, free.chain.high

    def outside(scene: Scene) -> bool:
        angles = batch(scene)(goals, False).angles
        return bool(((angles < low - 1e-9) | (angles > high + 1e-9)).any())

    assert outside(free)
    assert not outside(limited)


def test_sweeps_bound_the_article_s_loops(tmp_path: Path) -> None:
    scene = changed(tmp_path, "planar.yaml", ("planar-fabrik\n", "{use: article-ccd, sweeps: 3}\n"))
    assert np.asarray(batch(scene)(scene.goals, False).iterations).max() == 3


WRONG = [
    ("lambda-leg.yaml", ("frozen: [90, 90, 0]", "frozen: [90, 80, 0]"), "needs `frozen: [90, 90"),
    ("lambda-leg.yaml", ("pitch: [-150, 0]\n      bank: 0", "pitch: [-150, 0]"), "`bank: 0`"),
    ("cosine-arm.yaml", ("offset: [0, 69, 0]", "offset: [5, 69, 0]"), "an offset [0, length, 0]"),
    ("planar.yaml", ("- name: link 2\n      offset: [0, 0, 1]", "- name: link 2\n"
     "      offset: [1, 0, 1]"), "an offset [0, y, z]"),
    ("planar.yaml", ("solver: planar-fabrik", "solver: planar-fabrick"), "'planar-fabrik'"),
    ("planar.yaml", ("solver: planar-fabrik", "solver: {use: planar-ccd, step: -1}"),
     "solver.step"),
    ("planar.yaml", ("solver: planar-fabrik", "solver: {sweeps: 3}"), "'use' must name"),
    ("planar.yaml", ("solver: planar-fabrik", "solver: [planar-fabrik]"), "a solver's name"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "change", "words"), WRONG)
def test_a_scene_that_does_not_fit_its_solver_is_refused_with_the_line(
    tmp_path: Path, name: str, change: tuple[str, str], words: str
) -> None:
    with pytest.raises(SceneError) as caught:
        changed(tmp_path, name, change)
    assert words in str(caught.value)
    assert caught.value.faults[0].line > 0


def between(scene: Scene, count: int = 24) -> Array:
    """A path of small steps along a scene's first goals, (m, 3)."""
    parts = np.linspace(0.0, min(len(scene.goals), 4) - 1.0, count)
    rows = np.arange(len(scene.goals))
    return np.stack([np.interp(parts, rows, column) for column in scene.goals.T], 1)


@pytest.mark.parametrize(
    ("name", "choice"),
    [
        ("arm.yaml", "fabrik"),
        ("planar.yaml", "planar-fabrik"),
        ("planar.yaml", "planar-ccd"),
        ("planar.yaml", "article-ccd"),
        ("cosine-arm.yaml", "cosine-arm"),
        ("lambda-leg.yaml", "lambda-leg"),
        ("arm7-pose.yaml", "refine"),
    ],
)
def test_a_path_goal_by_goal_is_the_path_at_once(name: str, choice: str) -> None:
    scene = read_scene(CONFIGS / name, REGISTRY)
    bound = REGISTRY.bind("solver", choice)
    goals = between(scene)
    at_once = prepare(bound, scene.chain, scene.settings)(goals, True)
    solver = WholeSolver(bound, scene.chain, scene.settings)
    before = Continuity.fresh(scene.chain)
    for row, goal in enumerate(goals):
        found = solver.solve(goal, continuity=before)
        np.testing.assert_allclose(found.angles, at_once.angles[row], atol=1e-6)
        assert found.continuity is not None
        before = found.continuity


@pytest.mark.parametrize(
    ("name", "choice"),
    [("arm.yaml", "fabrik"), ("planar.yaml", "planar-ccd"), ("arm7.yaml", "refine")],
)
def test_a_pose_before_that_meets_the_goal_is_kept(name: str, choice: str) -> None:
    """Where the goal leaves the chain free, where it comes from decides."""
    scene = read_scene(CONFIGS / name, REGISTRY)
    solver = WholeSolver(REGISTRY.bind("solver", choice), scene.chain, scene.settings)
    low, high = np.maximum(scene.chain.low, -1.0), np.minimum(scene.chain.high, 1.0)
    pose = low + 0.6 * (high - low)
    goal = forward_kinematics(scene.chain, pose)[0][-1]
    found = solver.solve(goal, continuity=Continuity.from_pose(pose))
    np.testing.assert_allclose(found.angles[:-1], pose[:-1], atol=1e-6)
    assert np.abs(solver.solve(goal).angles[:-1] - pose[:-1]).max() > 0.01


def test_a_path_with_bounded_steps_is_bounded_from_the_pose_before(tmp_path: Path) -> None:
    scene = read_scene(CONFIGS / "planar.yaml", REGISTRY)
    bound = REGISTRY.bind("solver", {"use": "planar-fabrik", "step": 5.0})
    solver = WholeSolver(bound, scene.chain, scene.settings)
    first = solver.solve(scene.goals[0])
    assert first.continuity is not None
    goal = scene.goals[0] + 0.3 * scene.chain.length * np.array([0.0, -1.0, 0.3])
    second = solver.solve(goal, continuity=first.continuity)
    turned = np.abs(second.angles - first.angles).max()
    assert 0.5 * np.radians(5.0) < turned < np.radians(5.0) + 1e-9


def test_a_limb_of_a_body_follows_with_a_solver_of_its_own(tmp_path: Path) -> None:
    text = (CONFIGS / "body.yaml").read_text(encoding="utf-8")
    arm = "options: {tolerance: 0.0001, max_iterations: 100, smoothing: 0.5, off_axis: true}"
    text = text.replace(arm, "solver: fabrik\n    follow: true")
    (tmp_path / "body.yaml").write_text(text, encoding="utf-8")
    shutil.copy(CONFIGS / "humanoid.urdf", tmp_path)
    body = read_any(tmp_path / "body.yaml", REGISTRY)
    assert isinstance(body, BodyScene)
    arms = [frame.solutions["left arm"] for frame in solve_body(body, REGISTRY)]
    settings = next(part.scene.settings for part in body.parts if part.name == "left arm")
    bound = REGISTRY.bind("solver", "fabrik")
    for before, found in pairwise(arms):
        solver = WholeSolver(bound, found.chain, settings)
        again = solver.solve(found.goal, continuity=before.continuity)
        np.testing.assert_array_equal(again.angles, found.angles)
        assert np.abs(solver.solve(found.goal).angles - found.angles).max() > 1e-3


def test_a_solver_from_another_plug_in_solves_a_scene(tmp_path: Path) -> None:
    from limbik.core.hooks import hookimpl
    from limbik.core.whole import Batch, assemble

    def rests(chain: Chain, settings: Settings, params: Any) -> Batch:
        def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
            angles = np.repeat(chain.rest[None], len(goals), axis=0)
            ones = np.ones(len(goals), np.int64)
            return assemble(chain, goals, angles, ones, 0 * ones, ["rests"] * len(goals))

        return solve

    def fails(chain: Chain, settings: Settings, params: Any) -> Batch:
        raise ValueError("no luck")

    class Acme:
        @hookimpl
        def limbik_solvers(self) -> list[Strategy]:
            return [Strategy("rests", rests), Strategy("fails", fails)]

    registry = Registry(third_party=False)
    registry.register(Acme(), "acme")
    file = tmp_path / "scene.yaml"
    text = (CONFIGS / "planar.yaml").read_text(encoding="utf-8")
    file.write_text(text.replace("planar-fabrik", "rests"), encoding="utf-8")
    first = solve_scene(read_scene(file, registry), registry)[0]
    assert (first.status, first.remark) == (Status.STOPPED, "rests")
    file.write_text(text.replace("planar-fabrik", "fails"), encoding="utf-8")
    with pytest.raises(PluginError, match="plug-in 'acme', solver 'fails': ValueError: no luck"):
        read_scene(file, registry)


def test_bake_uses_the_scene_s_solver() -> None:
    from limbik.core.baking import bake_scene

    scene = read_scene(CONFIGS / "lambda-leg.yaml", REGISTRY)
    baked = bake_scene(scene, REGISTRY)
    np.testing.assert_array_equal(baked.solution.angles, batch(scene)(scene.goals, True).angles)


def test_the_schema_offers_the_solvers() -> None:
    from limbik.core.schema import scene_schema

    forms = scene_schema(REGISTRY)["$defs"]["SceneModel"]["properties"]["solver"]["anyOf"]
    assert forms[:2] == [{"const": "3d"}, {"const": "2d"}]
    assert {"lambda-leg", "cosine-arm", "planar-fabrik", "fabrik"} <= set(forms[2]["enum"])
