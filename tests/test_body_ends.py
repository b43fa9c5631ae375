"""Joints of a skeleton with limits of their own, and ends of its chains that take orientations."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_body, bake_scene
from limbik.core.body import BodySolution, BodySolver, solve_body
from limbik.core.bodyscene import BodyScene, body_from
from limbik.core.errors import SceneError
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import scene_from
from limbik.core.yamlfile import read_yaml
from limbik.plugins.formats.limbs import ModelLimb
from limbik.tests.limbs import REGISTRY

SWING, TWIST = (60.0, 35.0), (-30.0, 45.0)
JOINTS = """\
limbik: 1
skeleton:
  joints:
    - {name: hips, offset: [0, 90, 0], frozen: [0, 90, 0]}
    - {name: chest, parent: hips, offset: [0, 0, 45]}
    - {name: shoulder, parent: chest, offset: [-18, 0, -5], frozen: [0, 180, 0], LIMIT}
    - {name: elbow, parent: shoulder, offset: [0, 0, 30], heading: 0, pitch: [0, 145], bank: 0}
    - {name: hand, parent: elbow, offset: [0, 0, 26]}
    - {name: finger, parent: hand, offset: [0, 0, 9]}
chains:
- {name: spine, base: hips, end: chest, goals: SPINE}
- {name: arm, base: shoulder, end: hand, MORE, goals: GOALS}
"""
CONE = f"limit: {{use: cone, swing: [{SWING[0]}, {SWING[1]}], twist: [{TWIST[0]}, {TWIST[1]}]}}"
GENERATOR = np.random.default_rng(5)


def listed(places: Array, turns: Array | None = None) -> str:
    """Goals of a scene; turns in degrees, NaN for none."""
    rows = []
    for row, place in enumerate(places.tolist()):
        turn = None if turns is None or np.isnan(turns[row, 0]) else turns[row].tolist()
        rows.append(f"{{position: {place}" + (f", rotation: {turn}}}" if turn else "}"))
    return "[" + ", ".join(rows) + "]"


def body(
    goals: str, more: str = "follow: false", limit: str = "rest: [0, 0, 0]", spine: str = ""
) -> BodyScene:
    spine = spine or "[{position: [9, 133, 9]}]"
    text = JOINTS.replace("LIMIT", limit).replace("SPINE", spine)
    text = text.replace("MORE", more).replace("GOALS", goals)
    return body_from(read_yaml(text, "body.yaml"), Path(), REGISTRY)


def outside(angles: Array) -> Array:
    """How far shoulder turns lie outside the cone, by quaternions: over 1, and twist [rad]."""
    m = hpb_to_matrix(angles)
    w = np.sqrt(np.maximum(1.0 + np.trace(m, axis1=-2, axis2=-1), 1e-12)) / 2.0
    x, y, z = ((m[:, i, j] - m[:, j, i]) / (4.0 * w) for i, j in ((2, 1), (0, 2), (1, 0)))
    size = np.hypot(w, z)
    x, y = (x * w - y * z) / size, (x * z + y * w) / size
    swing = 2.0 * np.arctan2(np.hypot(x, y), size) / np.maximum(np.hypot(x, y), 1e-12)
    a, b = np.radians(SWING)
    over = (x * swing / a) ** 2 + (y * swing / b) ** 2 - 1.0
    twist = -2.0 * np.arctan2(z, w)
    low, high = np.radians(TWIST)
    return np.stack([over, low - twist, twist - high], axis=-1)


def around_the_shoulder(count: int) -> Array:
    away = GENERATOR.normal(size=(count, 3))
    away *= GENERATOR.uniform(20.0, 54.0, (count, 1)) / np.linalg.norm(away, axis=1)[:, None]
    return np.array([-18.0, 128.0, 0.0]) + away


def test_a_cone_of_a_skeletons_joint_holds_for_every_goal() -> None:
    goals = around_the_shoulder(40)
    plain, held = (
        np.array([found.solutions["arm"].angles[0] for found in solved])
        for solved in (
            solve_body(body(listed(goals)), REGISTRY),
            solve_body(body(listed(goals), limit=CONE), REGISTRY),
        )
    )
    assert (outside(plain).max(axis=-1) > 0.1).mean() > 0.5  # the goals ask for more
    assert outside(held).max() < 1e-6


def test_a_cone_blocks_what_it_must_and_nothing_else() -> None:
    """Goals at the hand of poses inside the cone are reached from any spine."""
    scene = body("[{position: [0, 0, 0]}]", limit=CONE)
    solver = BodySolver.of(scene, REGISTRY)
    chest = scene.skeleton.names.index("chest")
    for _ in range(50):
        spine = np.array([GENERATOR.uniform(-9, 9), 133.0, GENERATOR.uniform(-9, 9)])
        bent = solver.solve({"spine": spine})
        angle, size = GENERATOR.uniform(0, 2 * np.pi), 0.9 * np.sqrt(GENERATOR.uniform())
        a, b = np.radians(SWING) * size * (np.cos(angle), np.sin(angle))
        chain = bent_arm(bent, np.array([b, a]), GENERATOR.uniform(0.1, 2.4))
        found = solver.solve({"spine": spine, "arm": chain})
        assert found.solutions["arm"].reached
        np.testing.assert_allclose(found.positions[chest], bent.positions[chest])


def bent_arm(body: BodySolution, swing: Array, elbow: float) -> Array:
    """Place of the hand for a swing of the shoulder without twist, and a bend of the elbow."""
    names = body.skeleton.names
    at = names.index("shoulder")
    axes = body.rotations[names.index("chest")] @ hpb_to_matrix(np.radians([0.0, 180.0, 0.0]))
    size = float(np.linalg.norm(swing))
    axis = np.array([swing[1], swing[0], 0.0]) / max(size, 1e-12)
    k = np.cross(np.eye(3), axis)
    turn = np.eye(3) + np.sin(size) * k + (1.0 - np.cos(size)) * k @ k
    fore = hpb_to_matrix([0.0, elbow, 0.0]) @ [0.0, 0.0, 26.0]
    return np.asarray(body.positions[at] + axes @ turn @ (np.array([0.0, 0.0, 30.0]) + fore))


def test_a_cone_of_a_skeletons_joint_is_checked_with_its_line() -> None:
    with pytest.raises(SceneError, match=r"body.yaml:6:.*limit"):
        body("[{position: [0, 0, 1]}]", limit="limit: {use: cone, swing: [60, 400]}")
    pole = "solver: 2d, pole: {position: [0, 100, 90]}"
    with pytest.raises(SceneError, match="'shoulder' has a limit of its own"):
        body("[{position: [0, 0, 1]}]", pole, CONE)


@pytest.mark.parametrize("frame", ["world", "chest"])
@pytest.mark.parametrize("solver", ["options: {end_orientation: 1}", "solver: refine"])
def test_the_end_takes_its_orientation_in_the_frame_of_the_chain(frame: str, solver: str) -> None:
    """The spine bends first; the goals are of the chest then, or of the world."""
    turns = np.array([[20.0, 30.0, -40.0], [np.nan] * 3, [-60.0, 10.0, 25.0]])
    goals = np.array([[-20.0, 20.0, 0.0], [-25.0, 25.0, -3.0], [-10.0, 28.0, 6.0]])
    if frame == "world":
        goals = goals[:, [0, 2, 1]] + (9.0, 120.0, 20.0)
    spine = "[{position: [9, 133, 9]}, {position: [0, 134, 5]}, {position: [-9, 133, 0]}]"
    scene = body(listed(goals, turns), f"frame: {frame}, {solver}", spine=spine)
    names = scene.skeleton.names
    solved = solve_body(scene, REGISTRY)
    for goal, turn, found in zip(goals, turns, solved, strict=True):
        chest, hand, finger = map(names.index, ("chest", "hand", "finger"))
        origin, axes = found.positions[chest], found.rotations[chest]
        if frame == "world":
            origin, axes = np.zeros(3), np.eye(3)
        assert found.solutions["arm"].reached
        np.testing.assert_allclose(found.positions[hand], origin + axes @ goal, atol=0.011)
        if np.isnan(turn[0]):
            continue
        wanted = axes @ hpb_to_matrix(np.radians(turn))
        np.testing.assert_allclose(found.rotations[hand], wanted, atol=1e-5)
        along = found.positions[finger] - found.positions[hand]
        np.testing.assert_allclose(along, wanted @ [0.0, 0.0, 9.0], atol=1e-4)
    assert frame == "world" or differ([found.rotations[1] for found in solved])


def differ(axes: Sequence[Array]) -> bool:
    return bool(np.abs(axes[0] - axes[1]).max() > 0.05)


def test_orientations_move_with_the_chest_and_change_nothing_before_the_end() -> None:
    goals = np.array([[-20.0, 20.0, 0.0]])
    turned = body(
        listed(goals, np.array([[20.0, 30.0, -40.0]])),
        "frame: chest, options: {end_orientation: 1}",
    )
    plain = body(listed(goals), "frame: chest")
    first, second = (solve_body(scene, REGISTRY)[0] for scene in (turned, plain))
    np.testing.assert_array_equal(first.positions[:5], second.positions[:5])
    assert np.abs(first.positions[5] - second.positions[5]).max() > 1.0


WALK = Path(__file__).parents[1] / "configs" / "walk.bvh"
OPTION_LINE = "options: {off_axis: true, tolerance: 0.001, end_orientation: 1}"


def walking(more: str) -> BodyScene:
    text = f"limbik: 1\nskeleton: {{bvh: {WALK}}}\nchains:\n"
    text += f"- {{name: leg, base: LeftUpLeg, end: LeftFoot, {more}}}\n"
    return body_from(read_yaml(text, "walk.yaml"), Path(), REGISTRY)


@pytest.mark.parametrize("frame", ["world", "RightLeg"])
@pytest.mark.parametrize("solver", [OPTION_LINE, "solver: refine"])
def test_a_clips_chain_keeps_the_ends_own_orientation_in_any_frame(frame: str, solver: str) -> None:
    """A bend to the side turns the shin about itself; the foot turns back."""
    aside = solver.replace("1}", "1, bend_vector: {use: manual, angle: 40}}")
    scene = walking(f"frame: {frame}, {aside}")
    names = scene.skeleton.names
    foot, shin = names.index("LeftFoot"), names.index("LeftLeg")
    _, clip = scene.skeleton.motion.world()
    solved = solve_body(scene, REGISTRY)
    for k, found in enumerate(solved):
        assert found.reached
        np.testing.assert_allclose(found.rotations[foot], clip[k, foot], atol=1e-6)
    if solver == OPTION_LINE:
        assert np.abs(solved[5].rotations[shin] - clip[5, shin]).max() > 0.1


def test_an_end_that_is_turned_is_written_into_its_clip(tmp_path: Path) -> None:
    """Goals with a rotation of their own; all other joints keep their channels to the last bit."""
    from limbik.plugins.formats.bvh import read_bvh
    from limbik.plugins.formats.bvh_motion import clip_motion
    from limbik.plugins.formats.bvh_out import write, write_body

    goals = "goals: [{position: [PLACE], rotation: [20, -60, 10]}]"
    body = walking(f"{OPTION_LINE}, {goals.replace('PLACE', '-9, 20, 20')}")
    text = f"limbik: 1\nchain: {{bvh: {WALK}, base: LeftUpLeg, end: LeftFoot, frames: [0, 0]}}\n"
    text += f"{OPTION_LINE}\n{goals.replace('PLACE', '-2, -70, 20')}\n"
    chain = scene_from(read_yaml(text, "leg.yaml"), Path(), REGISTRY)
    original = read_bvh(WALK)
    wanted = hpb_to_matrix(np.radians([20.0, -60.0, 10.0]))
    whole, single = bake_body(body, REGISTRY), bake_scene(chain, REGISTRY)
    for content, name in ((write_body(whole), "world"), (write(single), "Hips")):
        (tmp_path / "out.bvh").write_text(content)
        clip = read_bvh(tmp_path / "out.bvh")
        motion = clip_motion(clip)
        _, turns = motion.world()
        at = motion.names.index("LeftFoot")
        seen = turns[:, at]
        if name == "Hips":
            seen = turns[:, motion.names.index(name)].swapaxes(-1, -2) @ seen
        frame = joined_frame(body)
        np.testing.assert_allclose(seen @ frame, np.broadcast_to(wanted, seen.shape), atol=1e-8)
        kept = [joint for joint in original.joints if not joint.name.startswith("Left")]
        for joint in kept:
            columns = list(joint.columns)
            assert (clip.frames[:, columns] == original.frames[: len(seen), columns]).all()


def joined_frame(scene: BodyScene) -> Array:
    """The chain's end in the clip's foot."""
    limb = scene.parts[0].limb
    assert isinstance(limb, ModelLimb)
    return np.asarray(limb.join.frames[-1])


def test_an_end_that_is_turned_cannot_be_turned_by_another_chain() -> None:
    spine = "[{position: [9, 133, 9], rotation: [0, 90, 0]}]"
    chains = "limb, base: chest, end: hand"
    text = JOINTS.replace("SPINE", spine).replace("GOALS", "[{position: [1, 2, 3]}]")
    text = text.replace("MORE", "follow: false").replace("LIMIT", "rest: [0, 0, 0]")
    text = text.replace("arm, base: shoulder, end: hand", chains)
    text = text.replace("end: chest, goals", "end: chest, options: OPTIONS, goals")
    with pytest.raises(SceneError, match="'chest' is turned by the chain 'spine' already"):
        body_from(
            read_yaml(text.replace("OPTIONS", "{end_orientation: 1}"), "body.yaml"),
            Path(),
            REGISTRY,
        )


def test_a_bake_keeps_orientations_of_poses_solved_one_by_one() -> None:
    """Solutions of single frames are put together whole: errors and remarks too."""
    goals = np.array([[-20.0, 20.0, 0.0], [-25.0, 25.0, -3.0]])
    turns = np.array([[20.0, 30.0, -40.0], [-60.0, 10.0, 25.0]])
    scene = body(listed(goals, turns), "frame: chest, solver: refine")
    solution = bake_body(scene, REGISTRY).solutions["arm"]
    assert solution.rotation_error.shape == (2,)  # type: ignore[attr-defined]
    asked = solution.goal_rotation  # type: ignore[attr-defined]
    np.testing.assert_allclose(solution.rotations[:, -1], asked, atol=1e-5)
    assert solution.single(1).remark == ""
