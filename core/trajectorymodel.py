"""The shape of a scene's `trajectory`: key points and a program of moves (003).

```yaml
trajectory:
  limits: {speed: 20, acceleration: 60, rotation_speed: 90, rotation_acceleration: 360}
  points:                        # orientations; a point without a position is the goal of its name
    seam: {euler: [0, -90, 0], convention: hpb}
    home: {joints: {elbow: [0, -90, 0]}}
  start: home
  program:
    - line: {to: seam}
    - blend: {before: 2}
    - arc: {via: bend, to: exit}
```

Lengths are in the scene's unit, times in seconds, angles in degrees.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from limbik.core.settings import Model
from limbik.core.wording import found_words


def _tuple(value: Any) -> Any:
    """Let a list stand for a tuple, which strict models refuse otherwise."""
    if isinstance(value, list):
        return tuple(tuple(row) if isinstance(row, list) else row for row in value)
    message = "must be a list of numbers, not {found}"
    raise PydanticCustomError("type", message, {"found": found_words(value)})


Number = Annotated[float, Field(ge=-1e6, le=1e6)]
Positive = Annotated[float, Field(gt=0.0, le=1e6)]
Vector = Annotated[tuple[Number, Number, Number], BeforeValidator(_tuple)]
Four = Annotated[tuple[Number, Number, Number, Number], BeforeValidator(_tuple)]
Row = tuple[Number, Number, Number, Number]
Matrix = Annotated[tuple[Row, Row, Row, Row], BeforeValidator(_tuple)]
Smooth = Annotated[float, Field(ge=0.0, le=0.5, description="half window of a section [-]")]


class PointModel(Model):
    """A key point; the orientation by one of matrix, quaternion, euler, joints, or none."""

    position: Annotated[Vector | None, Field(description="absent = the goal's of this name")] = None
    matrix: Annotated[Matrix | None, Field(description="4 x 4, holds the position too")] = None
    quaternion: Annotated[Four | None, Field(description="w, x, y, z")] = None
    euler: Annotated[Vector | None, Field(description="three angles [deg]")] = None
    convention: Annotated[
        str | None, Field(description="hpb, or three letters such as ZYX (turned) or xyz (fixed)")
    ] = None
    joints: Annotated[
        dict[str, Vector] | None,
        Field(
            description="HPB by joint [deg], others at rest; gives the position too, and as the "
            "start the pose that pose goals set out from"
        ),
    ] = None

    @model_validator(mode="after")
    def _one_orientation(self) -> "PointModel":
        given = [n for n in ("matrix", "quaternion", "euler", "joints") if getattr(self, n)]
        if len(given) > 1:
            raise PydanticCustomError(
                "choice", "one orientation, not {given}", {"given": " and ".join(given)}
            )
        if (self.euler is None) != (self.convention is None):
            raise PydanticCustomError("choice", "euler and convention go together")
        if self.position is not None and (self.matrix or self.joints):
            raise PydanticCustomError("choice", "matrix and joints give the position already")
        return self


class LimitsModel(Model):
    """How fast; what is absent is as in the trajectory's own limits, or has no bound."""

    speed: Annotated[Positive | None, Field(description="[length/s]")] = None
    acceleration: Annotated[Positive | None, Field(description="[length/s²]")] = None
    deceleration: Annotated[Positive | None, Field(description="[length/s²]")] = None
    jerk: Annotated[Positive | None, Field(description="[length/s³]")] = None
    ramp_times: Annotated[
        tuple[Positive, Positive] | None,
        BeforeValidator(lambda value: value if value is None else _tuple(value)),
        Field(description="from rest to speed and back [s], instead of accelerations"),
    ] = None
    short: Annotated[
        Literal["keep-accelerations", "keep-times"] | None,
        Field(description="what a way too short for the speed keeps, with ramp_times"),
    ] = None
    rotation_speed: Annotated[Positive | None, Field(description="[deg/s]")] = None
    rotation_acceleration: Annotated[Positive | None, Field(description="[deg/s²]")] = None
    centripetal: Annotated[Positive | None, Field(description="on curves [length/s²]")] = None


class LineModel(Model):
    """Straight to a point, or turning on the spot."""

    to: str
    limits: LimitsModel = LimitsModel()


class ArcModel(Model):
    """Over a point to another."""

    via: str
    to: str
    full: Annotated[bool, Field(description="on to the start: a whole circle")] = False
    orientation: Literal["through", "ends"] = "through"
    smooth: Smooth = 0.0
    limits: LimitsModel = LimitsModel()


class ArcAboutModel(Model):
    """About a centre by an angle; the end turns along."""

    center: Vector
    axis: Vector
    angle: Annotated[float, Field(ge=-36000.0, le=36000.0, description="[deg]")]
    limits: LimitsModel = LimitsModel()


class SplineModel(Model):
    """Through two more points or more."""

    through: list[str]
    parameter: Literal["uniform", "centripetal", "chord"] = "centripetal"
    orientation: Literal["length", "parameter"] = "length"
    smooth: Smooth = 0.0
    limits: LimitsModel = LimitsModel()


class StopModel(Model):
    """Stand still."""

    pause: Annotated[float, Field(ge=0.0, le=1e6, description="[s]")] = 0.0


class BlendModel(Model):
    """Round the corner."""

    before: Annotated[Positive, Field(description="the key point [length]")]
    after: Annotated[Positive | None, Field(description="absent = as before")] = None
    tangent: Literal["auto", "sum", "circle", "chord", "parabola", "unit"] = "auto"
    speed: Literal["ramp", "min"] = "ramp"
    centripetal: Annotated[Positive | None, Field(description="[length/s²]")] = None
    orientation: Literal["smooth", "linear"] = "smooth"


class OverlapModel(Model):
    """Start the next move before this one has ended; exactly one of the three."""

    time: Annotated[float | None, Field(ge=0.0, description="[s]")] = None
    cut: Annotated[Positive | None, Field(description="past the key point [length]")] = None
    full: Annotated[bool, Field(description="as long as the ramps allow")] = False


class StepModel(Model):
    """A move or what joins two moves: exactly one key."""

    line: LineModel | None = None
    turn: LineModel | None = None
    arc: ArcModel | None = None
    arc_about: ArcAboutModel | None = None
    spline: SplineModel | None = None
    stop: StopModel | None = None
    blend: BlendModel | None = None
    overlap: OverlapModel | None = None

    @property
    def chosen(self) -> tuple[str, Any]:
        """The one key and its model."""
        name = next(iter(self.model_fields_set))
        return name, getattr(self, name)

    @model_validator(mode="after")
    def _one_key(self) -> "StepModel":
        if len(self.model_fields_set) != 1 or self.chosen[1] is None:
            names = ", ".join(type(self).model_fields)
            message = "a step has exactly one of {names}"
            raise PydanticCustomError("choice", message, {"names": names})
        return self


class TrajectoryModel(Model):
    """A program of moves."""

    dt: Annotated[Positive, Field(description="time between samples [s]")] = 0.01
    frame: Annotated[
        Literal["limbik", "right-handed"],
        Field(description="of the points given here: left-handed Y-up, or right-handed Z-up"),
    ] = "limbik"
    order: Annotated[Literal["base", "tool"], Field(description="how overlaps join rotations")] = (
        "base"
    )
    limits: LimitsModel
    joint_speeds: Annotated[
        dict[str, Positive], Field(default_factory=dict, description="by joint [deg/s]")
    ]
    points: Annotated[dict[str, PointModel], Field(default_factory=dict)]
    start: Annotated[str, Field(description="name of a point or a goal")]
    program: list[StepModel]
