"""A whole clip as the skeleton of a scene with several chains.

```yaml
skeleton: {bvh: walk.bvh, scale: 0.01, frames: [1, 600]}
chains:
  - {name: left leg, base: LeftUpLeg, end: LeftFoot}      # without goals: its path in the clip
```

The world is the clip's, (x, y, z) of the clip being (-x, y, z) here, and every frame is solved in
the pose the clip has then: joints of no chain move as they do in the clip.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

from limbik.core.formats import Motion
from limbik.core.frames import Y_UP
from limbik.core.rotation import Array, matrix_to_hpb
from limbik.core.skeleton import Limb, Skeleton
from limbik.plugins.formats.bvh import BvhJoint, Clip, read_bvh
from limbik.plugins.formats.bvh_chain import (
    FramesModel,
    chosen,
    lasting_offset,
    model_joint,
    order_of,
    refuse,
)
from limbik.plugins.formats.bvh_motion import clip_motion
from limbik.plugins.formats.channels import matrix_to_channels
from limbik.plugins.formats.joining import ModelJoint
from limbik.plugins.formats.limbs import ModelLimb, model_limb


@dataclass(frozen=True, eq=False)
class ClipSkeleton(Skeleton):
    """A clip's joints and end sites.

    Attributes:
        clip: The clip, only the frames chosen.
        scale: Scene lengths a length of the clip.
        frames: The numbers of the frames in the file, as text.
        places: World positions of all joints in the clip's own motion, (m, n, 3) [length].
        axes: Their world rotations, (m, n, 3, 3).
    """

    whole: ClassVar[str] = "clip"
    clip: Clip = field(kw_only=True)
    scale: float = field(kw_only=True)
    frames: tuple[str, ...] = field(kw_only=True)
    places: Array = field(kw_only=True)
    axes: Array = field(kw_only=True)

    def limb(self, base: str, end: str) -> ModelLimb:
        """Cut out a chain; its goals are the end's path in the clip."""
        way = self.way(base, end)
        joints = self.clip.joints
        refuse(self.clip, [index for index in way if index < len(joints)])
        models = []
        for index in way:
            offset = np.zeros(3) if index == way[0] else self._offset(index)
            if index < len(joints):
                models.append(model_joint(joints[index], offset))
            else:
                models.append(ModelJoint(self.names[index], offset, np.eye(3), "fixed"))
        limb = model_limb(self, models, way)
        return replace(
            limb,
            goals=self.places[:, way[-1]],
            goal_names=self.frames,
            frame_time=self.clip.frame_time,
            goal_turns=matrix_to_hpb(self.axes[:, way[-1]] @ limb.join.frames[-1]),
        )

    def _offset(self, index: int) -> Array:
        if index < len(self.clip.joints):
            return lasting_offset(self.clip, index) * self.scale
        return np.asarray(self.motion.offsets[0, index])

    def baked(self, motion: Motion, limbs: Sequence[Limb]) -> Clip:
        """Return the clip with the turns of limbs' joints in its channels, all others as they are.

        Args:
            motion: The solved motion of this skeleton.
            limbs: What was solved; an end keeps its channels.
        """
        frames = np.resize(self.clip.frames, (len(motion.turns), self.clip.frames.shape[1]))
        for index in sorted({index for limb in limbs for index in limb.turned}):
            joint = self.clip.joints[index]
            if joint.turns:
                columns = list(joint.columns[len(joint.moves) :])
                frames[:, columns] = _channels(joint, Y_UP.rotations(motion.turns[:, index]))
        return replace(self.clip, frames=frames, frame_time=motion.frame_time)


def _channels(joint: BvhJoint, turns: Array) -> Array:
    """Rotation channels [deg] of a joint, (m, 1) or (m, 3)."""
    if len(joint.turns) == 3:
        return np.degrees(matrix_to_channels(turns, order_of(joint)))
    first, second = (joint.turns[0] + 1) % 3, (joint.turns[0] + 2) % 3
    angle = np.arctan2(turns[:, second, first], turns[:, first, first])
    return np.degrees(np.unwrap(angle))[:, None]


def read_skeleton(model: FramesModel, folder: Path) -> ClipSkeleton:
    """Make a skeleton of a clip.

    Raises:
        InputError: The file is at fault, or has no such frames.
    """
    clip, numbers = chosen(read_bvh(folder / model.bvh), model)
    motion = clip_motion(clip, model.scale)
    places, axes = motion.world()
    return ClipSkeleton(
        motion,
        clip=clip,
        scale=model.scale,
        frames=tuple(map(str, numbers)),
        places=places,
        axes=axes,
    )
