"""The scene input `bvh`: a chain of a motion clip, whose end's path gives the goals.

```yaml
chain: {bvh: walk.bvh, base: LeftUpLeg, end: LeftFoot, scale: 0.01, frames: [1, 600], every: 4}
```

The world of such a scene has the axes of what the base joint hangs from (the pelvis, for a leg)
and its origin in the base joint, in every frame anew. (x, y, z) of the clip is (-x, y, z) here.
Joint Z axes run along the bones, Y axes face ahead in the clip's zero pose, so a bend vector along
Y takes knees and elbows forward.
The file states no unit; `scale` makes its lengths the scene's.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from limbik.core.chain import Chain
from limbik.core.errors import Fault, InputError
from limbik.core.formats import Body, Inspection, Motion
from limbik.core.frames import Y_UP
from limbik.core.rotation import Array, matrix_to_hpb
from limbik.core.settings import Model
from limbik.core.skeleton import way_down
from limbik.core.wording import found_words
from limbik.plugins.formats.bvh import BvhJoint, Clip, read_bvh
from limbik.plugins.formats.bvh_motion import clip_motion, joint_offsets
from limbik.plugins.formats.channels import matrix_to_channels
from limbik.plugins.formats.joining import FIXED, FREE, Joined, ModelJoint, joined

_SLIDES = 1e-4  # a bone may change by this part of the skeleton's size: rounding in the file


def _two(value: Any) -> Any:
    if isinstance(value, list | tuple) and len(value) == 2:
        return tuple(value)
    message = "must be a list of the first and the last frame, not {found}"
    raise PydanticCustomError("type", message, {"found": found_words(value)})


class FramesModel(Model):
    """A motion clip, and which of its frames."""

    bvh: Annotated[str, Field(min_length=1, description="path relative to the scene")]
    scale: Annotated[
        float, Field(gt=0.0, le=1e6, description="scene lengths a length of the clip [-]")
    ] = 1.0
    frames: Annotated[
        tuple[Annotated[int, Field(ge=0)], Annotated[int, Field(ge=0)]] | None,
        BeforeValidator(_two),
        Field(description="first and last frame, counted from 0; absent = all"),
    ] = None
    every: Annotated[int, Field(ge=1, description="take every so manieth frame")] = 1


class BvhModel(FramesModel):
    """A chain of a motion clip."""

    base: Annotated[str, Field(min_length=1, description="joint the chain starts with")]
    end: Annotated[str, Field(min_length=1, description="joint that follows its path in the clip")]


@dataclass(frozen=True, eq=False)
class ClipBody(Body):
    """A chain of a clip, with the clip to put the solved angles into.

    Attributes:
        clip: The clip, only the frames chosen.
        scale: Scene lengths a length of the clip.
        at: Index in the clip of each joint of the chain.
        join: The way back to the clip's rotations.
        turns_end: Whether the end is turned to the goals too, not only carried to them.
    """

    clip: Clip = field(kw_only=True)
    scale: float = field(kw_only=True)
    at: tuple[int, ...] = field(kw_only=True)
    join: Joined = field(kw_only=True)
    turns_end: bool = field(default=False, kw_only=True)

    def turning_end(self) -> Self:
        """Return the body for a solver that turns the end to its goals."""
        return replace(self, turns_end=True)

    def motion(self, angles: Array, frame_time: float) -> Motion:
        """Return the whole skeleton's motion, the chain's turns replaced."""
        return clip_motion(replace(self.baked(angles), frame_time=frame_time), self.scale)

    def baked(self, angles: Array) -> Clip:
        """Return the clip with the chain's angles, HPB (m, n, 3) [rad], in its channels.

        The end joint keeps its channels, unless the solver turns it; so do all other joints.
        """
        frames = self.clip.frames.copy()
        own = Y_UP.rotations(self.join.own_turns(angles))
        for k, index in enumerate(self.at if self.turns_end else self.at[:-1]):
            joint = self.clip.joints[index]
            columns = list(joint.columns[len(joint.moves) :])
            slot = self.join.slots[k]
            if slot == FREE:
                turns = matrix_to_channels(own[:, k], order_of(joint))
                frames[:, columns] = np.degrees(turns)
            elif slot != FIXED:
                value = angles[:, k, slot] + self.join.shifts[k]
                # Right-handed about +axis is limbik's about the mirrored axis: the same number.
                frames[:, columns] = np.degrees(value)[:, None]
        return replace(self.clip, frames=frames)


def order_of(joint: BvhJoint) -> tuple[int, int, int]:
    """Return the axes of a joint's three turns, in order."""
    first, second, third = joint.turns
    return first, second, third


def read_body(model: BvhModel, folder: Path) -> ClipBody:
    """Make a chain and goals of a clip.

    Raises:
        InputError: The file is at fault, or there is no such chain in it.
    """
    clip = read_bvh(folder / model.bvh)
    parents = [joint.parent for joint in clip.joints]
    at = way_down(clip.names, parents, model.base, model.end, "clip")
    clip, numbers = chosen(clip, model)
    refuse(clip, at)
    offsets = [lasting_offset(clip, index) * model.scale for index in at]
    offsets[0] = np.zeros(3)
    models = [
        model_joint(clip.joints[index], offset) for index, offset in zip(at, offsets, strict=True)
    ]
    join = joined(models)
    goals, turns = _path(clip, at, model.scale)
    return ClipBody(
        Chain(join.joints),
        (),
        goals,
        tuple(map(str, numbers)),
        clip.frame_time,
        matrix_to_hpb(turns @ join.frames[-1]),
        clip=clip,
        scale=model.scale,
        at=tuple(at),
        join=join,
    )


def chosen(clip: Clip, model: FramesModel) -> tuple[Clip, range]:
    """Take the frames a scene asks for, with their numbers."""
    count = len(clip.frames)
    first, last = model.frames or (0, count - 1)
    if not first <= last < count:
        message = f"frames {first} to {last}: the clip has 0 to {count - 1}"
        message = message if count else "the clip has no frames"
        raise InputError(Fault("range", message, "frames" if model.frames else "bvh"))
    numbers = range(first, last + 1, model.every)
    taken = replace(
        clip, frames=clip.frames[list(numbers)], frame_time=clip.frame_time * model.every
    )
    return taken, numbers


def refuse(clip: Clip, way: Sequence[int]) -> None:
    """Refuse joints from one down to another that limbik cannot make a chain of.

    Raises:
        InputError: A bone changes its length, or a joint turns about two axes.
    """
    faults = [fault for index in way[1:] for fault in _slides(clip, index)]
    faults += [fault for index in way[:-1] for fault in _refusals(clip, index)]
    if faults:
        raise InputError(faults)


def _slides(clip: Clip, index: int) -> list[Fault]:
    """Refuse a joint whose position channels change the bone before it."""
    joint = clip.joints[index]
    if not joint.moves:
        return []
    offsets = joint_offsets(clip, joint)
    change = float(np.ptp(offsets, axis=0).max())
    size = max(float(np.abs([other.offset for other in clip.joints]).max()), 1e-9)
    if change <= _SLIDES * size:
        return []
    message = f"joint '{joint.name}' slides by up to {change:.4g}; limbik's bones keep their length"
    return [Fault("slides", message, "", clip.file, joint.line, hint="choose a base below it")]


def _refusals(clip: Clip, index: int) -> list[Fault]:
    """Say why a joint cannot be in a chain, if so."""
    joint = clip.joints[index]
    if len(joint.turns) != 2:
        return []
    message = f"joint '{joint.name}' has two rotation channels; limbik takes none, one or three"
    return [Fault("channel", message, "", clip.file, joint.line)]


def lasting_offset(clip: Clip, index: int) -> Array:
    """A joint's lasting offset, in limbik's axes."""
    return Y_UP.points(joint_offsets(clip, clip.joints[index]).mean(axis=0))


def model_joint(joint: BvhJoint, offset: Array) -> ModelJoint:
    """Make a joint of a chain, in limbik's axes."""
    still = np.eye(3)
    if len(joint.turns) == 1:
        axis = Y_UP.points(np.eye(3)[joint.turns[0]])
        return ModelJoint(joint.name, offset, still, "hinge", axis)
    return ModelJoint(joint.name, offset, still, "free" if len(joint.turns) == 3 else "fixed")


def _path(clip: Clip, at: list[int], scale: float) -> tuple[Array, Array]:
    """Where the end is, seen from what the base hangs from, (m, 3), and its turn, (m, 3, 3)."""
    motion = clip_motion(clip, scale)
    place = np.zeros((len(clip.frames), 3))
    turn = motion.turns[:, at[-1]]
    for index in reversed(at[1:]):
        parent = motion.turns[:, clip.joints[index].parent]
        place = (parent @ (motion.offsets[:, index] + place)[..., None])[..., 0]
        turn = parent @ turn
    return place, turn


def inspect(path: Path) -> Inspection:
    """Say what a clip holds.

    Raises:
        InputError: The file is at fault.
    """
    clip = read_bvh(path)
    seconds = len(clip.frames) * clip.frame_time
    title = f"motion clip: {len(clip.joints)} joints, {len(clip.frames)} frames, {seconds:.4g} s"
    rows = []
    for joint in clip.joints:
        parent = clip.joints[joint.parent].name if joint.parent >= 0 else ""
        offset = " ".join(f"{value:.4g}" for value in joint.offset)
        rows.append((joint.name, parent, offset, " ".join(joint.channels)))
    return Inspection(
        title,
        ("joint", "parent", "offset", "channels"),
        tuple(rows),
        tuple(_candidates(clip)),
        ("a clip states no unit: choose `scale` so that lengths become yours",),
    )


def _candidates(clip: Clip) -> Iterable[tuple[str, str, str]]:
    """Chains from where branches part to their tips or the next parting, two bones or more."""
    parents = [joint.parent for joint in clip.joints]
    for tip, joint in enumerate(clip.joints):
        if parents.count(tip) == 1:
            continue
        way = [tip]
        while (parent := clip.joints[way[-1]].parent) >= 0:
            if parents.count(parent) > 1 and len(way) > 2:
                break
            way.append(parent)
        names = [clip.joints[index].name for index in reversed(way)]
        if len(names) > 2:
            yield names[0], joint.name, f"{len(names)} joints: {', '.join(names)}"
