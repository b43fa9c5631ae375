"""A catalogue of malformed files a scene may name: each gives exactly its message and status 2."""

import io
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml

MESSAGES: dict[str, str] = yaml.safe_load(
    (Path(__file__).parents[1] / "bad_files.yaml").read_text(encoding="utf-8")
)
Run = Callable[..., tuple[int, str, str]]
Content = str | bytes | None | Callable[[], bytes]

JOINTS = "chain: {joints: [{name: a}, {name: b, offset: [0, 0, 9]}]}\n"
CSV = f"limbik: 1\n{JOINTS}goals: {{csv: g.csv}}\n"
NPZ = f"limbik: 1\n{JOINTS}goals: {{npz: g.npz}}\n"
ARRAY = f"limbik: 1\n{JOINTS}goals: {{npz: g.npz, array: way}}\n"
GOALS = "goals: [{position: [0, 0, 1]}]\n"
URDF = f"limbik: 1\nchain: {{urdf: r.urdf, base: a, end: c}}\n{GOALS}"
BVH = "limbik: 1\nchain: {bvh: c.bvh, base: hip, end: foot}\n"
BODY = "limbik: 1\nskeleton: {bvh: c.bvh}\nchains:\n- {name: leg, base: hip, end: foot}\n"
ROBOT = """\
<robot name="r">
  <link name="a"/> <link name="b"/> <link name="c"/>
  <joint name="j" type="revolute">
    <parent link="a"/> <child link="b"/> <axis xyz="0 0 1"/> <limit lower="-1" upper="1"/>
  </joint>
  <joint name="k" type="revolute">
    <parent link="b"/> <child link="c"/> <origin xyz="1 0 0"/> <limit lower="-1" upper="1"/>
  </joint>
</robot>
"""
CLIP = """\
HIERARCHY
ROOT hip
{
  OFFSET 0 9 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT knee
  {
    OFFSET 0 -4 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    JOINT foot
    {
      OFFSET 0 -4 0
      CHANNELS 3 Zrotation Xrotation Yrotation
      End Site
      {
        OFFSET 0 0 1
      }
    }
  }
}
MOTION
Frames: 1
Frame Time: 0.1
0 9 0 1 2 3 4 5 6 7 8 9
"""


def robot(old: str, new: str) -> str:
    assert ROBOT.count(old) == 1, old
    return ROBOT.replace(old, new)


def clip(old: str, new: str) -> str:
    assert CLIP.count(old) == 1, old
    return CLIP.replace(old, new)


def packed(**arrays: object) -> Callable[[], bytes]:
    """An NPZ file."""

    def content() -> bytes:
        file = io.BytesIO()
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
        return file.getvalue()

    return content


def bomb() -> bytes:
    """Zeros that take a gigabyte, packed into a megabyte."""
    file = io.BytesIO()
    with (
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive,
        archive.open("goals.npy", "w", force_zip64=True) as member,
    ):
        for _ in range(1000):
            member.write(bytes(1_000_000))
    return file.getvalue()


def pickled() -> bytes:
    """An array of Python objects, which unpacking would run."""
    file = io.BytesIO()
    np.savez(file, goals=np.array([{}], object))
    return file.getvalue()


CASES: dict[str, tuple[str, str, Content]] = {
    "csv: not there": (CSV, "g.csv", None),
    "csv: a folder": (CSV, "g.csv/", None),
    "csv: empty": (CSV, "g.csv", ""),
    "csv: a column missing": (CSV, "g.csv", "name,x,y\na,1,2\n"),
    "csv: no goals": (CSV, "g.csv", "name,x,y,z\n"),
    "csv: text for a number": (CSV, "g.csv", "name,x,y,z\na,1,two,3\n"),
    "csv: NaN": (CSV, "g.csv", "name,x,y,z\na,1,.nan,3\n"),
    "csv: plain nan": (CSV, "g.csv", "name,x,y,z\na,1,nan,3\n"),
    "csv: an empty cell": (CSV, "g.csv", "name,x,y,z\na,1,,3\n"),
    "csv: metres for millimetres": (CSV, "g.csv", "name,x,y,z\na,1,2e7,3\n"),
    "csv: a short line": (CSV, "g.csv", "name,x,y,z\na,1,2\n"),
    "csv: semicolons": (CSV, "g.csv", "name;x;y;z\na;1;2;3\n"),
    "csv: a name twice": (CSV, "g.csv", "name,x,y,z\na,1,2,3\na,1,2,3\n"),
    "csv: no name": (CSV, "g.csv", "name,x,y,z\n,1,2,3\n"),
    "csv: latin-1": (CSV, "g.csv", "name,x,y,z\nm\xfcnd,1,2,3\n".encode("latin-1")),
    "csv: an open quote": (CSV, "g.csv", 'name,x,y,z\n"a,1,2,3\n'),
    "csv: half an orientation in the header": (CSV, "g.csv", "name,x,y,z,heading\na,1,2,3,0\n"),
    "csv: two orientations": (
        CSV,
        "g.csv",
        "x,y,z,heading,pitch,bank,qw,qx,qy,qz\n1,2,3,0,0,0,1,0,0,0\n",
    ),
    "csv: half an orientation": (CSV, "g.csv", "x,y,z,heading,pitch,bank\n1,2,3,4,5,\n"),
    "csv: text for an angle": (CSV, "g.csv", "x,y,z,heading,pitch,bank\n1,2,3,4,up,5\n"),
    "csv: ticks for degrees": (CSV, "g.csv", "x,y,z,heading,pitch,bank\n1,2,3,4,2048,5\n"),
    "csv: a quaternion of length 2": (CSV, "g.csv", "x,y,z,qw,qx,qy,qz\n1,2,3,1,1,1,1\n"),
    "npz: not there": (NPZ, "g.npz", None),
    "npz: text": (NPZ, "g.npz", "goals"),
    "npz: cut": (NPZ, "g.npz", lambda: packed(goals=np.zeros((9, 3)))()[:60]),
    "npz: objects": (NPZ, "g.npz", pickled),
    "npz: a bomb": (NPZ, "g.npz", bomb),
    "npz: no such array": (NPZ, "g.npz", packed(points=np.zeros((2, 3)))),
    "npz: no array of that name": (ARRAY, "g.npz", packed(goals=np.zeros((2, 3)))),
    "npz: two columns": (NPZ, "g.npz", packed(goals=np.zeros((2, 2)))),
    "npz: text inside": (NPZ, "g.npz", packed(goals=np.full((2, 3), "a"))),
    "npz: no rows": (NPZ, "g.npz", packed(goals=np.zeros((0, 3)))),
    "npz: NaN": (NPZ, "g.npz", packed(goals=np.array([[0, 0, 1], [0, np.nan, 1]]))),
    "npz: beyond a million": (NPZ, "g.npz", packed(goals=np.full((1, 3), 1e7))),
    "npz: orientations of two columns": (
        NPZ,
        "g.npz",
        packed(goals=np.ones((2, 3)), hpb=np.zeros((2, 2))),
    ),
    "npz: one orientation for two goals": (
        NPZ,
        "g.npz",
        packed(goals=np.ones((2, 3)), hpb=np.zeros((1, 3))),
    ),
    "npz: half an orientation": (
        NPZ,
        "g.npz",
        packed(goals=np.ones((1, 3)), hpb=np.array([[0.0, np.nan, 0.0]])),
    ),
    "npz: a quaternion of length 0": (
        NPZ,
        "g.npz",
        packed(goals=np.ones((1, 3)), quaternions=np.zeros((1, 4))),
    ),
    "npz: two orientations": (
        NPZ,
        "g.npz",
        packed(goals=np.ones((1, 3)), hpb=np.zeros((1, 3)), quaternions=np.eye(4)[:1]),
    ),
    "urdf: not there": (URDF, "r.urdf", None),
    "urdf: empty": (URDF, "r.urdf", ""),
    "urdf: a picture": (URDF, "r.urdf", b"\x89PNG\r\n\x1a\n\0\0"),
    "urdf: an entity bomb": (
        URDF,
        "r.urdf",
        '<!DOCTYPE r [<!ENTITY a "aa"><!ENTITY b "&a;&a;">]><robot name="&b;"/>',
    ),
    "urdf: 11 MB": (URDF, "r.urdf", lambda: b"<robot>" + b" " * 11_000_000),
    "urdf: xacro": (URDF, "r.urdf", robot('xyz="1 0 0"', 'xyz="${arm} 0 0"')),
    "urdf: another root": (URDF, "r.urdf", "<sdf/>"),
    "urdf: a tag left open": (URDF, "r.urdf", robot("</robot>", "")),
    "urdf: a link twice": (URDF, "r.urdf", robot('<link name="c"/>', '<link name="a"/>')),
    "urdf: an unknown link": (URDF, "r.urdf", robot('<child link="c"/>', '<child link="d"/>')),
    "urdf: a circle": (URDF, "r.urdf", robot('<child link="c"/>', '<child link="a"/>')),
    "urdf: NaN": (URDF, "r.urdf", robot('xyz="1 0 0"', 'xyz="nan 0 0"')),
    "urdf: a comma": (URDF, "r.urdf", robot('xyz="1 0 0"', 'xyz="1, 0 0"')),
    "urdf: kilometres": (URDF, "r.urdf", robot('xyz="1 0 0"', 'xyz="1e9 0 0"')),
    "urdf: an axis of zero": (URDF, "r.urdf", robot('xyz="0 0 1"', 'xyz="0 0 0"')),
    "urdf: limits upside down": (
        URDF,
        "r.urdf",
        robot('<axis xyz="0 0 1"/> <limit lower="-1"', '<axis xyz="0 0 1"/> <limit lower="2"'),
    ),
    "urdf: a sliding joint": (
        URDF,
        "r.urdf",
        robot('name="k" type="revolute"', 'name="k" type="prismatic"'),
    ),
    "bvh: not there": (BVH, "c.bvh", None),
    "bvh: empty": (BVH, "c.bvh", ""),
    "bvh: cut": (BVH, "c.bvh", CLIP[:200]),
    "bvh: text for a number": (BVH, "c.bvh", clip("0 9 0 1", "0 nine 0 1")),
    "bvh: NaN": (BVH, "c.bvh", clip("0 9 0 1", "0 nan 0 1")),
    "bvh: a short frame": (BVH, "c.bvh", clip("7 8 9", "7 8")),
    "bvh: fewer frames": (BVH, "c.bvh", clip("Frames: 1", "Frames: 2")),
    "bvh: no frames": (BVH, "c.bvh", CLIP.replace("Frames: 1", "Frames: 0")[:-24]),
    "bvh: a joint twice": (BVH, "c.bvh", clip("JOINT knee", "JOINT hip")),
    "bvh: an unknown joint": (BVH, "c.bvh", clip("JOINT foot", "JOINT paw")),
    "bvh: nested 300 deep": (
        BVH,
        "c.bvh",
        "HIERARCHY\nROOT r\n{\n" + "".join(f"OFFSET 0 0 0\nJOINT j{k}\n{{\n" for k in range(300)),
    ),
    "bvh: frames there are not": (
        BVH.replace("end: foot", "end: foot, frames: [0, 9]"),
        "c.bvh",
        CLIP,
    ),
    "body: not there": (BODY, "c.bvh", None),
    "body: cut": (BODY, "c.bvh", CLIP[:200]),
    "body: an unknown joint": (BODY, "c.bvh", clip("JOINT foot", "JOINT paw")),
    "body: frames there are not": (BODY.replace("c.bvh}", "c.bvh, frames: [0, 9]}"), "c.bvh", CLIP),
}


def write(folder: Path, scene: str, file: str, content: Content) -> None:
    """Write the scene and the file it names; a name that ends in / is a folder."""
    (folder / "scene.yaml").write_text(scene, encoding="utf-8")
    if file.endswith("/"):
        (folder / file).mkdir()
    elif content is not None:
        data = content() if callable(content) else content
        (folder / file).write_bytes(data.encode() if isinstance(data, str) else data)


@pytest.mark.parametrize("case", CASES)
def test_a_malformed_file_ends_with_2_and_its_message(run: Run, tmp_path: Path, case: str) -> None:
    scene, file, content = CASES[case]
    write(tmp_path, scene, file, content)
    status, out, err = run("check", "scene.yaml")
    assert (status, out) == (2, "")
    assert err.splitlines()[0] == MESSAGES[case]
    assert "Traceback" not in err
