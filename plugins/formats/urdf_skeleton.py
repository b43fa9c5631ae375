"""A whole robot as the skeleton of a scene with several chains.

```yaml
skeleton: {urdf: robot.urdf, rest: {left_elbow: -40}}
chains:
  - {name: left arm, base: chest, end: left_hand, goals: [{position: [0.3, 0.4, 0.2]}]}
```

The joints of the skeleton are the robot's links, each turned by the joint that carries it; links
that slide or copy another joint keep their zero. The root link's frame is limbik's world.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import ClassVar

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.formats import Motion
from limbik.core.frames import Z_UP, turn_about
from limbik.core.rotation import Array
from limbik.core.settings import Model
from limbik.core.skeleton import STILL, Skeleton
from limbik.plugins.formats.limbs import ModelLimb, model_limb
from limbik.plugins.formats.urdf import Robot, UrdfJoint, read_urdf
from limbik.plugins.formats.urdf_chain import (
    RestValues,
    RobotFile,
    Scale,
    hinge_models,
    origin,
    refusals,
    rest_faults,
    rest_value,
)


class UrdfSkeletonModel(Model):
    """A whole robot."""

    urdf: RobotFile
    scale: Scale = 1.0
    rest: RestValues


@dataclass(frozen=True, eq=False)
class UrdfSkeleton(Skeleton):
    """A robot's links.

    Attributes:
        carriers: The joint that carries each link, None for a root.
        scale: Scene lengths a metre of the robot.
        rest: Initial values of hinges [deg].
    """

    carriers: tuple[UrdfJoint | None, ...] = field(kw_only=True)
    scale: float = field(kw_only=True)
    rest: dict[str, float] = field(kw_only=True)
    whole: ClassVar[str] = "robot"
    part: ClassVar[str] = "link"

    def limb(self, base: str, end: str) -> ModelLimb:
        """Cut out a chain of hinges; fixed joints are merged into the next one."""
        way = self.way(base, end)[1:]
        carriers = [joint for link in way if (joint := self.carriers[link]) is not None]
        faults = [fault for joint in carriers for fault in refusals(joint)]
        if not faults and not any(joint.is_hinge for joint in carriers):
            message = f"there is no hinge between '{base}' and '{end}'"
            faults = [Fault("chain", message, "end")]
        if faults:
            raise InputError(faults)
        at = [link for link, joint in zip(way, carriers, strict=True) if joint.is_hinge]
        models, notes = hinge_models(carriers, end, self.scale, self.rest)
        # The base of a limb stands in its first hinge.
        models[0] = replace(models[0], offset=np.zeros(3), turn=self.motion.zero[at[0]])
        return model_limb(self, models, [*at, way[-1]], tuple(notes), "rad")


def read_skeleton(model: UrdfSkeletonModel, folder: Path) -> UrdfSkeleton:
    """Make a skeleton of a robot.

    Raises:
        InputError: The file is at fault, or has no such hinge.
    """
    robot = read_urdf(folder / model.urdf)
    hinges = [joint.name for joint in robot.joints.values() if joint.is_hinge]
    faults = rest_faults(model.rest, hinges, "the robot has no hinge {}")
    if faults:
        raise InputError(faults)
    return _skeleton(robot, model)


def _skeleton(robot: Robot, model: UrdfSkeletonModel) -> UrdfSkeleton:
    links = sorted(robot.links, key=lambda link: len(robot.up_from(link)))
    carriers = [robot.joints.get(link) for link in links]
    offsets, zero, turns = [], [], []
    for joint in carriers:
        if joint is None:
            offsets.append(np.zeros(3))
            zero.append(np.eye(3))
            turns.append(np.eye(3))
            continue
        place, turn = origin(joint, model.scale)
        offsets.append(place)
        zero.append(turn)
        turns.append(zero[-1] @ _own(joint, model))
    parents = tuple(-1 if joint is None else links.index(joint.parent) for joint in carriers)
    motion = Motion(
        tuple(links), parents, np.array([offsets]), np.array([turns]), np.array(zero), STILL
    )
    return UrdfSkeleton(
        motion, robot.notes, carriers=tuple(carriers), scale=model.scale, rest=model.rest
    )


def _own(joint: UrdfJoint, model: UrdfSkeletonModel) -> Array:
    """A joint's own rotation in the rest pose."""
    if not joint.is_hinge or joint.mimics:
        return np.eye(3)
    value, _ = rest_value(joint, model.rest)
    return Z_UP.rotations(turn_about(joint.axis, value))
