"""Robots and clips of our own for the tests, and an independent way to read each."""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene, read_scene

ROBOT = """\
<robot name="crane">
  <link name="ground"/> <link name="tower"/> <link name="boom"/> <link name="jib"/>
  <link name="hook"/> <link name="cabin"/> <link name="rope"/> <link name="copy"/>
  <joint name="slew" type="continuous">
    <parent link="ground"/> <child link="tower"/>
    <origin xyz="0.1 0.2 1.5" rpy="0.1 -0.2 0.3"/> <axis xyz="0 0 2"/>
    <limit lower="0" upper="0" effort="1" velocity="1"/>
  </joint>
  <joint name="weld" type="fixed">
    <parent link="tower"/> <child link="cabin"/> <origin rpy="1.5707963 0 0" xyz="0 0 0.5"/>
  </joint>
  <joint name="luff" type="revolute">
    <parent link="cabin"/> <child link="boom"/>
    <origin xyz="0.3 0 0" rpy="0 1.57079632 0.4"/> <axis xyz="0 1 1"/>
    <limit lower="-0.35" upper="3.75" effort="1" velocity="1"/>
  </joint>
  <joint name="fold" type="revolute">
    <parent link="boom"/> <child link="jib"/>
    <origin xyz="2 0.1 0"/> <limit lower="0.5" upper="2.5" effort="1" velocity="1"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="jib"/> <child link="hook"/> <origin xyz="0 1.2 0.1" rpy="0 0 0.5"/>
  </joint>
  <joint name="winch" type="prismatic">
    <parent link="hook"/> <child link="rope"/> <limit lower="0" upper="9"/>
  </joint>
  <joint name="twin" type="revolute">
    <parent link="jib"/> <child link="copy"/> <limit lower="0" upper="1"/>
    <mimic joint="fold"/>
  </joint>
</robot>
"""
Solve = Callable[[str], Scene]


@pytest.fixture(scope="session")
def robot_text() -> str:
    """The crane's file."""
    return ROBOT


@pytest.fixture(scope="session")
def urdf_pose() -> Callable[[Path, str, str, dict[str, float]], tuple[Array, Array]]:
    """Position and rotation of a link seen from another, by plain right-handed matrices."""
    return _urdf_pose


@pytest.fixture(scope="session")
def bvh_positions() -> Callable[[Path], dict[str, Array]]:
    """World positions of every joint of a clip, right-handed, by another reader than limbik's."""
    return _bvh_positions


@pytest.fixture(scope="session")
def walker() -> Callable[[], str]:
    """Text of a walker's clip."""
    return _walker


@pytest.fixture
def scene_of(tmp_path: Path) -> Solve:
    """Read a scene of a chain mapping; files lie in a fresh folder."""

    def read(text: str) -> Scene:
        path = tmp_path / "scene.yaml"
        path.write_text(text, encoding="utf-8")
        return read_scene(path, Registry(third_party=False))

    return read


@pytest.fixture
def crane(tmp_path: Path) -> Path:
    """A crane whose hinges lie askew."""
    path = tmp_path / "crane.urdf"
    path.write_text(ROBOT, encoding="utf-8")
    return path


def _urdf_pose(path: Path, base: str, end: str, values: dict[str, float]) -> tuple[Array, Array]:
    """Position and rotation of a link seen from another, by plain right-handed matrices."""
    pose = np.eye(4)
    every: list[Any] = ElementTree.parse(path).getroot().findall("joint")
    joints = {joint.find("child").get("link"): joint for joint in every}
    while end != base:
        joint = joints[end]
        origin, axis = joint.find("origin"), joint.find("axis")
        x, y, z = map(
            float, (origin.get("rpy", "0 0 0") if origin is not None else "0 0 0").split()
        )
        step = np.eye(4)
        step[:3, :3] = _about((0, 0, 1), z) @ _about((0, 1, 0), y) @ _about((1, 0, 0), x)
        if origin is not None:
            step[:3, 3] = [float(v) for v in origin.get("xyz", "0 0 0").split()]
        if joint.get("name") in values:
            way = [float(v) for v in (axis.get("xyz") if axis is not None else "1 0 0").split()]
            turn = np.eye(4)
            turn[:3, :3] = _about(way, values[joint.get("name")])
            step = step @ turn
        pose = step @ pose
        end = joint.find("parent").get("link")
    return pose[:3, 3], pose[:3, :3]


def _about(axis: Any, angle: float) -> Array:
    """The rotation by way of a unit quaternion, unlike the library's."""
    unit = np.array(axis, float) / np.linalg.norm(axis)
    w, (x, y, z) = np.cos(angle / 2), np.sin(angle / 2) * unit
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _walker(frames: int = 40) -> str:
    """A walker's clip: swinging limbs, every odd way to write channels."""
    blocks = [
        ("ROOT Hips", "0 0 0", "6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"),
        ("JOINT LeftHip", "10 -5 0", "3 Zrotation Yrotation Xrotation"),
        (
            "JOINT LeftKnee",
            "1 -42 0.5",
            "6 Zposition Yposition Xposition Yrotation Xrotation Zrotation",
        ),
        ("JOINT LeftAnkle", "0 -40 0", "3 Xrotation Yrotation Zrotation"),
        ("JOINT RightHip", "-10 -5 0", "3 Xrotation Zrotation Yrotation"),
        ("JOINT RightKnee", "0 -42 0", "1 Xrotation"),
        ("JOINT RightAnkle", "0 -40 0", "3 Yrotation Zrotation Xrotation"),
    ]
    depth = [0, 1, 2, 3, 1, 2, 3]
    sites = {3: "0 0 0", 6: "0 -3 12"}
    lines = ["HIERARCHY"]
    for k, (head, offset, channels) in enumerate(blocks):
        lines += [head, "{", f"OFFSET {offset}", f"CHANNELS {channels}"]
        if k in sites:
            lines += ["End Site", "{", f"OFFSET {sites[k]}", "}"]
        following = depth[k + 1] if k + 1 < len(depth) else 0
        lines += ["}"] * (depth[k] - following + 1)
    lines += ["MOTION", f"Frames: {frames}", "Frame Time: 0.025"]
    for f in range(frames):
        s = np.sin(0.3 * f)
        row = [2 * s, 95 + s, 4.0 * f, 3 * s, 5 * s, -8 * s]
        row += [4 * s, 6 * s, 30 * s]
        row += [0.5, -42, 1, 2 * s, 35 - 30 * s, 3 * s, 10 * s, 4 * s, 2 * s]
        row += [-30 * s, 5 * s, 3 * s, 35 + 30 * s, 3 * s, -10 * s, 2 * s]
        lines.append(" ".join(f"{value:.6f}" for value in row))
    return "\n".join(lines) + "\n"


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    """The walker's clip as a file."""
    path = tmp_path / "walk.bvh"
    path.write_text(_walker(), encoding="utf-8")
    return path


def _bvh_positions(path: Path) -> dict[str, Array]:
    """World positions of every joint of a clip, right-handed, by another reader than limbik's."""
    head, _, motion = path.read_text().partition("MOTION")
    words = iter(head.split()[1:])
    rows = np.array([r.split() for r in motion.splitlines()[3:] if r.strip()], float)
    columns = iter(rows.T)
    places: dict[str, Array] = {}

    def block(name: str, origin: Array, frame: Array) -> None:
        local, turned = np.zeros((len(rows), 3)), frame
        for word in words:
            if word == "OFFSET":
                local = local + [float(next(words)) for _ in range(3)]
            elif word == "CHANNELS":
                for _ in range(int(next(words))):
                    channel, value = next(words), next(columns)
                    axis = "XYZ".index(channel[0])
                    if channel.endswith("position"):
                        local[:, axis] = value
                    else:
                        own = [_about(np.eye(3)[axis], np.radians(v)) for v in value]
                        turned = turned @ np.array(own)
            elif word in ("JOINT", "End"):
                inner = next(words)
                place = origin + np.einsum("mij,mj->mi", frame, local)
                block(f"{name}_end" if word == "End" else inner, place, turned)
            elif word == "}":
                break
        places[name] = origin + np.einsum("mij,mj->mi", frame, local)

    assert next(words) == "ROOT"
    block(next(words), np.zeros((len(rows), 3)), np.repeat(np.eye(3)[None], len(rows), 0))
    return places
