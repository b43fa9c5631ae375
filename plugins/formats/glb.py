"""The output `glb`: an animated, skinned skeleton in one binary glTF 2.0 file.

Each joint is a node and a joint of the skin; each bone is a slim octahedron, so that any viewer
shows the motion. The lengths are written as they are: glTF calls them metres.
"""

import json
import struct
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from limbik import __version__
from limbik.core.chain import SHORTEST
from limbik.core.formats import Bake, BodyBake, Motion, Output
from limbik.core.frames import Y_UP
from limbik.core.hooks import hookimpl
from limbik.core.mirror import side_swapped
from limbik.core.rotation import Array, matrix_to_quaternion
from limbik.plugins.formats.tables import unmirrored
from limbik.plugins.paths.quaternions import continuous

_FLOAT, _BYTE, _SHORT = 5126, 5121, 5123
_TYPES: Final = {(): "SCALAR", (3,): "VEC3", (4,): "VEC4", (4, 4): "MAT4"}
_RIM: Final = 0.1  # where a bone is widest, and how wide, of its length
# The octahedron of a bone: from the joint, over four corners, to the next joint.
_FACES: Final = [
    (0, 2, 1),
    (0, 3, 2),
    (0, 4, 3),
    (0, 1, 4),
    (5, 1, 2),
    (5, 2, 3),
    (5, 3, 4),
    (5, 4, 1),
]


def write(bake: Bake) -> bytes:
    """Write a baked motion as a GLB file."""
    return _content(bake.body.motion(unmirrored(bake), bake.frame_time), bake.mirrored)


def write_body(bake: BodyBake) -> bytes:
    """Write the whole skeleton of a scene with several chains."""
    return _content(bake.motion, bake.mirrored)


def _content(motion: Motion, mirrored: bool) -> bytes:
    if mirrored:  # glTF's axes are a mirror of limbik's X, and two mirrors cancel
        return _File(replace(motion, names=tuple(side_swapped(motion.names)))).content()
    offsets, turns = Y_UP.points(motion.offsets), Y_UP.rotations(motion.turns)
    return _File(replace(motion, offsets=offsets, turns=turns)).content()


class _File:
    """Gathers the JSON part and the buffer of one file, for a motion in glTF's axes."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._buffer = bytearray()
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def content(self) -> bytes:
        """Return the bytes of the file."""
        roots = [k for k, parent in enumerate(self._motion.parents) if parent < 0]
        count = len(self._motion.names)
        document = {
            "asset": {"version": "2.0", "generator": f"limbik {__version__}"},
            "scene": 0,
            "scenes": [{"nodes": [*roots, count]}],
            "nodes": [*self._nodes(), {"name": "skeleton", "mesh": 0, "skin": 0}],
            "meshes": [{"name": "bones", "primitives": [self._primitive()]}],
            "skins": [{"joints": list(range(count)), "inverseBindMatrices": self._binding()}],
            "animations": [self._animation()],
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._buffer)}],
        }
        text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        body = bytes(self._buffer)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(body), 0x004E4942) + body
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _store(self, values: NDArray[Any], kind: int, target: int | None = None) -> int:
        """Put an array into the buffer and return the number of its accessor."""
        code: Any = {_FLOAT: "<f4", _BYTE: "u1", _SHORT: "<u2"}[kind]
        array = np.ascontiguousarray(values, code)
        view = {"buffer": 0, "byteOffset": len(self._buffer), "byteLength": array.nbytes}
        self._views.append(view if target is None else {**view, "target": target})
        accessor = {
            "bufferView": len(self._views) - 1,
            "componentType": kind,
            "count": len(array),
            "type": _TYPES[array.shape[1:]],
        }
        if kind == _FLOAT and array.ndim < 3:
            rows = array.reshape(len(array), -1)
            accessor |= {"min": rows.min(0).tolist(), "max": rows.max(0).tolist()}
        self._accessors.append(accessor)
        self._buffer += array.tobytes()
        self._buffer += bytes(-len(self._buffer) % 4)
        return len(self._accessors) - 1

    def _nodes(self) -> list[dict[str, Any]]:
        """One node a joint, in the pose of the first frame."""
        nodes: list[dict[str, Any]] = []
        quaternions = _quaternions(self._motion.turns[:1])[0]
        for k, name in enumerate(self._motion.names):
            node = {"name": name, "translation": self._motion.offsets[0, k].tolist()}
            node["rotation"] = quaternions[k].tolist()
            children = [c for c, parent in enumerate(self._motion.parents) if parent == k]
            nodes.append({**node, "children": children} if children else node)
        return nodes

    def _binding(self) -> int:
        """Inverse bind matrices: the mesh is made in the joints' own frames, bound where they are.

        Vertices stand in the pose of the first frame, so the inverse of its world matrices.
        """
        positions, rotations = self._first_pose()
        matrices = np.zeros((len(positions), 4, 4))
        inverse = rotations.transpose(0, 2, 1)
        matrices[:, :3, :3] = inverse
        matrices[:, :3, 3] = -(inverse @ positions[..., None])[..., 0]
        matrices[:, 3, 3] = 1.0
        return self._store(matrices.transpose(0, 2, 1), _FLOAT)  # column by column

    def _first_pose(self) -> tuple[Array, Array]:
        positions, rotations = self._motion.first.world()
        return positions[0], rotations[0]

    def _primitive(self) -> dict[str, Any]:
        """The bones' octahedra, flat shaded, each moved by the joint it starts from."""
        positions, rotations = self._first_pose()
        corners, owners = [], []
        for child, parent in enumerate(self._motion.parents):
            bone = self._motion.offsets[0, child]
            if parent >= 0 and np.linalg.norm(bone) > SHORTEST:
                shape = _octahedron(bone)[np.array(_FACES)].reshape(-1, 3)
                corners.append(shape @ rotations[parent].T + positions[parent])
                owners += [parent] * len(shape)
        points = np.concatenate(corners)
        faces = points.reshape(-1, 3, 3)
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        joints = np.zeros((len(points), 4))
        joints[:, 0] = owners
        weights = np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1))
        attributes = {
            "POSITION": self._store(points, _FLOAT, 34962),
            "NORMAL": self._store(np.repeat(normals, 3, axis=0), _FLOAT, 34962),
            "JOINTS_0": self._store(joints, _SHORT, 34962),
            "WEIGHTS_0": self._store(weights, _FLOAT, 34962),
        }
        return {"attributes": attributes}

    def _animation(self) -> dict[str, Any]:
        """Rotations of all joints that turn, positions of those that move."""
        frames = len(self._motion.offsets)
        times = self._store(np.arange(frames) * self._motion.frame_time, _FLOAT)
        quaternions = _quaternions(self._motion.turns)
        samplers: list[dict[str, int]] = []
        channels: list[dict[str, Any]] = []
        for k in range(len(self._motion.names)):
            for path, track in (("rotation", quaternions), ("translation", self._motion.offsets)):
                values = track[:, k]
                if path == "translation" and np.ptp(values, axis=0).max() <= 0.0:
                    continue
                target = {"node": k, "path": path}
                channels.append({"sampler": len(samplers), "target": target})
                samplers.append({"input": times, "output": self._store(values, _FLOAT)})
        return {"name": "bake", "samplers": samplers, "channels": channels}


def _octahedron(bone: Array) -> Array:
    """Corners of a bone that starts in the origin, (6, 3)."""
    length = float(np.linalg.norm(bone))
    along = bone / length
    side = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
    side = side / np.linalg.norm(side)
    other = np.cross(along, side)
    rim = [_RIM * (bone + length * way) for way in (side, other, -side, -other)]
    return np.array([np.zeros(3), *rim, bone])


def _quaternions(turns: Array) -> Array:
    """Unit quaternions x, y, z, w of rotations (m, n, 3, 3), no change of sign on the way."""
    found = matrix_to_quaternion(turns)
    for joint in range(found.shape[1]):
        found[:, joint] = continuous(found[:, joint])
    return found[..., [1, 2, 3, 0]]


@hookimpl
def limbik_outputs() -> Iterable[Output]:
    """Offer `glb`."""
    sentence = "An animated skeleton for viewers (binary glTF)."
    return [Output("glb", (".glb",), write, sentence, write_body)]
