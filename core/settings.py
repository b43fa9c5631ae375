"""The options of a solve, one checked model for Python and scenes (000 tables 7-4 to 7-19).

Angles are in degrees, lengths in the chain's unit. The defaults are the document's (C-17).
"""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Final, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError, model_validator

Axis = Literal["x+", "x-", "y+", "y-", "z+", "z-"]
Choice = str | dict[str, Any]


def list_as_tuple(value: Any) -> Any:
    """Let a list from a scene stand for a tuple, which strict models refuse otherwise."""
    return tuple(value) if isinstance(value, list) else value


Turn = Annotated[tuple[float, float, float], BeforeValidator(list_as_tuple)]


class Model(BaseModel):
    """Strict, frozen, no unknown keys, no NaN."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    def __init__(self, /, **values: Any) -> None:
        """Check values a program gives.

        Raises:
            InputError: A value is refused, or a key is unknown.
        """
        try:
            super().__init__(**values)
        except ValidationError as error:
            from limbik.core.validation import model_error

            raise model_error(error, type(self), values) from None

    # What pydantic marks its own constructor with: models inside of models are made without it.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined]


class Held(Model):
    """Joints held from both ends (000 §6.1(10), table 7-5).

    CCD leaves them alone; `bend_base` and `bend_end` leave them out of the initial bend too.
    """

    base: Annotated[int, Field(ge=0, description="joints held from the base")] = 0
    end: Annotated[int, Field(ge=0, description="joints held before the end")] = 0
    bend_base: Annotated[bool, Field(description="the base's stay out of the initial bend")] = False
    bend_end: Annotated[bool, Field(description="the end's stay out of the initial bend")] = False


class ForbiddenCone(Model):
    """Directions the bend vector may not take (000 §6.3(11)(D)); the axis is of the IK space."""

    axis: Axis
    half_angle: Annotated[
        float, Field(gt=0.0, le=90.0, description="from the axis to the rim [deg]")
    ]
    entry: Annotated[
        Literal["stop", "go-around"],
        Field(description="turn out toward the previous vector or toward the new one"),
    ] = "stop"


class Choose(Model):
    """Which of a goal's solutions to take (000 §11; F-01)."""

    by: Annotated[
        Literal["nearest", "margin"],
        Field(description="nearest to a pose, or with the most left to the nearest limit"),
    ] = "nearest"
    pose: Annotated[
        dict[str, Turn] | None,
        Field(
            description="angles by joint, HPB [deg], the others at rest; absent = the pose before, "
            "else the rest pose"
        ),
    ] = None
    weights: Annotated[
        dict[str, Annotated[float, Field(ge=0.0, le=1e6, json_schema_extra={"default": 1.0})]],
        Field(default_factory=dict, description="how much a joint counts; 1 where absent [-]"),
    ]
    candidates: Annotated[
        int, Field(ge=1, le=10_000, description="most other poses that are finished")
    ] = 32


class Settings(Model):
    """Everything a solve can be told besides chain and goal.

    Raises:
        InputError: A value is out of its range or a key is unknown.
    """

    ik: Annotated[bool, Field(description="false: full FK, no solve (000 §6.1(1))")] = True
    tolerance: Annotated[float, Field(gt=0.0, description="distance that counts as reached")] = 0.01
    max_iterations: Annotated[
        int,
        Field(ge=-2, le=100_000, description="-2 initial (3D), -1 aim, 0 bend pose, N CCD rounds"),
    ] = 20
    smoothing: Annotated[
        float, Field(ge=0.1, le=1.0, description="CCD round k has strength min(k x this, 1)")
    ] = 0.1
    max_violations: Annotated[
        int,
        Field(
            ge=0,
            le=100_000,
            description="rounds in a row past a limit before CCD drops a joint; 0 = no bound",
        ),
    ] = 0
    held: Held = Held()

    initial_bend: Choice = "nth-root"
    bend_vector: Choice = "manual"
    root_control: Choice = "none"
    bank_suppression: Choice = "none"
    finish: Choice = "newton"
    choose: Annotated[
        Choose | None, Field(description="which solution to take; absent = the first found")
    ] = None

    coefficient_base: Annotated[
        float, Field(ge=0.0, le=2.0, description="bend coefficient [-]")
    ] = 1.0
    weight_range: Annotated[
        tuple[
            Annotated[float, Field(ge=-1.0, le=1.0)],
            Annotated[float, Field(ge=-1.0, le=1.0)],
        ],
        BeforeValidator(list_as_tuple),
        Field(description="bend weight base (min, max) [-]"),
    ] = (0.0, 0.0)
    bend_reference: Annotated[
        int, Field(ge=0, description="index of the bend reference joint; 0 in 2D only")
    ] = 1
    reference_axis: Annotated[
        Literal["free", "x+", "x-", "y+", "y-"],
        Field(description="axis of the reference joint turned to the bend vector"),
    ] = "y+"
    twist: Annotated[
        float, Field(ge=-360.0, le=360.0, description="twist about the root's Z axis [deg]")
    ] = 0.0
    aim_twist: Annotated[bool, Field(description="twist the root in the aim pose too")] = False
    off_axis: Annotated[bool, Field(description="children lie off the joints' Z axes")] = False
    aim_from: Annotated[
        Literal["initial", "previous"],
        Field(description="pose the aim starts from; previous = the document's, drifts"),
    ] = "initial"
    bank_lock: Annotated[bool, Field(description="lock banks from the reference on")] = False
    forbidden_cone: ForbiddenCone | None = None
    hold_bend_vector: Annotated[
        bool, Field(description="keep the previous bend vector (manual, global)")
    ] = False
    bend_smoothing: Annotated[
        float,
        Field(
            ge=0.0, le=45.0, description="largest turn of the bend vector a solve [deg]; 0 = off"
        ),
    ] = 0.0
    reach_limit: Annotated[
        bool, Field(description="pull goals into the range of the end's distances from the base")
    ] = False
    clamp: Annotated[
        Literal["re-aim", "plain"], Field(description="what a turn past a limit does")
    ] = "re-aim"
    start: Annotated[
        Literal["bend", "current"],
        Field(description="CCD starts from the bend pose or from the pose of the solve before"),
    ] = "bend"
    soft_zone: Annotated[
        float,
        Field(ge=0.0, le=0.5, description="last part of the reach, pulled in smoothly; 0 = off"),
    ] = 0.0
    stiffness: Annotated[
        dict[str, Annotated[float, Field(ge=0.0, lt=1.0, json_schema_extra={"default": 0.0})]],
        Field(
            description="share by which CCD turns a joint less; `held` keeps joints still [-]",
        ),
    ] = {}
    limit_ease: Annotated[
        float,
        Field(ge=0.0, le=90.0, description="zone before a limit where CCD slows; 0 = off [deg]"),
    ] = 0.0
    end_orientation: Annotated[
        float,
        Field(ge=0.0, le=1.0, description="share of the goal's orientation the end takes over [-]"),
    ] = 0.0
    fk_strength: Annotated[
        float, Field(ge=0.0, le=1.0, description="strength of FK offsets [-]")
    ] = 1.0
    fk_mix: Annotated[float, Field(ge=0.0, le=1.0, description="0 = IK, 1 = FK [-]")] = 0.0

    @model_validator(mode="after")
    def _holding_needs_a_fixed_mode(self) -> "Settings":
        given = self.bend_vector
        mode = given.get("use") if isinstance(given, dict) else given
        if self.hold_bend_vector and mode == "auto":
            raise ValueError(
                "hold_bend_vector goes with the modes manual and global, not with auto"
            )
        return self

    @model_validator(mode="after")
    def _a_choice_needs_a_finish(self) -> "Settings":
        if self.choose is not None and self.finish in ("none", {"use": "none"}):
            raise ValueError("choose needs a finish to try other solutions, not finish: none")
        return self


def narrowing(settings: Settings) -> Iterator[str]:
    """Give the options that narrow ranges, which joints with limits of their own have not."""
    if settings.root_control not in ("none", {"use": "none"}):
        yield "root_control"
    if settings.bank_lock:
        yield "bank_lock"


def joint_tables(settings: Settings) -> Iterator[tuple[tuple[str, ...], Mapping[str, object]]]:
    """Give key path and content of each option that names joints."""
    if settings.choose is not None:
        yield ("choose", "pose"), settings.choose.pose or {}
        yield ("choose", "weights"), settings.choose.weights
    yield ("stiffness",), settings.stiffness


ONLY_3D: Final = (
    "bend_vector",
    "root_control",
    "bank_suppression",
    "aim_twist",
    "off_axis",
    "aim_from",
    "bank_lock",
    "forbidden_cone",
    "hold_bend_vector",
    "bend_smoothing",
    "clamp",
    "start",
    "end_orientation",
    "choose",
    "stiffness",
    "limit_ease",
)
"""Settings the 2D solver has no use for; giving one is an error."""


def misfits_in_2d(settings: Settings) -> Iterator[tuple[str, str, str]]:
    """Give name, code and message of each setting that is given and that the 2D solver has not."""
    for name in ONLY_3D:
        if name in settings.model_fields_set:
            pole = "; the pole gives the bend in 2D" if name == "bend_vector" else ""
            yield name, "solver", f"belongs to the 3D solver{pole}"
    if settings.finish != "newton" and settings.finish != "none":
        yield "finish", "solver", "belongs to the 3D solver; in 2D it can only be none"
    if settings.max_iterations == -2:
        message = "must be -1 or more in 2D, not -2: the initial pose is a stage of the 3D solver"
        yield "max_iterations", "range", message
