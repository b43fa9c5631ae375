"""Robots become chains that move exactly as their files say, or are refused with a place."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.errors import Fault, InputError, SceneError
from limbik.core.frames import Z_UP
from limbik.core.pose import forward_kinematics
from limbik.core.scene import Scene
from limbik.plugins.formats.urdf import read_urdf
from limbik.plugins.formats.urdf_chain import UrdfModel, inspect, read_body

Solve = Callable[[str], Scene]
Pose = Callable[[Path, str, str, dict[str, float]], tuple[Any, Any]]
GOALS = "\ngoals: [{position: [1, 2, 0.5]}]\n"
CRANE = "limbik: 1\nchain: {urdf: crane.urdf, base: ground, end: hook}" + GOALS


def random_angles(scene_chain: Any, count: int) -> Any:
    """Angles within the chain's limits, whole turns where it is free."""
    low = np.maximum(scene_chain.low, -2 * np.pi)
    high = np.minimum(scene_chain.high, 2 * np.pi)
    return np.random.default_rng(7).uniform(low, high, (count, *low.shape))


def test_positions_and_rotations_are_those_of_the_file(
    urdf_pose: Pose, crane: Path, scene_of: Solve
) -> None:
    """To 1e-12, over hinges askew, roll pitch yaw at 90° and a range shifted across 180°."""
    scene = scene_of(CRANE)
    assert scene.body is not None
    angles = random_angles(scene.chain, 100)
    places, turns = forward_kinematics(scene.chain, angles)
    values = scene.body.values(angles)
    assert values is not None
    for k, row in enumerate(values.rows):
        pose = dict(zip(values.names, row.tolist(), strict=True))
        place, turn = urdf_pose(crane, "ground", "hook", pose)
        np.testing.assert_allclose(places[k, -1], Z_UP.points(place), atol=1e-12)
        np.testing.assert_allclose(turns[k, -1], Z_UP.rotations(turn), atol=1e-12)


def test_hinges_keep_names_axes_and_limits(crane: Path, scene_of: Solve) -> None:
    """One angle a joint is free to turn; the model's values run from limit to limit."""
    scene = scene_of(CRANE)
    chain = scene.chain
    assert chain.names == ("slew", "luff", "fold", "hook")
    np.testing.assert_array_equal((chain.high > chain.low).sum(axis=1), [1, 1, 1, 0])
    low, high = (
        scene.body.values(np.where(np.isfinite(side), side, 0.0)[None]).rows[0]  # type: ignore[union-attr]
        for side in (chain.low, chain.high)
    )
    np.testing.assert_allclose(low[1:], [-0.35, 0.5], rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(high[1:], [3.75, 2.5], rtol=0.0, atol=1e-15)
    assert np.isinf(chain.low[0]).sum() == 1  # continuous, whatever its <limit> says


def test_a_range_across_180_is_counted_from_its_middle(crane: Path, scene_of: Solve) -> None:
    luff = scene_of(CRANE).chain.joints[1]
    (span,) = [limit for limit in luff.limits if limit and limit != (0.0, 0.0)]
    np.testing.assert_allclose(span, [-2.05, 2.05], atol=1e-15)


def test_a_range_of_a_whole_turn_does_not_limit(
    robot_text: str, crane: Path, scene_of: Solve
) -> None:
    crane.write_text(robot_text.replace('lower="-0.35" upper="3.75"', 'lower="-9.4" upper="9.4"'))
    assert np.isinf(scene_of(CRANE).chain.low[1]).sum() == 1


def test_a_rest_value_is_the_models_and_one_out_of_range_is_told(
    crane: Path, scene_of: Solve
) -> None:
    scene = scene_of(CRANE.replace("end: hook", "end: hook, rest: {luff: 90, slew: 30}"))
    rest = scene.body.values(scene.chain.rest[None]).rows[0]  # type: ignore[union-attr]
    np.testing.assert_allclose(np.degrees(rest), [30.0, 90.0, np.degrees(0.5)], atol=1e-12)
    assert scene.notes[0] == "joint 'fold': 0° is outside its range; it rests at 28.65°"


def test_scale_multiplies_every_length(crane: Path, scene_of: Solve) -> None:
    metres = scene_of(CRANE).chain
    centimetres = scene_of(CRANE.replace("end: hook", "end: hook, scale: 100")).chain
    np.testing.assert_allclose(centimetres.offsets, 100.0 * metres.offsets, atol=1e-12)


def test_bones_off_the_axes_are_told_until_the_option_is_set(crane: Path, scene_of: Solve) -> None:
    note = "some bones lie off their joints' Z axes: set off_axis: true in the options"
    assert note in scene_of(CRANE).notes
    assert note not in scene_of(CRANE + "options: {off_axis: true}\n").notes


NUMBER = st.floats(-3.0, 3.0).map(lambda v: round(v, 6))
HALF_PI = st.sampled_from(["1.5707963", "-1.5707963267948966", "1.57", "3.14159265358979", "0"])
THREE = st.tuples(NUMBER, NUMBER, NUMBER).map(lambda v: " ".join(map(str, v)))
AXIS = st.sampled_from(["1 0 0", "0 1 0", "0 0 -1", "0.6 0 0.8", "1 2 -3"])
TURN = st.one_of(THREE, st.tuples(HALF_PI, HALF_PI, HALF_PI).map(" ".join))
LINK = st.tuples(THREE, TURN, AXIS, st.booleans())


@given(links=st.lists(LINK, min_size=2, max_size=6), seed=st.integers(0, 2**32 - 1))
def test_any_robot_of_hinges_moves_as_its_file_says(
    urdf_pose: Pose,
    tmp_path_factory: pytest.TempPathFactory,
    links: list[tuple[str, str, str, bool]],
    seed: int,
) -> None:
    """To 1e-9 for positions of some metres, wherever axes meet."""
    lines = ['<robot name="r"><link name="l0"/>']
    for k, (xyz, rpy, axis, is_hinge) in enumerate(links):
        kind = "continuous" if is_hinge or k == 0 else "fixed"
        lines.append(
            f'<link name="l{k + 1}"/><joint name="j{k}" type="{kind}"><parent link="l{k}"/>'
            f'<child link="l{k + 1}"/><origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
            "</joint>"
        )
    lines.append(f'<link name="end"/><joint name="e" type="fixed"><parent link="l{len(links)}"/>')
    lines.append('<child link="end"/><origin xyz="0.1 0 1"/></joint></robot>')
    path = tmp_path_factory.mktemp("robot") / "robot.urdf"
    path.write_text("".join(lines))
    body = read_body(UrdfModel(urdf=str(path), base="l0", end="end", rest={}), Path())
    angles = np.random.default_rng(seed).uniform(-3, 3, (1, len(body.chain), 3))
    angles = np.where(body.chain.high > body.chain.low, angles, 0.0)
    values = body.values(angles)
    assert values is not None
    pose = dict(zip(values.names, values.rows[0].tolist(), strict=True))
    place, turn = urdf_pose(path, "l0", "end", pose)
    places, turns = forward_kinematics(body.chain, angles)
    np.testing.assert_allclose(places[0, -1], Z_UP.points(place), atol=1e-9)
    np.testing.assert_allclose(turns[0, -1], Z_UP.rotations(turn), atol=1e-9)


def test_inspection_names_chains_that_can_be_read(robot_text: str, crane: Path) -> None:
    found = inspect(crane)
    assert found.title == "robot 'crane': 8 links, 7 joints, 4 of them hinges"
    row = next(row for row in found.rows if row[0] == "luff")
    assert row == ("luff", "revolute", "0 0.7071 0.7071", "-20.05 to 214.9°", "cabin", "boom")
    assert [row[1] for row in found.rows if row[0] == "twin"] == ["revolute, copies fold"]
    # each tip of the crane hangs from a joint limbik cannot solve: the chains end above them
    hinges = "3 hinges: slew, luff, fold"
    assert found.chains == (("ground", "hook", hinges), ("ground", "jib", hinges))
    crane.write_text(
        re.sub(r'  <joint name="(winch|twin).*?</joint>\n', "", robot_text, flags=re.S)
    )
    (chain,) = inspect(crane).chains
    assert chain == ("ground", "hook", "3 hinges: slew, luff, fold")


def corpus() -> list[Path]:
    """Robots of whatever packages are installed."""
    site = Path(np.__file__).parents[1]
    folders = (site / "jvrc_description", site / "cmeel.prefix" / "share")
    return sorted(path for folder in folders for path in folder.rglob("*.urdf"))


def every_chain(path: Path) -> list[tuple[str, str]]:
    return [(base, end) for base, end, _ in inspect(path).chains]


def test_the_jvrc_humanoid_moves_as_an_independent_reader_says(urdf_pose: Pose) -> None:
    """To 1e-9 for every limb, over random configurations."""
    jvrc = pytest.importorskip("jvrc_description")
    path = Path(jvrc.__file__).parent / "urdf" / "jvrc1.urdf"
    chains = every_chain(path)
    assert len(chains) >= 4
    for base, end in chains:
        body = read_body(UrdfModel(urdf=str(path), base=base, end=end, rest={}), Path())
        angles = random_angles(body.chain, 10)
        places, turns = forward_kinematics(body.chain, angles)
        values = body.values(angles)
        assert values is not None
        for k, row in enumerate(values.rows):
            pose = dict(zip(values.names, row.tolist(), strict=True))
            place, turn = urdf_pose(path, base, end, pose)
            np.testing.assert_allclose(places[k, -1], Z_UP.points(place), atol=1e-9)
            np.testing.assert_allclose(turns[k, -1], Z_UP.rotations(turn), atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("path", corpus(), ids=lambda path: path.name)
def test_a_real_robot_is_read_or_refused_with_a_place(path: Path) -> None:
    """Every chain an inspection names can be read; a refusal has a file and a line."""
    faults: tuple[Fault, ...] = ()
    chains: list[tuple[str, str]] = []
    try:
        chains = every_chain(path)
    except InputError as error:
        faults = error.faults
    assert [fault for fault in faults if fault.file != str(path) or not fault.line] == []
    for base, end in chains:
        assert read_body(UrdfModel(urdf=str(path), base=base, end=end, rest={}), Path()).chain


SPOILT = [
    ('<robot name="crane">', '<robot name="crane"><!DOCTYPE x>', "1:23: error[xml]: not XML: "),
    (
        "<robot",
        "\n<?xml version='1.0'?><robot",
        "2:1: error[xml]: not XML: XML or text declaration",
    ),
    ('xyz="0 0 2"', 'xyz="0 0 2,"', "6:63: error[number]: joint 'slew': xyz: not a number: '2,'"),
    ('xyz="0 0 2"', 'xyz="0 0"', "6:63: error[length]: joint 'slew': xyz must be three numbers"),
    ('xyz="0 0 2"', 'xyz="0 0 nan"', "6:63: error[number]: joint 'slew': xyz: not a number: 'nan'"),
    ('xyz="0 0 2"', 'xyz="0 0 0"', "6:63: error[axis]: joint 'slew': the axis has no length"),
    ('xyz="0 0 2"', 'xyz="0 0 1_0"', "6:63: error[number]: joint 'slew': xyz: not a number: '1_0'"),
    ('xyz="2 0.1 0"', 'xyz="2e9 0.1 0"', "19:18: error[range]: joint 'fold': xyz: must be at most"),
    ('lower="0.5" upper="2.5"', 'lower="3" upper="2"', "the lower limit 3 is above the upper 2"),
    ('type="continuous"', 'type="ball"', "4:28: error[choice]: joint 'slew': the type must be one"),
    ('<child link="jib"/>', "", "error[missing-key]: joint 'fold' has no child link"),
    (
        '<child link="jib"/>',
        '<child link="gib"/>',
        "18:40: error[unknown-link]: joint 'fold': there",
    ),
    ('<child link="jib"/>', '<child link="boom"/>', "hangs from two joints, 'luff' and 'fold'"),
    (
        '<parent link="ground"/>',
        '<parent link="jib"/>',
        "error[loop]: the link 'tower' hangs from it",
    ),
    ('<link name="rope"/>', '<link name="hook"/>', "the link 'hook' is given twice, first at line"),
    ('joint name="tip"', 'joint name="fold"', "the joint 'fold' is given twice, first at line 17"),
    ('joint name="tip"', "joint", "error[missing-key]: this <joint> has no name"),
    ('xyz="2 0.1 0"', 'xyz="${l} 0 0"', "19:5: error[xacro]: this is xacro, not yet URDF"),
    (
        "</robot>",
        "<xacro:arm/></robot>",
        "31:1: error[xacro]: this is xacro, not yet URDF: expand it",
    ),
    (
        '<limit lower="0.5" upper="2.5" effort="1" velocity="1"/>',
        "",
        "has no <limit> (a joint that",
    ),
    ("<robot", "<sdf/><robot", "1:7: error[xml]: not XML: junk after document element"),
]


@pytest.mark.parametrize(("old", "new", "expected"), SPOILT, ids=[row[1][:24] for row in SPOILT])
def test_a_malformed_robot_is_refused_with_line_and_column(
    robot_text: str, crane: Path, old: str, new: str, expected: str
) -> None:
    assert robot_text.count(old) == 1 or old in ("<robot",)
    crane.write_text(robot_text.replace(old, new))
    with pytest.raises(InputError) as caught:
        read_urdf(crane)
    assert any(expected in str(fault) for fault in caught.value.faults), str(caught.value)
    assert all(fault.file == str(crane) and fault.line for fault in caught.value.faults)


def test_entities_are_refused_before_they_expand(robot_text: str, crane: Path) -> None:
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]>\n' + robot_text
    crane.write_text(bomb)
    with pytest.raises(InputError, match=r":1:13: error\[doctype\]: a document type or entities"):
        read_urdf(crane)


def test_a_file_above_10_mb_is_refused_unread(crane: Path) -> None:
    with crane.open("wb") as stream:
        stream.truncate(10_000_001)
    with pytest.raises(
        InputError, match=r":1:1: error\[too-large\]: the file is larger than 10 MB"
    ):
        read_urdf(crane)


@pytest.mark.parametrize(
    ("content", "place"), [(b"", "1:1"), (b"hello\n", "1:1"), (b"\0\0", "1:1")]
)
def test_what_is_no_xml_is_called_so(crane: Path, content: bytes, place: str) -> None:
    crane.write_bytes(content)
    with pytest.raises(InputError, match=rf":{place}: error\[xml\]: not XML"):
        read_urdf(crane)


def test_a_robot_without_a_name_is_called_after_its_file(robot_text: str, crane: Path) -> None:
    crane.write_text(robot_text.replace('<robot name="crane">', "<robot>"))
    robot = read_urdf(crane)
    assert robot.name == "crane"
    assert robot.notes[0] == "the robot has no name; it is called 'crane' after its file"


CHAINS = [
    (
        "base: grond, end: hook",
        "2:33: error[unknown-link]: chain.base: the robot has no link 'grond'",
    ),
    ("base: hook, end: ground", "2:33: error[chain]: chain.base: the link 'ground' does not hang"),
    ("base: ground, end: ground", "does not hang from 'ground' (it hangs from: nothing, it is a"),
    ("base: ground, end: rope", "crane.urdf:24:29: error[prismatic]: joint 'winch' slides"),
    (
        "base: ground, end: copy",
        "crane.urdf:27:3: error[mimic]: joint 'twin' copies the joint 'fold'",
    ),
    ("base: tower, end: cabin", "error[chain]: chain.end: there is no hinge between"),
    ("base: ground", "2:8: error[missing-key]: chain.end: key 'end' is missing"),
    ("bass: ground, end: hook", "unknown key 'bass' (did you mean 'base'?)"),
    (
        "base: ground, end: hook, rest: {bluff: 3}",
        "error[unknown-joint]: chain.rest: no hinge 'bluff'",
    ),
    ("base: ground, end: hook, scale: 0", "chain.scale: must be above 0.0, not 0"),
]


@pytest.mark.parametrize(("keys", "expected"), CHAINS, ids=[row[0] for row in CHAINS])
def test_a_wrong_choice_is_pointed_at_in_the_scene_or_the_robot(
    crane: Path, scene_of: Solve, keys: str, expected: str
) -> None:
    with pytest.raises(SceneError) as caught:
        scene_of(f"limbik: 1\nchain: {{urdf: crane.urdf, {keys}}}" + GOALS)
    assert expected in str(caught.value)


def test_a_missing_robot_is_pointed_at_in_the_scene(scene_of: Solve) -> None:
    with pytest.raises(SceneError, match=r"scene.yaml:2:15: error\[unreadable\]: chain.urdf: "):
        scene_of(CRANE)


def test_a_robot_needs_goals(crane: Path, scene_of: Solve) -> None:
    with pytest.raises(SceneError, match="key 'goals' is missing"):
        scene_of(CRANE.removesuffix(GOALS) + "\n")


def test_faults_of_the_robot_and_of_the_scene_come_together(crane: Path, scene_of: Solve) -> None:
    with pytest.raises(SceneError) as caught:
        scene_of(CRANE.replace("hook", "hok") + "options: {smoothing: 3}\nfk: {ghost: [0, 0, 0]}\n")
    assert [fault.key for fault in caught.value.faults] == ["chain.end", "options.smoothing"]


def test_fk_offsets_and_bend_reference_are_checked_against_the_robots_joints(
    crane: Path, scene_of: Solve
) -> None:
    with pytest.raises(SceneError) as caught:
        scene_of(CRANE + "options: {bend_reference: 9}\nfk: {lufff: [0, 0, 0]}\n")
    assert "did you mean 'luff'?" in str(caught.value)
    assert "must be 1 to 3 in a chain of 4 joints" in str(caught.value)


def test_reading_never_follows_a_mesh(robot_text: str, crane: Path) -> None:
    mesh = (
        '<link name="rope"><visual><geometry><mesh filename="/no/such"/></geometry></visual></link>'
    )
    crane.write_text(robot_text.replace('<link name="rope"/>', mesh))
    assert len(read_urdf(crane).links) == 8


def test_chains_end_above_a_gripper_that_slides_or_copies(tmp_path: Path) -> None:
    joints = [("a", "revolute", ""), ("b", "revolute", ""), ("hand", "fixed", "")]
    joints += [("left", "prismatic", ""), ("right", "revolute", '<mimic joint="b"/>')]
    text = '<robot name="g"><link name="base"/>'
    parent = "base"
    for name, kind, more in joints:
        text += f'<link name="{name}_link"/><joint name="{name}" type="{kind}">'
        text += f'<parent link="{parent}"/><child link="{name}_link"/><origin xyz="0 0 1"/>'
        text += f'<axis xyz="1 0 0"/><limit lower="-1" upper="1"/>{more}</joint>'
        parent = "hand_link" if parent == "hand_link" else f"{name}_link"
    (tmp_path / "g.urdf").write_text(text + "</robot>")
    chains = [(base, end) for base, end, _ in inspect(tmp_path / "g.urdf").chains]
    assert chains == [("base", "hand_link")]
