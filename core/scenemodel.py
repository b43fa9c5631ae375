"""The shape of a scene file: which keys there are and what each may hold.

Lengths are in the scene's own unit, angles in degrees, rotations heading, pitch, bank.
"""

import re
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from limbik.core.goalturn import matrix_turn, quaternion_to_hpb
from limbik.core.pole import PoleRotor, Preset
from limbik.core.rotation import Array
from limbik.core.settings import Model, Settings
from limbik.core.trajectorymodel import Four, Matrix, TrajectoryModel
from limbik.core.wording import found_words

FARTHEST = 1e6  # [length]; beyond it float64 no longer tells tolerances apart
FULLEST = 360.0  # [deg]; largest angle of a turn
_NAME = re.compile(r"\w[\w .+-]{0,63}")


def check_version(value: Any) -> Any:
    """Refuse true, which Python takes for 1."""
    if isinstance(value, bool):
        message = "must be 1, not {found}"
        raise PydanticCustomError("choice", message, {"found": found_words(value)})
    return value


def _three(value: Any) -> Any:
    """Let a list stand for a tuple, which strict models refuse otherwise."""
    if isinstance(value, list):
        return tuple(value)
    message = "must be a list of three numbers, not {found}"
    raise PydanticCustomError("type", message, {"found": found_words(value)})


def _range(value: Any) -> Any:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value, value
    if isinstance(value, list) and len(value) == 2:
        return tuple(value)
    message = "must be a range [minimum, maximum] or one number, not {found}"
    raise PydanticCustomError("type", message, {"found": found_words(value)})


def _ordered(span: tuple[float, float]) -> tuple[float, float]:
    shown = {"low": f"{span[0]:g}", "high": f"{span[1]:g}"}
    if span[0] > span[1]:
        raise PydanticCustomError("range", "the minimum {low} is above the maximum {high}", shown)
    if span[0] < -180.0 or span[1] > 180.0:
        message = (
            "the range [{low}, {high}] crosses ±180; turn the joint's zero with 'frozen' so that "
            "it fits between -180 and 180"
        )
        raise PydanticCustomError("range", message, shown)
    return span


def _name(text: str) -> str:
    if _NAME.fullmatch(text):
        return text
    message = "a name has 1 to 64 letters, digits, spaces or . + - _, not {found}"
    raise PydanticCustomError("name", message, {"found": found_words(text)})


Name = Annotated[str, AfterValidator(_name)]
Length = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Angle = Annotated[float, Field(ge=-FULLEST, le=FULLEST)]
Place = Annotated[tuple[Length, Length, Length], BeforeValidator(_three)]
Turn = Annotated[tuple[Angle, Angle, Angle], BeforeValidator(_three)]
_DEGREES = {"type": "number", "minimum": -180.0, "maximum": 180.0}
_PAIR = {"type": "array", "items": _DEGREES, "minItems": 2, "maxItems": 2}
Range = Annotated[
    tuple[float, float],
    BeforeValidator(_range),
    AfterValidator(_ordered),
    WithJsonSchema({"anyOf": [_PAIR, _DEGREES]}),
]
NOWHERE = (0.0, 0.0, 0.0)


class BaseModel(Model):
    """Where the chain is fastened."""

    position: Annotated[Place, Field(description="in the world [length]")] = NOWHERE
    rotation: Annotated[Turn, Field(description="heading, pitch, bank [deg]")] = NOWHERE


class JointModel(Model):
    """One joint; its ranges are relative to its frozen rotation."""

    name: Annotated[Name, Field(description="unique in the chain")]
    offset: Annotated[Place, Field(description="in the parent's frame [length]")] = NOWHERE
    frozen: Annotated[Turn, Field(description="rotation of the zero pose, HPB [deg]")] = NOWHERE
    rest: Annotated[Turn, Field(description="initial angles, HPB [deg]")] = NOWHERE
    heading: Annotated[Range | None, Field(description="range [deg]; absent = free")] = None
    pitch: Annotated[Range | None, Field(description="range [deg]; absent = free")] = None
    bank: Annotated[Range | None, Field(description="range [deg]; absent = free")] = None
    planar: Annotated[
        Range | None,
        Field(
            description="range in the 2D solver, from the bone before, positive toward the pole "
            "[deg]; absent = the pitch range, [-180, 180] = free"
        ),
    ] = None
    limit: Annotated[
        str | dict[str, Any] | None,
        Field(description="a limit of its own in place of the ranges: {use: name, ...}"),
    ] = None


class ChainModel(Model):
    """The joints, base first; the last one is the end that goes to the goals."""

    base: BaseModel = BaseModel()
    joints: list[JointModel]


class GoalModel(Model):
    """Where the end shall go, and how it shall be turned there."""

    name: Annotated[Name | None, Field(description="absent = its number, from 1")] = None
    position: Annotated[
        Place | None, Field(description="in the world [length]; a matrix holds it")
    ] = None
    rotation: Annotated[
        Turn | None,
        Field(
            description="in the world, HPB [deg]; for pose goals, 2D pole rotors "
            "and the option end_orientation"
        ),
    ] = None
    quaternion: Annotated[Four | None, Field(description="w, x, y, z, instead of a rotation")] = (
        None
    )
    matrix: Annotated[
        Matrix | None, Field(description="4 x 4, instead of position and rotation")
    ] = None

    @property
    def place(self) -> tuple[float, float, float]:
        """Position in the world [length]."""
        if self.matrix is None:
            return self.position or NOWHERE
        return self.matrix[0][3], self.matrix[1][3], self.matrix[2][3]

    @property
    def turn_keys(self) -> list[str]:
        """The keys that give an orientation: none or, if it is sound, one."""
        keys = ("rotation", "quaternion", "matrix")
        return [key for key in keys if getattr(self, key) is not None]

    @property
    def turn(self) -> Array | None:
        """Orientation in the world, HPB [rad]; None without one."""
        if self.matrix is not None:
            return matrix_turn(self.matrix)
        if self.quaternion is not None:
            return quaternion_to_hpb(self.quaternion)
        return None if self.rotation is None else np.radians(self.rotation)

    @model_validator(mode="after")
    def _one_pose(self) -> "GoalModel":
        if len(self.turn_keys) > 1:
            words = {"given": " and ".join(self.turn_keys)}
            raise PydanticCustomError("choice", "one orientation, not {given}", words)
        if (self.position is None) == (self.matrix is None):
            raise PydanticCustomError("choice", "needs a position, or a matrix that holds it")
        try:
            _ = self.turn
        except ValueError as error:
            raise PydanticCustomError("range", "{why}", {"why": str(error)}) from None
        return self


def _rotor_form(value: Any) -> str:
    return "preset" if isinstance(value, str) else "rotor"


class PoleModel(Model):
    """Where the chain of the 2D solver bends to."""

    position: Annotated[Place, Field(description="world [length]; with a rotor, where it rests")]
    rotor: Annotated[
        Annotated[
            Annotated[Preset, Tag("preset")] | Annotated[PoleRotor, Tag("rotor")],
            Discriminator(_rotor_form),
        ]
        | None,
        Field(description="what turns the pole: arm, leg or a mapping; absent = nothing"),
    ] = None
    bind: Annotated[bool, Field(description="leave the rest pose where it is")] = False


class CsvModel(Model):
    """Goals in a CSV file with the columns x, y, z, and name and an orientation if there are any.

    An orientation is heading, pitch, bank [deg], or qw, qx, qy, qz. Other columns are passed over.
    """

    csv: Annotated[str, Field(min_length=1, description="path relative to the scene")]


class NpzModel(Model):
    """Goals in an NPZ file, such as `limbik bake` and `limbik trajectory` write.

    Orientations are an array hpb, (m, 3) [deg], or quaternions, (m, 4), beside the positions.
    """

    npz: Annotated[str, Field(min_length=1, description="path relative to the scene")]
    array: Annotated[
        str | None,
        Field(min_length=1, description="array of (m, 3) positions; absent = goals or positions"),
    ] = None


class JudgeModel(Model):
    """What a motion is judged by: its goals are a path at a steady rate."""

    rate: Annotated[float, Field(gt=0.0, le=100_000.0, description="goals a second [1/s]")] = 60.0
    max: Annotated[
        dict[str, Annotated[float, Field(ge=0.0)]],
        Field(default_factory=dict, description="largest value allowed, by metric"),
    ]


def _goals_form(value: Any) -> str:
    if isinstance(value, dict):
        return "npz" if "npz" in value else "csv"
    return "list"


def _chosen(value: Any) -> Any:
    """Refuse what names no solver; the registry says more about the rest."""
    if isinstance(value, str | dict):
        return value
    message = "must be a solver's name or a mapping, not {found}"
    raise PydanticCustomError("type", message, {"found": found_words(value)})


class SolveModel(Model):
    """How a chain is solved, and for which goals."""

    solver: Annotated[
        Any, AfterValidator(_chosen), Field(description="name of the solver, or {use: name, ...}")
    ] = "3d"
    pole: Annotated[PoleModel | None, Field(description="of the 2D solver")] = None
    options: Settings = Settings()
    fk: Annotated[
        dict[str, Turn],
        Field(default_factory=dict, description="FK offsets by joint, HPB [deg]"),
    ]
    follow: Annotated[
        bool, Field(description="solve the goals as a path, each from the pose before it")
    ] = False
    judge: Annotated[JudgeModel | None, Field(description="thresholds for `limbik judge`")] = None
    axes: Annotated[
        Literal["limbik", "y-up", "z-up"],
        Field(
            description="axes the positions of goals and pole are given in: limbik's, or "
            "right-handed with Y up as clips have them, or with Z up as robots have them"
        ),
    ] = "limbik"
    goals: Annotated[
        Annotated[list[GoalModel], Tag("list")]
        | Annotated[CsvModel, Tag("csv")]
        | Annotated[NpzModel, Tag("npz")],
        Discriminator(_goals_form),
    ]

    @property
    def is_planned(self) -> bool:
        """Whether it has a trajectory; then it needs no goals."""
        return False


class SceneModel(SolveModel):
    """A whole scene file."""

    limbik: Annotated[
        Literal[1], BeforeValidator(check_version), Field(description="version of the format")
    ]
    chain: ChainModel
    trajectory: Annotated[
        TrajectoryModel | None, Field(description="key points and moves between them")
    ] = None

    @property
    def is_planned(self) -> bool:
        """Whether it has a trajectory; then it needs no goals."""
        return self.trajectory is not None
