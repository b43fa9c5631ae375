"""What is written holds the solved motion: tables, arrays, an animated skeleton, its mirror."""

import csv
import io
import json
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.baking import BLOCK, bake_scene
from limbik.core.formats import Bake
from limbik.core.frames import Y_UP
from limbik.core.mirror import mirrored_solution, side_swapped
from limbik.core.motion import motion_metrics
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.solver import Solver
from limbik.plugins.formats import bvh_out, glb, tables
from limbik.plugins.formats.bvh import read_bvh
from limbik.plugins.formats.bvh_motion import clip_motion

Solve = Callable[[str], Scene]
REGISTRY = Registry(third_party=False)
CRANE = (
    "limbik: 1\nchain: {urdf: crane.urdf, base: ground, end: hook, rest: {luff: 40, fold: 60}}\n"
    "options: {off_axis: true, max_iterations: 200}\ngoals:\n"
    + "".join(f"  - {{position: [1.5, {2 + 0.1 * k}, {0.1 * k}]}}\n" for k in range(8))
)
WALK = "limbik: 1\nchain: {bvh: walk.bvh, base: LeftHip, end: LeftAnkle}\n"


@pytest.fixture
def bake(crane: Path, scene_of: Solve) -> Bake:
    return bake_scene(scene_of(CRANE), REGISTRY, frame_time=0.25)


@pytest.fixture
def walked(walk: Path, scene_of: Solve) -> Bake:
    return bake_scene(scene_of(WALK), REGISTRY)


def test_csv_holds_angles_in_degrees_and_the_robots_values(bake: Bake) -> None:
    rows = list(csv.DictReader(io.StringIO(tables.write_csv(bake))))
    values = bake.body.values(bake.solution.angles)
    assert values is not None
    for k, row in enumerate(rows):
        assert float(row["time"]) == 0.25 * k
        bank = np.radians(float(row["slew bank"]))
        assert bank == pytest.approx(bake.solution.angles[k, 0, 2], abs=1e-12)
        assert float(row["luff [rad]"]) == values.rows[k, 1]
        assert [float(row[axis]) for axis in "xyz"] == bake.solution.goal[k].tolist()


def test_json_and_npz_hold_the_same_motion(bake: Bake) -> None:
    record = json.loads(tables.write_json(bake))
    arrays = np.load(io.BytesIO(tables.write_npz(bake)))
    np.testing.assert_allclose(np.radians(record["angles"]), arrays["angles"], atol=1e-12)
    np.testing.assert_array_equal(record["positions"], arrays["positions"])
    assert record["model_values"]["names"] == arrays["model_names"].tolist()
    assert record["metrics"]["frames"] == 8
    assert float(arrays["frame_time"]) == 0.25


def glb_parts(content: bytes) -> tuple[dict[str, Any], bytes]:
    magic, version, size = struct.unpack_from("<4sII", content)
    assert (magic, version, size) == (b"glTF", 2, len(content))
    length, kind = struct.unpack_from("<II", content, 12)
    assert kind == 0x4E4F534A
    return json.loads(content[20 : 20 + length]), content[28 + length :]


def glb_array(document: dict[str, Any], buffer: bytes, index: int) -> Array:
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    kind = {5126: "<f4", 5121: "u1", 5123: "<u2"}[accessor["componentType"]]
    width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
    count = accessor["count"] * width
    flat = np.frombuffer(buffer, kind, count, view["byteOffset"]).astype(np.float64)
    return flat.reshape(-1, width)


def glb_positions(content: bytes, frame: int) -> dict[str, Array]:
    """World positions of the nodes in a frame, by the format's rules alone."""
    document, buffer = glb_parts(content)
    nodes = [dict(node) for node in document["nodes"]]
    (animation,) = document["animations"]
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        track = glb_array(document, buffer, sampler["output"])
        nodes[channel["target"]["node"]][channel["target"]["path"]] = track[frame]
    places: dict[str, Array] = {}

    def visit(index: int, origin: Array, turned: Array) -> None:
        node = nodes[index]
        if "translation" not in node:
            return
        x, y, z, w = node["rotation"]
        place = origin + turned @ np.asarray(node["translation"])
        own = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        places[node["name"]] = place
        for child in node.get("children", []):
            visit(child, place, turned @ np.array(own))

    for root in document["scenes"][0]["nodes"]:
        visit(root, np.zeros(3), np.eye(3))
    return places


def test_glb_nodes_are_where_the_joints_are(bake: Bake, walked: Bake) -> None:
    """Right-handed, to the rounding of 32-bit floats; the whole skeleton of a clip."""
    for one, last in ((bake, 7), (walked, 39)):
        motion = one.body.motion(one.solution.angles, one.frame_time)
        places, _ = motion.world()
        content = glb.write(one)
        for frame in (0, last):
            found = glb_positions(content, frame)
            assert set(found) == set(motion.names)
            size = np.abs(places).max()
            for k, name in enumerate(motion.names):
                np.testing.assert_allclose(
                    found[name], Y_UP.points(places[frame, k]), atol=2e-6 * size
                )


def test_glb_times_are_the_frames(bake: Bake) -> None:
    document, buffer = glb_parts(glb.write(bake))
    times = glb_array(document, buffer, document["animations"][0]["samplers"][0]["input"])
    np.testing.assert_allclose(times[:, 0], 0.25 * np.arange(8))


def test_glb_quaternions_never_change_sign_on_the_way(walked: Bake) -> None:
    document, buffer = glb_parts(glb.write(walked))
    for channel in document["animations"][0]["channels"]:
        if channel["target"]["path"] == "rotation":
            sampler = document["animations"][0]["samplers"][channel["sampler"]]
            track = glb_array(document, buffer, sampler["output"])
            assert ((track[1:] * track[:-1]).sum(axis=1) > 0.0).all()
            np.testing.assert_allclose(np.linalg.norm(track, axis=1), 1.0, atol=1e-6)


def test_glb_is_read_by_an_independent_library(bake: Bake) -> None:
    pygltflib = pytest.importorskip("pygltflib")
    read = pygltflib.GLTF2.load_from_bytes(glb.write(bake))
    assert [node.name for node in read.nodes][:-1] == list(bake.solution.chain.names)
    assert len(read.skins[0].joints) == 4


def test_a_mirrored_bake_is_the_mirror_image(bake: Bake) -> None:
    """The angles, run through the mirrored chain, end where x has changed its sign."""
    mirrored = bake_scene(bake.scene, REGISTRY, mirrored=True)
    places, turns = forward_kinematics(mirrored.solution.chain, mirrored.solution.angles)
    np.testing.assert_allclose(places, Y_UP.points(bake.solution.positions), atol=1e-12)
    np.testing.assert_allclose(mirrored.solution.positions, places, atol=1e-12)
    np.testing.assert_allclose(mirrored.solution.rotations, turns, atol=1e-12)


def test_a_solution_mirrored_is_a_mirrored_problem_solved(walk: Path, scene_of: Solve) -> None:
    """With the bend vector along Y, the same on both sides, to rounding."""
    scene = scene_of(WALK)
    plain = Solver(scene.chain, scene.settings, REGISTRY).solve_many(scene.goals)
    other = Solver(scene.chain.mirrored(), scene.settings, REGISTRY)
    solved = other.solve_many(Y_UP.points(scene.goals))
    mirrored = mirrored_solution(plain)
    np.testing.assert_allclose(mirrored.positions, solved.positions, atol=1e-9)
    np.testing.assert_allclose(mirrored.bend_vector, solved.bend_vector, atol=1e-9)


def test_mirrored_skeletons_are_mirror_images_in_bvh_and_glb(
    walk: Path, scene_of: Solve, tmp_path: Path
) -> None:
    bake = bake_scene(scene_of(WALK), REGISTRY)
    mirrored = bake_scene(bake.scene, REGISTRY, mirrored=True)
    plain = bake.body.motion(bake.solution.angles, bake.frame_time)
    places = Y_UP.points(plain.world()[0])
    path = tmp_path / "mirrored.bvh"
    path.write_text(bvh_out.write(mirrored))
    clip = clip_motion(read_bvh(path))
    found, nodes = clip.world()[0], glb_positions(glb.write(mirrored), 5)
    for k, name in enumerate(side_swapped(plain.names)):
        np.testing.assert_allclose(found[:, clip.names.index(name)], places[:, k], atol=1e-6)
        np.testing.assert_allclose(nodes[name], Y_UP.points(places[5, k]), atol=1e-3)


def test_names_tell_their_side() -> None:
    names = ["LeftFoot", "RightFoot", "foot.L", "foot.R", "l_hand", "r_hand", "LThumb", "RThumb"]
    names += ["leg_l", "leg_r", "Lower", "Ball", "rig:Left", "rig:Right", "left", "right"]
    assert side_swapped(side_swapped(names)) == names
    assert side_swapped(names)[:6] == [names[k] for k in (1, 0, 3, 2, 5, 4)]
    assert side_swapped(["Lower", "Ball", "Roll"]) == ["Lower", "Ball", "Roll"]
    assert side_swapped(["LeftFoot", "spine"]) == ["RightFoot", "spine"]
    assert side_swapped(["a", "L", "R", "b"]) == ["a", "R", "L", "b"]


def test_blocks_of_a_long_path_are_joined_without_a_seam(walk: Path, scene_of: Solve) -> None:
    """Followed in blocks as in one go, bit for bit; aim_from previous makes the past count."""
    scene = scene_of(WALK + "options: {aim_from: previous}\nfollow: true\n")
    goals = np.tile(scene.goals, (BLOCK // 40 + 2, 1))
    long = replace(scene, goals=goals, goal_names=tuple(map(str, range(len(goals)))))
    seen: list[int] = []
    bake = bake_scene(long, REGISTRY, progress=seen.append)
    whole = Solver(scene.chain, scene.settings, REGISTRY).follow(goals)
    np.testing.assert_array_equal(bake.solution.angles, whole.angles)
    assert seen == [BLOCK, len(goals)]


def test_metrics_find_the_largest_step_and_the_pop(walked: Bake) -> None:
    """A pose turned by 30° for one frame is a pop there and on the way back."""
    smooth = motion_metrics(walked.solution)
    assert smooth.pops == ()
    angles = walked.solution.angles.copy()
    angles[20, 1, 1] += np.radians(60.0)
    jumping = motion_metrics(replace(walked.solution, angles=angles))
    assert jumping.pops == (20, 21)
    assert (jumping.max_step_joint, jumping.max_step_frame) in {("LeftKnee", 20), ("LeftKnee", 21)}
    assert 50.0 < jumping.max_step < 80.0
    assert jumping.reached == smooth.reached


def test_metrics_of_a_single_frame_have_no_step(walked: Bake) -> None:
    one = walked.solution
    cut = {name: getattr(one, name)[:1] for name in ("goal", "angles", "distance", "status")}
    metrics = motion_metrics(replace(one, **cut))
    assert (metrics.frames, metrics.max_step, metrics.pops) == (1, 0.0, ())
