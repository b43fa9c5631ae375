"""Corner smoothing: one cubic for the position, a double SLERP for the orientation (003).

Both use one window, from L1 before the key point to L2 after it (T A31). The cubic's tangents have
the directions of the old paths; their length is not in the source, and the curve depends on it
(T A26).
"""

from dataclasses import dataclass, replace
from math import atan2, inf, pi, tan

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.plugins.paths.cubic import Cubic, hermite
from limbik.plugins.paths.leg import Leg
from limbik.plugins.paths.moves import Blend
from limbik.plugins.paths.quaternions import double_slerp
from limbik.plugins.paths.shapes import Standstill

WIDE = 5.0 * pi / 6.0  # from this turn on `auto` takes `sum`: circle's tangents get too short
REVERSAL = 1e-4  # [rad] from a full turn back that has no smooth curve
FITS = 1.0 + 1e-9


@dataclass(frozen=True, eq=False)
class Corner:
    """The curve that replaces a key point, and where it leaves and joins the old paths.

    Attributes:
        blend: What the user asked for, `after` filled in.
        curve: The cubic.
        leave: Length along the first leg where the corner starts.
        join: Length along the second leg where it ends.
        start, middle, goal: Quaternions of the double SLERP, (4,).
        slopes: dt/du of its parameter by the share of the corner's length, at both ends.
        turn: Angle between the two tangents [rad].
    """

    blend: Blend
    curve: Cubic
    leave: float
    join: float
    start: Array
    middle: Array
    goal: Array
    slopes: tuple[float, float]
    turn: float

    @property
    def length(self) -> float:
        """Length of the curve."""
        return float(self.curve.knots[-1])

    def orientation(self, x: Array) -> Array:
        """Return quaternions at lengths along the corner, (m, 4)."""
        share = x / self.length
        t = share if self.blend.orientation == "linear" else _eased(share, *self.slopes)
        return double_slerp(t, self.start, self.middle, self.goal)

    def speed_cap(self) -> float:
        """Return the speed the centripetal limit allows, inf without one."""
        if self.blend.centripetal is None:
            return inf
        sharpest = self.curve.sharpest()
        return (self.blend.centripetal / sharpest) ** 0.5 if sharpest > 0.0 else inf


def corner(first: Leg, second: Leg, blend: Blend, used: float = 0.0) -> Corner:
    """Round the key point between two legs.

    Args:
        first: The leg before the key point.
        second: The leg after it.
        blend: What the user asked for.
        used: Length of the first leg that the corner at its start takes (T A28).

    Raises:
        InputError: A length does not fit its segment, or the path turns back on itself.
    """
    after = blend.before if blend.after is None else blend.after
    blend = replace(blend, after=after)
    _check_lengths(first, second, blend.before, after, used)
    if blend.centripetal is not None and not blend.centripetal > 0.0:
        raise _error(first, f"centripetal must be above 0, not {blend.centripetal:g}")
    leave = max(first.length - blend.before, 0.0)
    join = min(after, second.length)
    (q1,), (d1,) = first.shape.at(np.array([leave]))
    (q2,), (d2,) = second.shape.at(np.array([join]))
    turn = atan2(float(np.linalg.norm(np.cross(d1, d2))), float(d1 @ d2))
    if turn > pi - REVERSAL:
        raise _error(first, "the path turns back on itself here, no curve is smooth: use a stop")
    v1, v2 = _tangents(blend.tangent, q1, q2, blend.before, after, turn)
    curve = hermite(q1, q2, v1 * d1, v2 * d2)
    start, goal = first.turning.at(np.array([leave]))[0], second.turning.at(np.array([join]))[0]
    middle = second.turning.at(np.array([0.0]))[0]
    length = float(curve.knots[-1])
    slopes = (_slope(first, leave, length, True), _slope(second, join, length, False))
    return Corner(blend, curve, leave, join, start, middle, goal, slopes, turn)


def _tangents(
    rule: str, q1: Array, q2: Array, before: float, after: float, turn: float
) -> tuple[float, float]:
    """Return the lengths of the two tangents."""
    if rule == "auto":
        rule = "circle" if turn < WIDE else "sum"
    both = before + after
    alike = {
        "sum": both,
        "circle": both * (1.0 - tan(turn / 4.0) ** 2),
        "chord": float(np.linalg.norm(q2 - q1)),
        "unit": 1.0,
    }
    return (2.0 * before, 2.0 * after) if rule == "parabola" else (alike[rule], alike[rule])


def _slope(leg: Leg, x: float, length: float, entering: bool) -> float:
    """Slope of the double SLERP's parameter that keeps the old rotation rate (T A31)."""
    share = float(leg.turning.drive_at(np.array([x]))[0])
    rate = leg.turning.rate(x)
    rest = len(leg.turning.starts) - share if entering else share
    return length * rate / (2.0 * rest)


def _eased(u: Array, first: float, last: float) -> Array:
    """Rise from 0 to 1 with given slopes: a cubic, or a rational curve where it would turn back."""
    if first + last <= 3.0 or first**2 + first * last + last**2 <= 6.0 * (first + last) - 9.0:
        return u * (first + u * (3.0 - 2.0 * first - last + u * (first + last - 2.0)))
    return np.asarray(
        (u * u + first * u * (1.0 - u)) / (1.0 + (first + last - 2.0) * u * (1.0 - u))
    )


def _check_lengths(first: Leg, second: Leg, before: float, after: float, used: float) -> None:
    sides = (
        (first, before, "before", -1),
        (second, after, "after", 0),
    )
    for leg, length, side, section in sides:
        if isinstance(leg.shape, Standstill):
            raise _error(first, f"move {leg.number} does not move the position: use a stop")
        room = float(np.diff(leg.shape.knots)[section])
        room = min(room, leg.turning.free_length(section == 0))
        beside = ""
        if section == -1 and leg.length - used < room:
            room = leg.length - used
            beside = f" beside the {used:g} of the corner before"
        if not length > 0.0:
            raise _error(first, f"the blend's length {side} the key point must be above 0")
        if length > room * FITS:
            raise _error(
                first,
                f"the blend is longer {side} the key point than the segment: "
                f"{length:g}, at most {room:.6g} fits{beside}",
            )


def _error(first: Leg, message: str) -> InputError:
    place = f"corner between moves {first.number} and {first.number + 1}"
    return InputError(Fault("blend", message, key=place))
