"""What a user writes: limits, moves, and how one move joins the next (003)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.rotation import Array
from limbik.plugins.paths.keypoint import KeyPoint

Drive = Literal["length", "parameter"]


@dataclass(frozen=True)
class Limits:
    """How fast a move may be; lengths in the chain's unit, angles in radians.

    Attributes:
        speed: Along the path [length/s].
        acceleration: Along the path [length/s²].
        deceleration: [length/s²]; None for the acceleration.
        jerk: [length/s³]; None for none.
        ramp_times: Times from rest to speed and back [s], instead of accelerations (T A5).
        short: What a way too short for the speed keeps, with ramp times (T A6).
        rotation_speed: [rad/s]; None for none (T A41).
        rotation_acceleration: [rad/s²].
        centripetal: Largest sideways acceleration on this move's own curves [length/s²].
    """

    speed: float
    acceleration: float | None = None
    deceleration: float | None = None
    jerk: float | None = None
    ramp_times: tuple[float, float] | None = None
    short: Literal["keep-accelerations", "keep-times"] = "keep-accelerations"
    rotation_speed: float | None = None
    rotation_acceleration: float | None = None
    centripetal: float | None = None


@dataclass(frozen=True)
class Line:
    """Straight to a key point; with the position unchanged it only turns (T A10).

    Attributes:
        to: Key point.
        limits: Speeds of this move; None for the program's.
    """

    to: KeyPoint
    limits: Limits | None = None


@dataclass(frozen=True)
class Turn:
    """Turn on the spot to the orientation of a key point; its position must be the present one."""

    to: KeyPoint
    limits: Limits | None = None


@dataclass(frozen=True)
class Arc:
    """The circle's arc over a key point to another.

    Attributes:
        via: Key point in the middle.
        to: Key point at the end of the arc.
        limits: Speeds; None for the program's.
        full: Go on to the start: a whole circle.
        orientation: `through` the middle key point's orientation, or past it from `ends` (T A24).
        smooth: Half window of orientation smoothing at the inner key points, 0 to 0.5 (T A25).
    """

    via: KeyPoint
    to: KeyPoint
    limits: Limits | None = None
    full: bool = False
    orientation: Literal["through", "ends"] = "through"
    smooth: float = 0.0


@dataclass(frozen=True)
class ArcAbout:
    """An arc by centre and angle.

    Attributes:
        center: (3,) [length].
        axis: Direction of the axis, (3,).
        angle: [rad]; 2π is a full circle. Positive carries x to y about z in the textbook sense.
        orientation: A key point whose orientation is reached at the end (its position is not
            used); None turns the start's orientation along with the arc.
        limits: Speeds; None for the program's.
    """

    center: ArrayLike
    axis: ArrayLike
    angle: float
    orientation: KeyPoint | None = None
    limits: Limits | None = None


@dataclass(frozen=True)
class Spline:
    """The natural cubic spline through two more key points or more.

    Attributes:
        through: Key points after the present one.
        limits: Speeds; None for the program's.
        parameter: `centripetal`, `chord`, or `uniform` as printed (T A15).
        orientation: `length` turns evenly with the length of each section, `parameter` with the
            spline's own, as printed (T A23).
        smooth: As for `Arc`.
    """

    through: Sequence[KeyPoint]
    limits: Limits | None = None
    parameter: Literal["uniform", "centripetal", "chord"] = "centripetal"
    orientation: Drive = "length"
    smooth: float = 0.0


@dataclass(frozen=True)
class Stop:
    """Stand still at the key point; what joins two moves if nothing else is said.

    Attributes:
        pause: How long [s].
    """

    pause: float = 0.0


@dataclass(frozen=True)
class Blend:
    """Round the corner by a cubic between two points near the key point (003 "あてはめ").

    Attributes:
        before: Length before the key point where the old path is left [length].
        after: Length after it; None for the same.
        tangent: Rule for the tangents' length (T A26): `auto` is `circle` for turns below 150°
            and `sum` above; also `sum`, `circle`, `chord`, `parabola`, `unit`.
        speed: `ramp` from one side's speed to the other's, or `min`, one speed for both (T A27).
        centripetal: Largest sideways acceleration in the corner [length/s²]; None for none.
        orientation: `smooth`, with a continuous rotation rate, or `linear` as printed (T A31).
    """

    before: float
    after: float | None = None
    tangent: Literal["auto", "sum", "circle", "chord", "parabola", "unit"] = "auto"
    speed: Literal["ramp", "min"] = "ramp"
    centripetal: float | None = None
    orientation: Literal["smooth", "linear"] = "smooth"


@dataclass(frozen=True)
class Overlap:
    """Start the next move before this one has ended (003 "速度プロファイル重ね方式").

    Give exactly one of the three.

    Attributes:
        time: How long both run [s].
        cut: How far the path may pass the key point [length]; the ramps bound it.
        full: As long as the shorter of the two ramps: the longest without overrun.
    """

    time: float | None = None
    cut: float | None = None
    full: bool = False


Move = Line | Turn | Arc | ArcAbout | Spline
Junction = Stop | Blend | Overlap


def as_vector(values: ArrayLike) -> Array:
    """Return three numbers as an array."""
    return np.asarray(values, np.float64).reshape(3)
