"""Whole clips and robots with several chains, into every format and back."""

import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_body
from limbik.core.bodyscene import BodyScene, body_from
from limbik.core.formats import BodyBake
from limbik.core.frames import Y_UP
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.yamlfile import read_yaml
from limbik.plugins.formats import bvh_out
from limbik.plugins.formats.bodytables import write_body_csv, write_body_json, write_body_npz
from limbik.plugins.formats.bvh import read_bvh
from limbik.plugins.formats.bvh_motion import clip_motion
from limbik.plugins.formats.bvh_skeleton import ClipSkeleton

Positions = Callable[[Path], dict[str, Array]]
REGISTRY = Registry(third_party=False)
CONFIGS = Path(__file__).parents[2] / "configs"
LEGS = """\
limbik: 1
skeleton: {bvh: walk.bvh, frames: [3, 32]}
chains:
  - {name: left leg, base: LeftHip, end: LeftAnkle, options: {tolerance: 0.000001}}
  - {name: right leg, base: RightHip, end: RightAnkle, options: {tolerance: 0.000001}}
"""


def scene_at(folder: Path, text: str = LEGS) -> BodyScene:
    return body_from(read_yaml(text, "legs.yaml"), folder, REGISTRY)


@pytest.fixture
def baked(walk: Path) -> BodyBake:
    """The walker's legs."""
    return bake_body(scene_at(walk.parent), REGISTRY)


def test_each_foot_follows_its_own_path_through_the_world(
    baked: BodyBake, walk: Path, bvh_positions: Positions, tmp_path: Path
) -> None:
    """The bake, read by another reader than limbik's, has the feet where the clip had them.

    The clip stretches its left knee a little, so the chain's bones are their means: 1e-3 of them.
    """
    assert [of["reached"] for of in baked.metrics.values()] == [30, 30]
    written = tmp_path / "baked.bvh"
    written.write_text(bvh_out.write_body(baked))
    before, after = bvh_positions(walk), bvh_positions(written)
    for foot in ("LeftAnkle", "RightAnkle"):
        np.testing.assert_allclose(after[foot], before[foot][3:33], atol=1e-5)


def test_a_baked_clip_read_back_has_the_solved_turns(baked: BodyBake, tmp_path: Path) -> None:
    """To 1e-6 degrees in every joint, solved or not."""
    written = tmp_path / "baked.bvh"
    written.write_text(bvh_out.write_body(baked))
    back = clip_motion(read_bvh(written))
    assert back.names == baked.motion.names
    np.testing.assert_allclose(back.turns, baked.motion.turns, atol=np.radians(1e-6) / 10)
    np.testing.assert_allclose(back.offsets, baked.motion.offsets, atol=1e-9)


def test_channels_of_no_chain_stay_bit_for_bit(baked: BodyBake) -> None:
    skeleton = baked.scene.skeleton
    assert isinstance(skeleton, ClipSkeleton)
    limbs = [part.limb for part in baked.scene.parts]
    clip = skeleton.baked(baked.motion, limbs)
    changed = np.flatnonzero((clip.frames != skeleton.clip.frames).any(axis=0))
    turned = {"LeftHip", "LeftKnee", "RightHip", "RightKnee"}
    allowed = {
        column
        for joint in skeleton.clip.joints
        if joint.name in turned
        for column in joint.columns[len(joint.moves) :]
    }
    assert set(changed.tolist()) <= allowed
    assert clip.joints == skeleton.clip.joints


def test_a_pole_in_the_pelvis_and_a_rotor_by_the_foot_keep_the_feet(walk: Path) -> None:
    more = ", frame: Hips, solver: 2d, pole: {position: [0, 0, 100], rotor: leg}}"
    text = LEGS.replace("options: {tolerance: 0.000001}", "options: {initial_bend: two-bone}")
    text = text.replace("}}", "}" + more)
    bake = bake_body(scene_at(walk.parent, text), REGISTRY)
    assert bake.scene.parts[0].scene.goal_turns is not None
    assert [of["reached"] for of in bake.metrics.values()] == [30, 30]


def test_a_mirrored_bake_has_the_other_side(baked: BodyBake, walk: Path) -> None:
    image = bake_body(scene_at(walk.parent), REGISTRY, mirrored=True)
    assert list(image.solutions) == ["right leg", "left leg"]
    plain, other = (json.loads(write_body_json(bake)) for bake in (baked, image))
    assert other["mirrored"]
    left = [row[plain["joints"].index("LeftAnkle")] for row in plain["positions"]]
    right = [row[other["joints"].index("RightAnkle")] for row in other["positions"]]
    np.testing.assert_allclose(right, Y_UP.points(left), atol=1e-12)


def test_the_tables_agree(baked: BodyBake) -> None:
    record = json.loads(write_body_json(baked))
    arrays = np.load(io.BytesIO(write_body_npz(baked)))
    rows = [line.split(",") for line in write_body_csv(baked).splitlines()]
    assert rows[0][:3] == ["name", "time", "left leg: x"]
    assert [row[0] for row in rows[1:]] == record["names"] == arrays["names"].tolist()
    assert arrays["chains"].tolist() == list(record["chains"]) == ["left leg", "right leg"]
    np.testing.assert_array_equal(arrays["positions"], record["positions"])
    column = rows[0].index("right leg: RightKnee pitch")
    knee = np.degrees(arrays["right leg/angles"][:, 1, 1])
    np.testing.assert_array_equal([float(row[column]) for row in rows[1:]], knee)
    assert np.degrees(arrays["left leg/angles"]).tolist() == record["chains"]["left leg"]["angles"]


def test_a_robots_own_values_are_written(tmp_path: Path) -> None:
    scene = body_from(
        read_yaml((CONFIGS / "body.yaml").read_text(), "body.yaml"), CONFIGS, REGISTRY
    )
    arrays = np.load(io.BytesIO(write_body_npz(bake_body(scene, REGISTRY))))
    names = arrays["left arm/model_names"].tolist()
    assert names[:2] == ["left_shoulder_pitch", "left_shoulder_roll"]
    values = arrays["left arm/model_values"][:, 0]
    np.testing.assert_allclose(values, arrays["left arm/angles"][:, 0].sum(axis=1), atol=1e-12)


def test_a_robot_written_as_a_clip_stands_where_it_was_solved(
    tmp_path: Path, bvh_positions: Positions
) -> None:
    scene = body_from(
        read_yaml((CONFIGS / "body.yaml").read_text(), "body.yaml"), CONFIGS, REGISTRY
    )
    bake = bake_body(scene, REGISTRY)
    written = tmp_path / "body.bvh"
    written.write_text(bvh_out.write_body(bake))
    expected, _ = bake.motion.world()
    places = bvh_positions(written)
    for index, name in enumerate(bake.motion.names):
        np.testing.assert_allclose(Y_UP.points(places[name]), expected[:, index], atol=1e-8)
