"""The output `bvh`: a motion clip that animation programs import.

A chain that came from a clip goes back into it: the whole skeleton, all other channels as they
were. Any other chain becomes a skeleton of its own, whose zero pose is limbik's.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from limbik.core.formats import Bake, BodyBake, Motion, Output
from limbik.core.frames import Y_UP
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array
from limbik.plugins.formats.bvh import BvhJoint, Clip
from limbik.plugins.formats.bvh_chain import ClipBody
from limbik.plugins.formats.bvh_motion import mirrored_clip
from limbik.plugins.formats.bvh_skeleton import ClipSkeleton
from limbik.plugins.formats.channels import matrix_to_channels
from limbik.plugins.formats.tables import unmirrored

_ORDER = (2, 0, 1)
_ROTATIONS = ("Zrotation", "Xrotation", "Yrotation")
_POSITIONS = ("Xposition", "Yposition", "Zposition")


def write(bake: Bake) -> str:
    """Write a baked motion as BVH text."""
    body = bake.body
    angles = unmirrored(bake)
    if isinstance(body, ClipBody):
        clip = replace(body.baked(angles), frame_time=bake.frame_time)
    else:
        clip = clip_of(body.motion(angles, bake.frame_time))
    return clip_text(mirrored_clip(clip) if bake.mirrored else clip)


def write_body(bake: BodyBake) -> str:
    """Write the whole skeleton of a scene with several chains."""
    skeleton = bake.scene.skeleton
    if isinstance(skeleton, ClipSkeleton):
        clip = skeleton.baked(bake.motion, [part.limb for part in bake.scene.parts])
    else:
        clip = clip_of(bake.motion)
    return clip_text(mirrored_clip(clip) if bake.mirrored else clip)


def clip_of(motion: Motion) -> Clip:
    """Make a clip of a motion; zero rotations become the axes of the world, as BVH needs it.

    The roots get position channels, the other joints their lasting offsets.
    """
    motion = _depth_first(motion)
    zero = _world_zero(motion)
    turned = motion.turns @ zero.transpose(0, 2, 1)
    joints: list[BvhJoint] = []
    columns: list[Array] = []
    width = 0
    for index, parent in enumerate(motion.parents):
        own = turned[:, index] if parent < 0 else zero[parent] @ turned[:, index]
        angles = matrix_to_channels(Y_UP.rotations(own), _ORDER)
        offset = motion.offsets[:, index]
        offset = Y_UP.points(offset if parent < 0 else offset @ zero[parent].T)
        moves = (0, 1, 2) if parent < 0 else ()
        if moves:
            columns.append(offset)
        columns.append(np.degrees(angles))
        count = len(moves) + 3
        x, y, z = (float(value) for value in offset[0])
        channels = (*(_POSITIONS if moves else ()), *_ROTATIONS)
        site = None if index in motion.parents else (0.0, 0.0, 0.0)
        at = tuple(range(width, width + count))
        name = motion.names[index]
        joints.append(BvhJoint(name, parent, (x, y, z), moves, _ORDER, at, channels, site, 0))
        width += count
    return Clip("", tuple(joints), np.concatenate(columns, axis=1), motion.frame_time)


def _depth_first(motion: Motion) -> Motion:
    """Return a motion with its joints in the order a clip lists them and their channels."""
    children: dict[int, list[int]] = {}
    for index, parent in enumerate(motion.parents):
        children.setdefault(parent, []).append(index)
    order: list[int] = []
    waiting = children[-1][::-1]
    while waiting:
        order.append(waiting.pop())
        waiting += children.get(order[-1], [])[::-1]
    place = {index: k for k, index in enumerate(order)} | {-1: -1}
    return Motion(
        tuple(motion.names[index] for index in order),
        tuple(place[motion.parents[index]] for index in order),
        motion.offsets[:, order],
        motion.turns[:, order],
        motion.zero[order],
        motion.frame_time,
    )


def _world_zero(motion: Motion) -> Array:
    """World rotations of the zero pose, (n, 3, 3)."""
    zero = motion.zero.copy()
    for index, parent in enumerate(motion.parents):
        if parent >= 0:
            zero[index] = zero[parent] @ motion.zero[index]
    return zero


def clip_text(clip: Clip) -> str:
    """Write a clip; numbers keep ten decimals."""
    lines = ["HIERARCHY"]
    children: dict[int, list[int]] = {}
    for index, joint in enumerate(clip.joints):
        children.setdefault(joint.parent, []).append(index)
    for root in children.get(-1, []):
        lines += _block(clip, root, children, 0)
    lines += ["MOTION", f"Frames: {len(clip.frames)}", f"Frame Time: {_plain(clip.frame_time)}"]
    lines += [" ".join(map(_plain, row)) for row in clip.frames.tolist()]
    return "\n".join(lines) + "\n"


def _block(clip: Clip, index: int, children: dict[int, list[int]], depth: int) -> Iterator[str]:
    joint = clip.joints[index]
    tab = "\t" * depth
    yield f"{tab}{'JOINT' if depth else 'ROOT'} {joint.name}"
    yield f"{tab}{{"
    yield f"{tab}\tOFFSET {' '.join(map(_plain, joint.offset))}"
    yield " ".join([f"{tab}\tCHANNELS {len(joint.channels)}", *joint.channels])
    for child in children.get(index, []):
        yield from _block(clip, child, children, depth + 1)
    if joint.site is not None:
        yield f"{tab}\tEnd Site"
        yield f"{tab}\t{{"
        yield f"{tab}\t\tOFFSET {' '.join(map(_plain, joint.site))}"
        yield f"{tab}\t}}"
    yield f"{tab}}}"


def _plain(value: float) -> str:
    """Write a number without an exponent and without needless zeros."""
    text = f"{value:.10f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


@hookimpl
def limbik_outputs() -> Iterable[Output]:
    """Offer `bvh`."""
    sentence = "A motion clip; a scene's own clip is kept whole."
    return [Output("bvh", (".bvh",), write, sentence, write_body)]
