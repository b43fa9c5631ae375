"""`Leg`: a move with everything worked out: shape, orientation, rates, its own profile."""

from dataclasses import dataclass, replace
from math import inf, isfinite, pi

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array, matrix_to_quaternion
from limbik.plugins.paths.arc import Arc as ArcShape
from limbik.plugins.paths.arc import arc_about, arc_through, is_huge
from limbik.plugins.paths.cubic import is_uneven, spline
from limbik.plugins.paths.keypoint import KeyPoint
from limbik.plugins.paths.moves import Arc, ArcAbout, Limits, Move, Spline, Turn, as_vector
from limbik.plugins.paths.profile import Profile
from limbik.plugins.paths.quaternions import half_angle, product, short_way
from limbik.plugins.paths.ramps import Rates, from_ramp_times, profile
from limbik.plugins.paths.scipy_parts import rotation_class
from limbik.plugins.paths.shapes import Polyline, Shape, Standstill
from limbik.plugins.paths.turning import Turning

SAME_PLACE = 1e-12  # of the coordinates: positions this near are one


@dataclass(frozen=True, eq=False)
class Leg:
    """A move, planned from rest to rest.

    Attributes:
        number: Its place in the program, from 1.
        key_points: Those it passes, first and last included.
        shape: The way of the position.
        turning: The way of the orientation.
        rates: What it may do.
        profile: From rest to rest.
        warnings: What the user should look at.
    """

    number: int
    key_points: tuple[KeyPoint, ...]
    shape: Shape
    turning: Turning
    rates: Rates
    profile: Profile
    warnings: tuple[str, ...] = ()

    @property
    def length(self) -> float:
        """Length of the way; the angle of a turn on the spot [rad]."""
        return float(self.shape.knots[-1])

    @property
    def moves(self) -> bool:
        """Whether the position changes."""
        return not isinstance(self.shape, Standstill)


def build_leg(number: int, start: KeyPoint, move: Move, limits: Limits | None) -> Leg:
    """Work out a move.

    Args:
        number: Its place in the program, from 1, for messages.
        start: Where it begins.
        move: What the user wrote.
        limits: The program's limits, for a move without its own.

    Raises:
        InputError: The shape is impossible or a limit is missing or not positive.
    """
    own = move.limits or limits
    try:
        if own is None:
            raise _error("it needs limits: give them to the move or to the program")
        _check_limits(own)
        points, shape, warnings = _shape(start, move)
        turning = _turning(move, points, shape)
        rates = _rates(own, shape, turning)
        planned = profile(float(shape.knots[-1]), rates)
    except InputError as error:
        raise InputError(
            [replace(f, key=f"move {number}", message=_named(f)) for f in error.faults]
        ) from None
    for section in turning.ambiguous:
        warnings.append(f"section {section + 1} turns by 180°: both ways round are equally short")
    told = tuple(f"move {number} ({shape.name}): {text}" for text in warnings)
    return Leg(number, points, shape, turning, rates, planned, told)


def _named(fault: Fault) -> str:
    return f"{fault.key}: {fault.message}" if fault.key else fault.message


def _shape(start: KeyPoint, move: Move) -> tuple[tuple[KeyPoint, ...], Shape, list[str]]:
    """Return key points, shape and warnings of a move."""
    if isinstance(move, Spline):
        return _spline(start, move)
    if isinstance(move, Arc):
        places = np.array([start.position, move.via.position, move.to.position])
        arc = arc_through(places, move.full)
        points = (start, move.via, move.to, *((start,) if move.full else ()))
        huge = isinstance(arc, ArcShape) and is_huge(arc, places)
        text = "the three points lie almost on a line: the circle's radius is {:.3g}"
        return points, arc, [text.format(arc.radius)] if huge else []  # type: ignore[union-attr]
    if isinstance(move, ArcAbout):
        about = arc_about(start.position, as_vector(move.center), as_vector(move.axis), move.angle)
        return _about(start, move, about), about, []
    return (start, move.to), _straight(start, move.to, isinstance(move, Turn)), []


def _spline(start: KeyPoint, move: Spline) -> tuple[tuple[KeyPoint, ...], Shape, list[str]]:
    points = (start, *move.through)
    places = np.array([point.position for point in points])
    curve = spline(places, move.parameter)
    swings = move.parameter == "uniform" and is_uneven(places)
    text = "its key points are unevenly spaced, a uniform parameter swings: try centripetal"
    return points, curve, [text] if swings else []


def _straight(start: KeyPoint, to: KeyPoint, only_turn: bool) -> Shape:
    gap = float(np.linalg.norm(to.position - start.position))
    scale = float(max(np.abs(start.position).max(), np.abs(to.position).max()))
    if gap > SAME_PLACE * scale:
        if only_turn:
            raise _error(f"a turn stays in place, its key point is {gap:g} away: use a line")
        return Polyline(np.array([start.position, to.position]))
    angle = 2.0 * half_angle(start.quaternion, short_way(start.quaternion, to.quaternion))
    return Standstill(start.position, float(angle))


def _about(start: KeyPoint, move: ArcAbout, arc: ArcShape) -> tuple[KeyPoint, ...]:
    """End of an arc by centre and angle; the tool turns along unless told otherwise."""
    end, _ = arc.at(arc.knots[-1:])
    if move.orientation is not None:
        return start, KeyPoint(end[0], move.orientation.quaternion, move.orientation.name)
    turned = rotation_class().from_rotvec(arc.axis * arc.sweep).as_matrix()
    return start, KeyPoint(end[0], product(matrix_to_quaternion(turned), start.quaternion))


def _turning(move: Move, points: tuple[KeyPoint, ...], shape: Shape) -> Turning:
    smooth = getattr(move, "smooth", 0.0)
    if not 0.0 <= smooth <= 0.5:
        raise _error(f"orientation smoothing {smooth:g}: at most 0.5 fits, windows must not meet")
    quaternions = np.array([point.quaternion for point in points])
    if isinstance(move, ArcAbout) and move.orientation is None:
        return _carried(quaternions[0], shape)
    ends = isinstance(move, Arc) and move.orientation == "ends"
    drive = move.orientation if isinstance(move, Spline) else "length"
    return Turning(shape, quaternions, drive, ends, smooth)


def _carried(start: Array, shape: Shape) -> Turning:
    """Turn with the arc, whatever its angle: SLERP in parts of less than half a turn."""
    assert isinstance(shape, ArcShape)
    parts = int(shape.sweep // (0.75 * pi)) + 1
    shape.knots = np.linspace(0.0, shape.knots[-1], parts + 1)
    angles = np.linspace(0.0, shape.sweep, parts + 1)
    turned = rotation_class().from_rotvec(angles[:, None] * shape.axis).as_matrix()
    return Turning(shape, product(matrix_to_quaternion(turned), start), "length", False, 0.0)


def _rates(limits: Limits, shape: Shape, turning: Turning) -> Rates:
    """Put all limits of a move into rates along its way (T A41)."""
    turn, turn_up = limits.rotation_speed, limits.rotation_acceleration
    if isinstance(shape, Standstill):
        if shape.knots[-1] <= 0.0:
            return Rates(1.0, 1.0, 1.0)
        if turn is None or turn_up is None:
            raise _error(
                "a move that only turns needs limits for it: rotation_speed, rotation_acceleration"
            )
        return Rates(turn, turn_up, turn_up, inf, "rotation speed", "rotation acceleration")
    rates = _plain_rates(limits, float(shape.knots[-1]))
    if limits.centripetal is not None and (bend := shape.sharpest()) > 0.0:
        rates = rates.capped((limits.centripetal / bend) ** 0.5, "centripetal acceleration")
    if turn is None and turn_up is None:
        return rates
    most = turning.fastest()
    if turn is not None and most > 0.0:
        rates = rates.capped(turn / most, "rotation speed")
    if turn_up is not None and most * max(rates.acceleration, rates.deceleration) > turn_up:
        a, d = (min(rate, turn_up / most) for rate in (rates.acceleration, rates.deceleration))
        rates = replace(
            rates, acceleration=a, deceleration=d, acceleration_limit="rotation acceleration"
        )
    return rates


def _plain_rates(limits: Limits, length: float) -> Rates:
    if limits.ramp_times is not None:
        rates = from_ramp_times(length, limits.speed, *limits.ramp_times, limits.short)
    else:
        assert limits.acceleration is not None
        slow = limits.deceleration or limits.acceleration
        rates = Rates(limits.speed, limits.acceleration, slow)
    return replace(rates, jerk=limits.jerk or inf)


def _check_limits(limits: Limits) -> None:
    if (limits.acceleration is None) == (limits.ramp_times is None):
        raise _error("limits need either acceleration or ramp_times")
    given = {name: value for name, value in vars(limits).items() if isinstance(value, float | int)}
    for index, value in enumerate(limits.ramp_times or ()):
        given[f"ramp_times[{index}]"] = value
    for name, value in given.items():
        if not (isfinite(value) and value > 0.0):
            raise _error(f"{name} must be a finite number above 0, not {value:g}")


def _error(message: str) -> InputError:
    return InputError(Fault("move", message))
