"""Profiles from limits: trapezoid or triangle, with or without a jerk limit, or by ramp times.

When the way is too short for the top speed, the accelerations are kept and the top is lowered
(T A6): the fastest way; `keep-times` lowers speed and accelerations together.
"""

from dataclasses import dataclass, replace
from math import inf, sqrt

from limbik.core.errors import Fault, InputError
from limbik.plugins.paths.profile import Phase, Profile

ROUNDING = 1e-12


@dataclass(frozen=True)
class Rates:
    """What a stretch may do, with the names of the limits that set each number.

    Attributes:
        speed: Top speed [length/s].
        acceleration: [length/s²].
        deceleration: [length/s²].
        jerk: [length/s³]; inf for none.
        speed_limit: `speed`, `rotation speed` or `centripetal acceleration`.
        acceleration_limit: `acceleration` or `rotation acceleration`.
    """

    speed: float
    acceleration: float
    deceleration: float
    jerk: float = inf
    speed_limit: str = "speed"
    acceleration_limit: str = "acceleration"

    def capped(self, speed: float, limit: str) -> "Rates":
        """Return the rates with at most this top speed."""
        return self if speed >= self.speed else replace(self, speed=speed, speed_limit=limit)


def ramp(start: float, end: float, rates: Rates) -> list[Phase]:
    """Return the phases from one speed to another, fastest within the rates."""
    change = abs(end - start)
    if change <= ROUNDING * max(start, end):
        return []
    up = 1.0 if end > start else -1.0
    most = rates.acceleration if up > 0.0 else rates.deceleration
    name = (
        rates.acceleration_limit
        if up > 0.0
        else rates.acceleration_limit.replace("acceleration", "deceleration")
    )
    if rates.jerk == inf:
        return [Phase(change / most, start, up * most, 0.0, name)]
    top = min(most, sqrt(change * rates.jerk))
    rise, hold = top / rates.jerk, change / top - top / rates.jerk
    jerk, middle = up * rates.jerk, up * top
    first = Phase(rise, start, 0.0, jerk, "jerk")
    flat = Phase(max(hold, 0.0), first.last_speed, middle, 0.0, name)
    return [first, flat, Phase(rise, flat.last_speed, middle, -jerk, "jerk")]


def ramp_distance(start: float, end: float, rates: Rates) -> float:
    """Return how far a ramp goes [length]."""
    return sum(phase.distance for phase in ramp(start, end, rates))


def farthest_speed(start: float, distance: float, rates: Rates, up: bool = True) -> float:
    """Return the highest speed to which a ramp from a speed fits in a distance [length/s].

    Args:
        start: Speed at the fixed end.
        distance: Room for the ramp.
        rates: Limits.
        up: True for speeding up from the fixed end, False for slowing down to it.
    """
    most = rates.acceleration if up else rates.deceleration
    if rates.jerk == inf:
        return sqrt(start * start + 2.0 * most * distance)

    def length(speed: float) -> float:
        pair = (start, speed) if up else (speed, start)
        return ramp_distance(*pair, rates)

    return _largest(length, start, sqrt(start * start + 2.0 * most * distance), distance)


def profile(distance: float, rates: Rates, start: float = 0.0, end: float = 0.0) -> Profile:
    """Make the fastest profile over a distance between two speeds.

    Args:
        distance: [length]; 0 gives an empty profile.
        rates: Limits.
        start: Speed at the beginning.
        end: Speed at the end.

    Raises:
        InputError: A boundary speed is above the top speed or cannot be reached in the distance.
    """
    _check_ends(distance, rates, start, end)
    if distance <= 0.0:
        return Profile.of([])
    top = _top(distance, rates, start, end)
    up, down = ramp(start, top, rates), ramp(top, end, rates)
    rest = distance - sum(phase.distance for phase in (*up, *down))
    cruise = []
    if rest > ROUNDING * distance:
        cruise = [Phase(rest / top, top, 0.0, 0.0, rates.speed_limit)]
    return Profile.of([*up, *cruise, *down], distance)


def _top(distance: float, rates: Rates, start: float, end: float) -> float:
    """Highest speed reached: the limit, or what the distance leaves room for."""
    a, d = rates.acceleration, rates.deceleration
    if rates.jerk == inf:
        room = (2.0 * a * d * distance + d * start**2 + a * end**2) / (a + d)
        return min(rates.speed, sqrt(room))

    def length(speed: float) -> float:
        return ramp_distance(start, speed, rates) + ramp_distance(speed, end, rates)

    return _largest(length, max(start, end), rates.speed, distance)


def _largest(length: object, low: float, high: float, room: float) -> float:
    """Largest speed in a range whose ramps, longer for higher speeds, fit in the room."""
    assert callable(length)
    if length(high) <= room:
        return high
    for _ in range(100):
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (middle, high) if length(middle) <= room else (low, middle)
    return low


def from_ramp_times(
    distance: float, speed: float, rise: float, fall: float, short: str = "keep-accelerations"
) -> Rates:
    """Return the rates that ramp times mean (T A5, A6).

    Args:
        distance: Way to go; only `keep-times` looks at it.
        speed: Top speed.
        rise: Time to speed up from rest to the top [s].
        fall: Time to slow down [s].
        short: On a way too short for the top speed `keep-accelerations` (a lower top sooner) or
            `keep-times` (a lower top after the same time).
    """
    if short == "keep-times" and distance > 0.0:
        speed = min(speed, 2.0 * distance / (rise + fall))
    return Rates(speed, speed / rise, speed / fall)


def _check_ends(distance: float, rates: Rates, start: float, end: float) -> None:
    spare = 1.0 + 1e-9
    for speed, what in ((start, "start"), (end, "end")):
        if speed > rates.speed * spare:
            raise _error(
                f"the {what} speed {speed:g} is above the top speed: at most {rates.speed:g}"
            )
    low, high, up = min(start, end), max(start, end), end > start
    if ramp_distance(start, end, rates) > distance * spare + 1e-300:
        most = farthest_speed(low, distance, rates, up)
        what, verb = ("end", "reach") if up else ("start", "slow down from")
        raise _error(
            f"a way of {distance:g} is too short to {verb} the {what} speed {high:g}: "
            f"at most {most:g} fits"
        )


def _error(message: str) -> InputError:
    return InputError(Fault("speed", message))
