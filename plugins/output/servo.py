"""Servo commands: joint angles as goal positions of servos, and back (004; readings C-8 to C-10).

A profile says which servo turns which axis of which joint:

```yaml
servo: 1                       # version of the format
model: ax-12                   # optional: values below that are not given
joints:
  waist heading: {id: 1}
  shoulder pitch: {id: 2, offset: 0}
  elbow pitch: {id: 3, direction: -1, rounding: truncate}
```
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, floor, radians
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from limbik.core.chain import AXES, Chain
from limbik.core.errors import Fault, InputError, SceneError, shortlist
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.settings import Model
from limbik.core.solution import Solution
from limbik.core.validation import validation_faults
from limbik.core.wording import near_match
from limbik.core.yamlfile import read_yaml_file


class Servo(Model):
    """One servo: tick = centre + direction x (angle + offset) x (ticks - 1) / range.

    The defaults are an AX-12+: 10 bit, 300 degrees, centre 512.
    """

    id: Annotated[int, Field(ge=0, le=65535, description="the servo's number on its bus")]
    ticks: Annotated[int, Field(ge=2, le=1 << 24, description="positions; 0 to ticks - 1")] = 1024
    range: Annotated[float, Field(gt=0.0, le=36000.0, description="all positions [deg]")] = 300.0
    centre: Annotated[float, Field(ge=0.0, description="tick of angle 0")] = 512.0
    direction: Annotated[Literal[1, -1], Field(description="-1: mounted the other way")] = 1
    offset: Annotated[float, Field(ge=-360.0, le=360.0, description="added [deg]")] = 0.0
    rounding: Annotated[
        Literal["nearest", "truncate"], Field(description="how a tick is made whole")
    ] = "nearest"

    @property
    def density(self) -> float:
        """Ticks a degree."""
        return (self.ticks - 1) / self.range

    def tick(self, angle: float) -> int:
        """Return the tick of an angle [rad], which may lie outside the servo's range."""
        exact = self.centre + self.direction * (degrees(angle) + self.offset) * self.density
        return int(exact) if self.rounding == "truncate" else round(exact)

    def angle(self, tick: int) -> float:
        """Return the angle of a tick [rad]."""
        turned = (tick - self.centre) / (self.direction * self.density)
        return radians(turned - self.offset)

    def accepts(self, tick: int) -> bool:
        """Whether the servo has such a tick."""
        return 0 <= tick < self.ticks

    @property
    def span(self) -> tuple[float, float]:
        """Lowest and highest angle [deg]."""
        ends = degrees(self.angle(0)), degrees(self.angle(self.ticks - 1))
        return min(ends), max(ends)


class _ProfileModel(Model):
    """A profile file."""

    servo: Literal[1]
    model: str = "ax-12"
    joints: dict[str, Servo]


MODELS: dict[str, dict[str, Any]] = {"ax-12": {}}
"""Built-in profiles, as what differs from the defaults of `Servo`."""


@dataclass(frozen=True)
class Command:
    """What one servo is told.

    Attributes:
        joint: Name of the joint.
        axis: `heading`, `pitch` or `bank`.
        id: The servo's number.
        angle: Angle of the solve [rad].
        tick: Goal position.
        achieved: Angle of that position [rad].
    """

    joint: str
    axis: str
    id: int
    angle: float
    tick: int
    achieved: float


@dataclass(frozen=True)
class ServoPose:
    """A pose as servos hold it.

    Attributes:
        commands: One a servo.
        angles: The pose after quantisation, HPB, (n, 3) [rad].
        position: World position of the end in that pose, (3,) [length].
        distance: From there to the goal [length].
    """

    commands: tuple[Command, ...]
    angles: Array
    position: Array
    distance: float


@dataclass(frozen=True)
class Profile:
    """Which servo turns which axis: `(joint index, axis index) -> Servo`."""

    servos: Mapping[tuple[int, int], Servo]

    def quantise(self, solution: Solution, goal: str = "") -> ServoPose:
        """Turn the solution of one goal into servo commands.

        Args:
            solution: The pose.
            goal: Name of the goal for messages.

        Raises:
            InputError: An angle is outside its servo's range; every such joint is named with its
                angle and the range.
        """
        names, faults = solution.chain.names, []
        commands, achieved = [], solution.angles.copy()
        for (joint, axis), servo in self.servos.items():
            angle = float(solution.angles[joint, axis])
            tick = servo.tick(angle)
            if not servo.accepts(tick):
                where = f"goal '{goal}': " if goal else ""
                name = f"{names[joint]} {AXES[axis]}"
                faults.append(out_of_range(name, angle, servo, where))
            reached = achieved[joint, axis] = servo.angle(tick)
            commands.append(Command(names[joint], AXES[axis], servo.id, angle, tick, reached))
        if faults:
            raise InputError(faults)
        positions, _ = forward_kinematics(solution.chain, achieved)
        distance = float(np.linalg.norm(positions[-1] - solution.goal))
        return ServoPose(tuple(commands), achieved, positions[-1], distance)

    def quantise_all(self, names: Sequence[str], solutions: Sequence[Solution]) -> list[ServoPose]:
        """Turn the solutions of named goals into servo commands.

        Raises:
            InputError: With every joint of every goal that its servo cannot follow.
        """
        poses, faults = [], list[Fault]()
        for name, solution in zip(names, solutions, strict=True):
            try:
                poses.append(self.quantise(solution, name))
            except InputError as error:
                faults += error.faults
        if faults:
            raise InputError(shortlist(faults))
        return poses

    def angles(self, ticks: Mapping[int, int], chain: Chain) -> Array:
        """Return the pose that ticks by servo number stand for, HPB, (n, 3) [rad].

        Axes without a servo rest.

        Raises:
            InputError: A servo's tick is missing or it has no such tick.
        """
        pose = chain.rest.copy()
        for (joint, axis), servo in self.servos.items():
            if servo.id not in ticks or not servo.accepts(ticks[servo.id]):
                found = ticks.get(servo.id, "none")
                message = f"servo {servo.id} needs a tick 0 to {servo.ticks - 1}, found {found}"
                raise InputError(Fault("servo-range", message))
            pose[joint, axis] = servo.angle(ticks[servo.id])
        return pose


def out_of_range(name: str, angle: float, servo: Servo, where: str) -> Fault:
    """Return the fault of a joint's axis whose angle [rad] its servo does not have."""
    low, high = (floor(end * 100.0 + 0.5) / 100.0 for end in servo.span)
    message = (
        f"{where}{name} is at {degrees(angle):.2f}°, servo {servo.id} turns {low:g}° to {high:g}°"
    )
    return Fault("servo-range", message, name)


def read_profile(source: str | Path, chain: Chain) -> Profile:
    """Read a profile: the name of a built-in one, or a YAML file.

    A built-in profile gives each axis of the chain that can turn a servo, numbered from 1.

    Args:
        source: `ax-12` or the file's path.
        chain: The chain it is for.

    Raises:
        InputError: There is no such profile, or it names joints the chain does not have.
        SceneError: The file is wrong; each fault has its line.
    """
    if str(source) in MODELS:
        settings = MODELS[str(source)]
        servos = {key: Servo(id=k, **settings) for k, key in enumerate(chain.moving_axes, 1)}
        return Profile(servos)
    if not Path(source).suffix:
        hint = near_match(str(source), list(MODELS))
        message = f"no servo profile is called '{source}'; known: {', '.join(MODELS)}, or a file"
        raise InputError(Fault("choice", message, "--servo", hint=hint))
    return _read_file(source, chain)


def _read_file(source: str | Path, chain: Chain) -> Profile:
    document = read_yaml_file(source)
    try:
        model = _ProfileModel.model_validate(document.content)
    except ValidationError as error:
        raise SceneError(validation_faults(error, document, _ProfileModel)) from None
    faults = []
    if model.model not in MODELS:
        message = f"no servo model is called '{model.model}'; known: {', '.join(MODELS)}"
        hint = near_match(model.model, list(MODELS))
        faults.append(document.fault("choice", message, ("model",), hint=hint))
    names = chain.axis_names
    seen: dict[int, str] = {}
    for name, servo in model.joints.items():
        if name not in names:
            message = f"'{name}' must be a joint of the chain and an axis, such as '{names[0]}'"
            hint = near_match(name, names)
            faults.append(document.fault("unknown-joint", message, ("joints", name), hint=hint))
        if servo.id in seen:
            message = f"the servo {servo.id} turns '{seen[servo.id]}' already"
            faults.append(document.fault("duplicate-name", message, ("joints", name, "id")))
        seen[servo.id] = name
    if faults:
        raise SceneError(faults)
    return Profile(_servos(model, names))


def _servos(model: _ProfileModel, names: Sequence[str]) -> dict[tuple[int, int], Servo]:
    servos = {}
    for name, servo in model.joints.items():
        joint, axis = divmod(names.index(name), 3)
        settings = MODELS[model.model] | servo.model_dump(exclude_unset=True)
        servos[joint, axis] = Servo(**settings)
    return servos
