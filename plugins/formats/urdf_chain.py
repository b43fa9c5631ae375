"""The scene input `urdf`: a chain between two links of a robot.

```yaml
chain: {urdf: robot.urdf, base: torso, end: hand, rest: {elbow: 90}}
```

The base link's frame is limbik's world, (x, y, z) of the robot being (x, z, y) here. Hinges keep
their names, angles and limits; fixed joints are merged into the next one. A range that crosses
±180° is counted from its middle inside limbik and from the robot's own zero in what is written as
the robot's values; one of a whole turn or more does not limit.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import degrees, radians
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from limbik.core.chain import SHORTEST, Chain
from limbik.core.errors import Fault, InputError
from limbik.core.formats import Body, Inspection, Values
from limbik.core.frames import Z_UP, rpy_to_matrix
from limbik.core.rotation import Array
from limbik.core.scenemodel import Angle
from limbik.core.settings import Model
from limbik.core.wording import near_match
from limbik.plugins.formats.joining import Joined, ModelJoint, joined
from limbik.plugins.formats.urdf import Robot, UrdfJoint, read_urdf

_WHY_NOT = {
    "prismatic": "slides; limbik's joints only turn",
    "floating": "floats freely; limbik's joints turn about an axis",
    "planar": "slides in a plane; limbik's joints only turn",
    "spherical": "is no joint type of URDF",
}


RobotFile = Annotated[str, Field(min_length=1, description="path relative to the scene")]
Scale = Annotated[
    float, Field(gt=0.0, le=1e6, description="scene lengths a metre of the robot [-]")
]
RestValues = Annotated[
    dict[str, Angle],
    Field(default_factory=dict, description="initial values of hinges [deg], else 0"),
]


class UrdfModel(Model):
    """A chain of a robot."""

    urdf: RobotFile
    base: Annotated[str, Field(min_length=1, description="link the chain starts from")]
    end: Annotated[str, Field(min_length=1, description="link that goes to the goals")]
    scale: Scale = 1.0
    rest: RestValues


@dataclass(frozen=True, eq=False)
class UrdfBody(Body):
    """A chain of a robot, with the way back to the robot's joint values."""

    join: Joined = field(kw_only=True)

    def values(self, angles: Array) -> Values:
        """Return the robot's hinge values [rad]."""
        names, rows = self.join.hinge_values(angles)
        return Values(names, "rad", rows)


def read_body(model: UrdfModel, folder: Path) -> UrdfBody:
    """Make a chain of a robot.

    Raises:
        InputError: The file is at fault, or there is no such chain in it.
    """
    robot = read_urdf(folder / model.urdf)
    joints = _between(robot, model.base, model.end)
    faults = [fault for joint in joints for fault in refusals(joint)]
    hinges = [joint.name for joint in joints if joint.is_hinge]
    faults += rest_faults(model.rest, hinges, "no hinge {} in the chain")
    if not hinges and not faults:
        message = f"there is no hinge between '{model.base}' and '{model.end}'"
        faults.append(Fault("chain", message, "end"))
    if faults:
        raise InputError(faults)
    models, notes = hinge_models(joints, model.end, model.scale, model.rest)
    join = joined(models)
    return UrdfBody(Chain(join.joints), (*robot.notes, *notes), join=join)


def _between(robot: Robot, base: str, end: str) -> list[UrdfJoint]:
    """Give the joints from one link down to another."""
    faults = []
    for key, link in (("base", base), ("end", end)):
        if link not in robot.links:
            hint = near_match(link, list(robot.links)) or f"roots: {', '.join(robot.roots[:12])}"
            faults.append(Fault("unknown-link", f"the robot has no link '{link}'", key, hint=hint))
    if faults:
        raise InputError(faults)
    way = robot.up_from(end)
    if base not in way[1:]:
        above = ", ".join(way[1:13]) or "nothing, it is a root"
        message = f"the link '{end}' does not hang from '{base}'"
        raise InputError(Fault("chain", message, "base", hint=f"it hangs from: {above}"))
    links = reversed(way[: way.index(base)])
    return [robot.joints[link] for link in links]


def refusals(joint: UrdfJoint) -> list[Fault]:
    """Say why a joint cannot be in a chain, if so."""
    if joint.kind in _WHY_NOT:
        message = f"joint '{joint.name}' {_WHY_NOT[joint.kind]}"
        return [joint.element.fault(joint.kind, message, "type")]
    if joint.mimics:
        message = f"joint '{joint.name}' copies the joint '{joint.mimics}' and cannot be solved"
        hint = "choose a chain without coupled joints"
        return [joint.element.fault("mimic", message, hint=hint)]
    return []


def hinge_models(
    joints: Sequence[UrdfJoint], end: str, scale: float, rest: Mapping[str, float]
) -> tuple[list[ModelJoint], list[str]]:
    """Make joints of a chain, in limbik's axes; fixed joints are merged into the next one.

    Args:
        joints: From the base link down to the end, none that `refusals` refuses.
        end: Name of the end link.
        scale: Scene lengths a metre.
        rest: Initial values of hinges [deg].

    Returns:
        The hinges and the end, the first with its offset from the base link; and what should be
        known about them.
    """
    models: list[ModelJoint] = []
    notes: list[str] = []
    place, turn = np.zeros(3), np.eye(3)
    for joint in joints:
        offset, own = origin(joint, scale)
        place, turn = place + turn @ offset, turn @ own
        if not joint.is_hinge:
            continue
        value, note = rest_value(joint, rest)
        notes += note
        axis = Z_UP.points(joint.axis)
        models.append(ModelJoint(joint.name, place, turn, "hinge", axis, joint.limit, value))
        place, turn = np.zeros(3), np.eye(3)
    while end in {model.name for model in models}:
        end += " link"
    return [*models, ModelJoint(end, place, turn, "fixed")], notes


def origin(joint: UrdfJoint, scale: float) -> tuple[Array, Array]:
    """Return where a joint stands in its parent link, (3,) [length], and how it is turned there."""
    turn = Z_UP.rotations(rpy_to_matrix(joint.turn))
    return Z_UP.points(joint.place) * scale, turn


def rest_faults(rest: Iterable[str], hinges: Sequence[str], message: str) -> list[Fault]:
    """Refuse initial values of what is no hinge.

    Args:
        rest: Names that are given values.
        hinges: Names of the hinges there are.
        message: What to say, with `{}` for the name.
    """
    return [
        Fault("unknown-joint", message.format(f"'{name}'"), "rest", hint=hint)
        for name in rest
        if name not in hinges
        for hint in [near_match(name, list(hinges)) or f"hinges: {', '.join(hinges[:12])}"]
    ]


def rest_value(joint: UrdfJoint, wanted_degrees: Mapping[str, float]) -> tuple[float, list[str]]:
    """Give a hinge's rest value [rad] inside its limits, and what should be known about it."""
    wanted = radians(wanted_degrees.get(joint.name, 0.0))
    if joint.limit is None:
        return wanted, []
    rest = min(max(wanted, joint.limit[0]), joint.limit[1])
    if rest == wanted:
        return rest, []
    shown = f"{degrees(wanted):g}° is outside its range; it rests at {degrees(rest):.4g}°"
    return rest, [f"joint '{joint.name}': {shown}"]


def inspect(path: Path) -> Inspection:
    """Say what a robot's file holds.

    Raises:
        InputError: The file is at fault.
    """
    robot = read_urdf(path)
    hinges = sum(joint.is_hinge for joint in robot.joints.values())
    title = f"robot '{robot.name}': {len(robot.links)} links, {len(robot.joints)} joints, "
    rows = tuple(_row(joint) for joint in robot.joints.values())
    notes = [*robot.notes]
    if len(robot.roots) > 1:
        notes.append(f"the robot has {len(robot.roots)} roots: {', '.join(robot.roots[:12])}")
    return Inspection(
        f"{title}{hinges} of them hinges",
        ("joint", "type", "axis", "range", "parent", "child"),
        rows,
        tuple(_candidates(robot)),
        tuple(notes),
    )


def _row(joint: UrdfJoint) -> tuple[str, ...]:
    kind = f"{joint.kind}, copies {joint.mimics}" if joint.mimics else joint.kind
    axis = "" if joint.kind == "fixed" else " ".join(f"{value:.4g}" for value in joint.axis + 0.0)
    span = ""
    if joint.limit is not None:
        turns = joint.kind == "revolute"
        span = " to ".join(f"{degrees(v) if turns else v:.4g}" for v in joint.limit)
        span += "°" if turns else " m"
    return joint.name, kind, axis, span, joint.parent, joint.child


def _candidates(robot: Robot) -> Iterable[tuple[str, str, str]]:
    """Chains from where branches part to their tips, with two hinges or more.

    What limbik does not turn at a tip, such as the fingers of a gripper, is left out: the chain
    ends above it.
    """
    parents = [joint.parent for joint in robot.joints.values()]
    found: dict[str, tuple[str, str, str]] = {}
    for tip in robot.links:
        if tip in parents or tip not in robot.joints:
            continue
        joints: list[UrdfJoint] = []
        for link in robot.up_from(tip)[:-1]:
            joint = robot.joints[link]
            if refusals(joint):
                if _is_chain(joints):
                    break
                joints = []
                continue
            joints.append(joint)
            forks = parents.count(joint.parent) > 1
            if forks and _is_chain(joints):
                break
        if _is_chain(joints):
            end = joints[0].child
            hinges = [joint.name for joint in reversed(joints) if joint.is_hinge]
            words = f"{len(hinges)} hinges: {', '.join(hinges)}"
            found.setdefault(end, (joints[-1].parent, end, words))
    return found.values()


def _is_chain(upward: list[UrdfJoint]) -> bool:
    """Whether there are two hinges and a bone that the first one moves."""
    hinges = [place for place, joint in enumerate(upward) if joint.is_hinge]
    moved = upward[: hinges[-1]] if hinges else []
    return len(hinges) > 1 and any(np.linalg.norm(joint.place) > SHORTEST for joint in moved)
