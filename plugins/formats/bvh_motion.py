"""What a clip's channels mean: offsets and turns of every joint in every frame, and the mirror."""

from dataclasses import replace

import numpy as np

from limbik.core.formats import Motion
from limbik.core.frames import Y_UP
from limbik.core.mirror import side_swapped
from limbik.core.rotation import Array
from limbik.plugins.formats.bvh import BvhJoint, Clip
from limbik.plugins.formats.channels import channels_to_matrix


def joint_turns(clip: Clip, joint: BvhJoint) -> Array:
    """Return a joint's rotations as the clip has them, right-handed, (m, 3, 3)."""
    columns = list(joint.columns[len(joint.moves) :])
    return channels_to_matrix(np.radians(clip.frames[:, columns]), joint.turns)


def joint_offsets(clip: Clip, joint: BvhJoint) -> Array:
    """Return a joint's positions in its parent's frame, right-handed, (m, 3) [length].

    Position channels stand for the offset, axis by axis, as animation programs have it.
    """
    offsets = np.repeat(np.array([joint.offset]), len(clip.frames), axis=0)
    for axis, column in zip(joint.moves, joint.columns, strict=False):
        offsets[:, axis] = clip.frames[:, column]
    return offsets


def clip_motion(clip: Clip, scale: float = 1.0) -> Motion:
    """Return the motion of all joints and end sites, in limbik's axes.

    Args:
        clip: The clip.
        scale: What its lengths are multiplied by.
    """
    m = len(clip.frames)
    still = np.broadcast_to(np.eye(3), (m, 3, 3))
    names, parents = clip.names, [joint.parent for joint in clip.joints]
    offsets = [joint_offsets(clip, joint) for joint in clip.joints]
    turns = [joint_turns(clip, joint) for joint in clip.joints]
    for index, joint in enumerate(clip.joints):
        if joint.site is not None:
            name = f"{joint.name}_end"
            names.append(name if name not in names else f"{name}_site")
            parents.append(index)
            offsets.append(np.repeat(np.array([joint.site]), m, axis=0))
            turns.append(still)
    return Motion(
        tuple(names),
        tuple(parents),
        Y_UP.points(np.stack(offsets, axis=1)) * scale,
        Y_UP.rotations(np.stack(turns, axis=1)),
        np.repeat(np.eye(3)[None], len(names), axis=0),
        clip.frame_time,
    )


def mirrored_clip(clip: Clip) -> Clip:
    """Return the clip mirrored left to right, each joint named for the side it is on then."""
    frames = clip.frames.copy()
    joints = []
    names = side_swapped(clip.names)
    for joint, name in zip(clip.joints, names, strict=True):
        for axis, column in zip(joint.moves, joint.columns, strict=False):
            frames[:, column] *= -1.0 if axis == 0 else 1.0
        for axis, column in zip(joint.turns, joint.columns[len(joint.moves) :], strict=True):
            frames[:, column] *= 1.0 if axis == 0 else -1.0
        x, y, z = joint.offset
        site = None if joint.site is None else (-joint.site[0], joint.site[1], joint.site[2])
        joints.append(replace(joint, name=name, offset=(-x, y, z), site=site))
    return replace(clip, joints=tuple(joints), frames=frames + 0.0)
