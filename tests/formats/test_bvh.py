"""Clips are read as another reader reads them, come back as they were, or are refused."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core import bodyscene
from limbik.core.baking import bake_body, bake_scene
from limbik.core.errors import InputError, SceneError
from limbik.core.frames import Y_UP
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.scene import Scene, read_scene
from limbik.plugins.formats import bvh_out
from limbik.plugins.formats.bvh import read_bvh
from limbik.plugins.formats.bvh_chain import BvhModel, ClipBody, inspect, read_body
from limbik.plugins.formats.bvh_motion import clip_motion, mirrored_clip
from limbik.plugins.formats.channels import channels_to_matrix, matrix_to_channels

Solve = Callable[[str], Scene]
Positions = Callable[[Path], dict[str, Array]]
REGISTRY = Registry(third_party=False)
LEFT = "limbik: 1\nchain: {bvh: walk.bvh, base: LeftHip, end: LeftAnkle}\n"
RIGHT = LEFT.replace("Left", "Right")
OPTIONS = "options: {max_iterations: 200, tolerance: 0.001}\n"


def body_of(path: Path, base: str, end: str, **more: Any) -> ClipBody:
    return read_body(BvhModel(bvh=str(path), base=base, end=end, **more), Path())


def test_positions_are_those_of_an_independent_reader(walk: Path, bvh_positions: Positions) -> None:
    """To 1e-9 of centimetres: every order of channels, six channels in mid chain, one channel."""
    motion = clip_motion(read_bvh(walk))
    places, _ = motion.world()
    expected = bvh_positions(walk)
    assert set(motion.names) == set(expected)
    for k, name in enumerate(motion.names):
        np.testing.assert_allclose(Y_UP.points(places[:, k]), expected[name], atol=1e-9)


def test_the_goals_are_the_ends_path_seen_from_the_base(
    walk: Path, bvh_positions: Positions
) -> None:
    """Goals, turned into the world by the clip's own pelvis, are where the ankle was."""
    motion = clip_motion(read_bvh(walk))
    places, turns = motion.world()
    goals = np.asarray(body_of(walk, "LeftHip", "LeftAnkle").goals)
    base, pelvis = motion.names.index("LeftHip"), motion.names.index("Hips")
    world = places[:, base] + np.einsum("mij,mj->mi", turns[:, pelvis], goals)
    np.testing.assert_allclose(Y_UP.points(world), bvh_positions(walk)["LeftAnkle"], atol=1e-9)


def test_scale_turns_the_clips_unit_into_the_scenes(walk: Path) -> None:
    metres = body_of(walk, "LeftHip", "LeftAnkle", scale=0.01)
    own = body_of(walk, "LeftHip", "LeftAnkle")
    np.testing.assert_allclose(metres.chain.offsets, 0.01 * own.chain.offsets, atol=1e-15)
    np.testing.assert_allclose(np.asarray(metres.goals), 0.01 * np.asarray(own.goals), atol=1e-12)


def test_frames_and_every_choose_frames_by_number(walk: Path) -> None:
    everything = body_of(walk, "LeftHip", "LeftAnkle")
    some = body_of(walk, "LeftHip", "LeftAnkle", frames=(3, 11), every=4)
    assert some.goal_names == ("3", "7", "11")
    np.testing.assert_array_equal(some.goals, np.asarray(everything.goals)[[3, 7, 11]])
    assert some.frame_time == pytest.approx(0.1)


def test_bones_lie_along_z_and_y_faces_ahead(walk: Path) -> None:
    """In the zero pose, in the world: what makes knees bend forward."""
    chain = body_of(walk, "LeftHip", "LeftAnkle").chain
    assert chain.is_straight is False  # the knee's offset is a little off
    np.testing.assert_allclose(chain.offsets[1:, :2], 0.0, atol=1e-12)
    _, turns = forward_kinematics(chain, np.zeros((3, 3)))
    assert turns[0][2, 1] > 0.99


def test_one_rotation_channel_is_a_hinge(walk: Path) -> None:
    chain = body_of(walk, "RightHip", "RightAnkle").chain
    np.testing.assert_array_equal(chain.high > chain.low, [[1, 1, 1], [0, 1, 0], [1, 1, 1]])


@pytest.mark.parametrize("side", [LEFT, RIGHT], ids=["left", "right"])
def test_a_baked_clip_read_back_has_the_solved_angles(
    walk: Path, scene_of: Solve, tmp_path: Path, side: str
) -> None:
    """To 1e-6 degrees in every joint that was solved, and the end where the solve put it."""
    scene = scene_of(side + OPTIONS)
    bake = bake_scene(scene, REGISTRY)
    written = tmp_path / "baked.bvh"
    written.write_text(bvh_out.write(bake))
    back = replace(scene.body, clip=read_bvh(written))  # type: ignore[type-var]
    assert isinstance(back, ClipBody)
    assert back.join is not None
    for k, index in enumerate(back.at[:-1]):
        joint = back.clip.joints[index]
        columns = list(joint.columns[len(joint.moves) :])
        turned = channels_to_matrix(np.radians(back.clip.frames[:, columns]), joint.turns)
        frame = back.join.frames[k]
        own = frame.T @ Y_UP.rotations(turned) @ frame
        solved = hpb_to_matrix(bake.solution.angles[:, k])
        np.testing.assert_allclose(own, solved, atol=np.radians(1e-6) / 10)


def test_all_but_the_solved_joints_stays_as_it_was(walk: Path, scene_of: Solve) -> None:
    """Channel for channel, the end's own rotation too."""
    scene = scene_of(LEFT + OPTIONS)
    angles = bake_scene(scene, REGISTRY).solution.angles
    body = scene.body
    assert isinstance(body, ClipBody)
    baked = body.baked(angles)
    changed = np.flatnonzero((baked.frames != body.clip.frames).any(axis=0))
    assert set(changed) <= {6, 7, 8, 12, 13, 14}
    assert baked.joints == body.clip.joints


def test_a_clips_own_angles_go_through_the_chain_unharmed(walk: Path) -> None:
    """The clip's rotations as the chain's angles give the clip's channels back."""
    body = body_of(walk, "LeftHip", "LeftAnkle")
    assert body.join is not None
    angles = []
    for k, index in enumerate(body.at):
        joint = body.clip.joints[index]
        columns = list(joint.columns[len(joint.moves) :])
        turned = channels_to_matrix(np.radians(body.clip.frames[:, columns]), joint.turns)
        own = body.join.frames[k].T @ Y_UP.rotations(turned) @ body.join.frames[k]
        angles.append(matrix_to_hpb(own))
    baked = body.baked(np.stack(angles, axis=1))
    np.testing.assert_allclose(baked.frames, body.clip.frames, atol=1e-9)
    places, _ = forward_kinematics(body.chain, np.stack(angles, axis=1))
    np.testing.assert_allclose(places[:, -1], np.asarray(body.goals), atol=1e-9)


def test_a_mirrored_clip_is_the_mirror_image_with_sides_exchanged(walk: Path) -> None:
    clip = read_bvh(walk)
    plain, _ = clip_motion(clip).world()
    mirror = clip_motion(mirrored_clip(clip))
    places, _ = mirror.world()
    names = clip_motion(clip).names
    for k, name in enumerate(names):
        swapped = name.replace("Left", "#").replace("Right", "Left").replace("#", "Right")
        other = places[:, mirror.names.index(swapped)]
        np.testing.assert_allclose(other, Y_UP.points(plain[:, k]), atol=1e-12)


@pytest.mark.parametrize(
    "order", [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
)
def test_channels_of_any_order_give_their_matrix_back(order: tuple[int, int, int]) -> None:
    """Also where two axes meet, and without a jump on the way through."""
    ramp = np.linspace(-400.0, 400.0, 801)
    angles = np.radians(np.stack([ramp, 0.225 * ramp, 40.0 * np.sin(ramp / 50)], axis=-1))
    found = matrix_to_channels(channels_to_matrix(angles, order), order)
    np.testing.assert_allclose(
        channels_to_matrix(found, order), channels_to_matrix(angles, order), atol=1e-14
    )
    assert np.abs(np.diff(found[50:-50], axis=0)).max() < np.radians(2.0)


def test_a_chain_of_its_own_becomes_a_clip_another_reader_reads(
    scene_of: Solve, tmp_path: Path, bvh_positions: Positions
) -> None:
    """Frozen rotations, a turned base and ranges and all: to 1e-6 of its lengths."""
    scene = scene_of(
        "limbik: 1\nchain:\n  base: {position: [1, 2, 3], rotation: [20, 30, 40]}\n  joints:\n"
        "    - {name: a, offset: [0, 1, 0], frozen: [0, -90, 90]}\n"
        "    - {name: b, offset: [0, 0, 30], frozen: [10, 20, -90], pitch: [0, 150]}\n"
        "    - {name: c, offset: [0, 2, 26]}\ngoals:\n"
        + "".join(f"  - {{position: [{k}, {20 - k}, 30]}}\n" for k in range(12))
    )
    bake = bake_scene(scene, REGISTRY, frame_time=0.5)
    path = tmp_path / "own.bvh"
    path.write_text(bvh_out.write(bake))
    places = bvh_positions(path)
    for k, name in enumerate("abc"):
        np.testing.assert_allclose(
            Y_UP.points(places[name]), bake.solution.positions[:, k], atol=1e-6
        )
    assert read_bvh(path).frame_time == 0.5


@pytest.mark.parametrize("follow", [False, True])
def test_a_clip_bakes_without_loss(follow: bool, tmp_path: Path, bvh_positions: Positions) -> None:
    """LIMBIK_TEST_BVH: file:base:end of a real capture; all frames but an added first pose."""
    shipped = Path(__file__).parents[2] / "configs" / "walk.bvh"
    given = os.environ.get("LIMBIK_TEST_BVH", f"{shipped}:LeftUpLeg:LeftFoot")
    file, base, end = given.rsplit(":", 2)
    last = len(read_bvh(Path(file)).frames) - 1
    options = "options: {max_iterations: 200, tolerance: 0.001}\n"
    chain = f"{{bvh: '{file}', base: {base}, end: {end}, frames: [1, {last}]}}"
    (tmp_path / "real.yaml").write_text(
        f"limbik: 1\nfollow: {follow}\nchain: {chain}\n{options}".replace("True", "true").replace(
            "False", "false"
        )
    )
    scene = read_scene(tmp_path / "real.yaml", REGISTRY)
    bake = bake_scene(scene, REGISTRY)
    written = tmp_path / "baked.bvh"
    written.write_text(bvh_out.write(bake))
    before, after = bvh_positions(Path(file)), bvh_positions(written)
    moved = np.linalg.norm(after[end] - before[end][1:], axis=1)
    np.testing.assert_allclose(moved, np.asarray(bake.solution.distance), atol=1e-6)
    for name in [base, *(name for name in before if not name.startswith("Left"))]:
        np.testing.assert_allclose(after[name], before[name][1:], atol=1e-6)


CLIP = """\
HIERARCHY
ROOT a
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT b
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT c
    {
      OFFSET 0 8 0
      CHANNELS 0
      End Site
      {
        OFFSET 0 0 0
      }
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.1
1 2 3 4 5 6 7 8 9
1 2 3 4 5 6 7 8 9
"""
SPOILT = [
    ("HIERARCHY", "HIERARCH", "1:1: error[bvh]: expected HIERARCHY, found 'HIERARCH'"),
    ("ROOT a", "JOINT a", "2:1: error[bvh]: expected ROOT, found 'JOINT'"),
    ("ROOT a", "ROOT", "3:1: error[name]: the joint has no name"),
    ("JOINT b", "JOINT a", "6:9: error[duplicate-name]: the joint 'a' is given twice, first at"),
    ("OFFSET 0 10 0", "OFFSET 0 ten 0", "8:14: error[number]: not a number: 'ten'"),
    ("OFFSET 0 10 0", "OFFSET 0 10", "9:5: error[number]: not a number: 'CHANNELS'"),
    ("OFFSET 0 10 0", "OFFSET 0 1e9 0", "8:14: error[range]: must be at most 1e+06 in size: 1e9"),
    ("    OFFSET 0 10 0\n", "", "18:3: error[missing-key]: joint 'b' has no OFFSET"),
    (
        "CHANNELS 3 Z",
        "CHANNELS 2 Z",
        "9:36: error[bvh]: expected OFFSET, CHANNELS, JOINT, End Site",
    ),
    ("CHANNELS 3 Z", "CHANNELS 9 Z", "9:14: error[number]: the number of channels must be 0 to 6"),
    ("CHANNELS 3 Z", "CHANNELS 3 W", "9:16: error[channel]: no such channel: 'Wrotation'"),
    ("CHANNELS 3 Z", "CHANNELS 3 Y", "9:36: error[channel]: joint 'b' has the channel Yrotation"),
    ("CHANNELS 0", "CHANNELS 0\nCHANNELS 0", "14:1: error[duplicate]: joint 'c' has two CHANNELS"),
    ("End Site", "End", "15:7: error[bvh]: expected SITE, found '{'"),
    ("MOTION", "MOTIN", "21:1: error[bvh]: expected ROOT or MOTION, found 'MOTIN'"),
    ("Frames: 2", "Frames: two", "22:9: error[number]: the number of frames must be 0 to"),
    ("Frames: 2", "Frames: 3", "25:18: error[cut]: the file ends after 2 of 3 frames"),
    ("Frames: 2", "Frames: 1", "25:1: error[length]: the file announces 1 frames and holds 2"),
    ("Frame Time: 0.1", "Frame Time: 0", "23:13: error[range]: the frame time must be above 0"),
    ("Frame Time: 0.1", "Frame Time: nan", "23:13: error[number]: not a number: 'nan'"),
    ("0.1\n1 2 3", "0.1\n1 x 3", "24:3: error[number]: not a number: 'x'"),
    ("0.1\n1 2 3", "0.1\n1 1_0 3", "24:3: error[number]: not a number: '1_0'"),
    ("0.1\n1 2 3", "0.1\n1 inf 3", "24:3: error[number]: not a number: 'inf'"),
    ("0.1\n1 2 3", "0.1\n1 2e7 3", "24:3: error[range]: must be at most 1e+06 in size"),
    ("0.1\n1 2 3", "0.1\n1 2", "24:1: error[length]: a frame has 9 numbers, this line has 8"),
    ("1 2 3 4 5 6 7 8 9\n1 2", "1 2 3 4 5 6 7 8 9 10\n1 2", "24:1: error[length]: a frame has 9"),
]


@pytest.mark.parametrize(("old", "new", "expected"), SPOILT, ids=[row[2][:40] for row in SPOILT])
def test_a_malformed_clip_is_refused_with_line_and_column(
    tmp_path: Path, old: str, new: str, expected: str
) -> None:
    assert CLIP.count(old) == 1
    path = tmp_path / "clip.bvh"
    path.write_text(CLIP.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        read_bvh(path)
    assert str(caught.value).startswith(f"{path}:{expected}")


@pytest.mark.parametrize("length", [0, 9, 10, 16, 40, 150, 260, 330, 345, 360])
def test_a_cut_clip_is_refused_and_never_hangs(tmp_path: Path, length: int) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(CLIP[:length])
    with pytest.raises(InputError) as caught:
        read_bvh(path)
    (fault,) = caught.value.faults
    assert fault.line >= 1
    assert fault.code in ("cut", "bvh", "number", "channel", "length")


def test_an_empty_clip_says_what_should_stand_there(tmp_path: Path) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text("")
    with pytest.raises(InputError, match=r":1:1: error\[cut\]: the file ends where HIERARCHY"):
        read_bvh(path)


def test_a_clip_of_100_mb_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "clip.bvh"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(InputError, match="the file is larger than 64 MB"):
        read_bvh(path)


def test_depth_and_number_of_joints_are_bounded(tmp_path: Path) -> None:
    path = tmp_path / "clip.bvh"
    path.write_text(
        "HIERARCHY\nROOT r\n{" + "".join(f"JOINT j{k}\n{{\nOFFSET 0 0 1\n" for k in range(5000))
    )
    with pytest.raises(InputError, match=r"error\[too-deep\]: nested deeper than 256"):
        read_bvh(path)
    flat = "".join(f"JOINT j{k}\n{{\nOFFSET 0 0 1\n}}\n" for k in range(3000))
    path.write_text("HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\n" + flat)
    with pytest.raises(InputError, match=r"error\[too-many\]: more than 2000 joints"):
        read_bvh(path)


CHOICES = [
    ("base: LeftHipp, end: LeftAnkle", "2:30: error[unknown-joint]: chain.base: the clip has no"),
    ("base: LeftAnkle, end: LeftHip", "the joint 'LeftHip' does not hang from 'LeftAnkle'"),
    (
        "base: LeftHip, end: LeftAnkle, frames: [5, 99]",
        "chain.frames: frames 5 to 99: the clip has",
    ),
    ("base: LeftHip, end: LeftAnkle, frames: 5", "must be a list of the first and the last frame"),
    ("base: LeftHip, end: LeftAnkle, every: 0", "chain.every: must be at least 1, not 0"),
]


@pytest.mark.parametrize(("keys", "expected"), CHOICES, ids=[row[0] for row in CHOICES])
def test_a_wrong_choice_is_pointed_at_in_the_scene(
    walk: Path, scene_of: Solve, keys: str, expected: str
) -> None:
    with pytest.raises(SceneError) as caught:
        scene_of(f"limbik: 1\nchain: {{bvh: walk.bvh, {keys}}}\n")
    assert expected in str(caught.value)


def test_a_joint_that_slides_is_refused_by_name(walk: Path, walker: Callable[[], str]) -> None:
    lines = walker().splitlines()
    row = lines[-1].split()
    row[10] = "-45"
    walk.write_text("\n".join([*lines[:-1], " ".join(row)]) + "\n")
    with pytest.raises(InputError, match="joint 'LeftKnee' slides by up to 3; limbik's bones"):
        body_of(walk, "LeftHip", "LeftAnkle")


def test_two_rotation_channels_are_refused_by_name(walk: Path, walker: Callable[[], str]) -> None:
    text = walker().replace("1 Xrotation", "2 Xrotation Yrotation")
    rows = [line + " 0" if line[0] in "-0123456789" else line for line in text.splitlines()]
    walk.write_text("\n".join(rows) + "\n")
    with pytest.raises(InputError, match="joint 'RightKnee' has two rotation channels"):
        body_of(walk, "RightHip", "RightAnkle")


def test_a_scenes_own_goals_replace_the_clips(walk: Path, scene_of: Solve) -> None:
    scene = scene_of(LEFT + "goals: [{name: there, position: [0, -70, 20]}]\n")
    assert scene.goal_names == ("there",)


def test_inspection_names_chains_that_can_be_read(walk: Path) -> None:
    found = inspect(walk)
    assert found.title == "motion clip: 7 joints, 40 frames, 1 s"
    ends = [(base, end) for base, end, _ in found.chains]
    assert ends == [("LeftHip", "LeftAnkle"), ("RightHip", "RightAnkle")]
    assert all(len(body_of(walk, base, end).chain) == 3 for base, end in ends)


@pytest.mark.filterwarnings("ignore")
def test_positions_are_those_of_pybvh(tmp_path: Path) -> None:
    """Of a clip as it is, and of one with turned joints that limbik has written."""
    pybvh = pytest.importorskip("pybvh")
    shipped = Path(__file__).parents[2] / "configs"
    body = bake_body(bodyscene.read_body(shipped / "body.yaml", REGISTRY), REGISTRY)
    (tmp_path / "body.bvh").write_text(bvh_out.write_body(body))
    for path in (shipped / "walk.bvh", tmp_path / "body.bvh"):
        clip, other = read_bvh(path), pybvh.read_bvh_file(str(path))
        places, _ = clip_motion(clip).world()
        names = [node.name for node in other.nodes]
        for index, name in enumerate(clip.names):
            expected = other.node_positions()[:, names.index(name)]
            np.testing.assert_allclose(Y_UP.points(places[:, index]), expected, atol=1e-6)
