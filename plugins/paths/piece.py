"""`Piece`: legs joined by corners, driven from rest to rest in one go."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from limbik.core.rotation import Array
from limbik.plugins.paths.corner import Corner
from limbik.plugins.paths.leg import Leg
from limbik.plugins.paths.profile import Phase, Profile
from limbik.plugins.paths.ramps import Rates, farthest_speed, profile

SAME_SPEED = 1.0 - 1e-12


@dataclass(frozen=True, eq=False)
class Span:
    """A stretch of a piece: a part of a leg or a corner.

    Attributes:
        low, high: Bounds along the piece [length].
        offset: What is added to a length along the piece to get one along the leg or corner.
        source: The leg or the corner.
        number: The move's number; of a corner the move before it.
        phases: How it is driven.
    """

    low: float
    high: float
    offset: float
    source: Leg | Corner
    number: int
    phases: tuple[Phase, ...]

    @property
    def name(self) -> str:
        """Name of the shape."""
        return "corner" if isinstance(self.source, Corner) else self.source.shape.name


@dataclass(frozen=True, eq=False)
class Piece:
    """What runs from rest to rest.

    Attributes:
        spans: In order.
        profile: Along all of them.
        legs: The moves it holds.
    """

    spans: tuple[Span, ...]
    profile: Profile
    legs: tuple[Leg, ...]

    @property
    def duration(self) -> float:
        """Time from rest to rest [s]."""
        return self.profile.duration

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """Return positions, velocities, quaternions and path numbers at rising times.

        Args:
            t: Times from the start, in order, (m,); the ends hold outside.

        Returns:
            (m, 3), (m, 3), (m, 4), and length, speed and acceleration along the path, (m, 3). On a
            turn in place, where no length passes, the last are 0.
        """
        x, v, a = self.profile.at(t)
        positions, velocities = np.empty((len(t), 3)), np.empty((len(t), 3))
        quaternions, path = np.empty((len(t), 4)), np.stack([x, v, a], -1)
        bounds = [0, *np.searchsorted(x, [s.high for s in self.spans[:-1]]).tolist(), len(t)]
        for span, low, high in zip(self.spans, bounds[:-1], bounds[1:], strict=True):
            if low == high:
                continue
            part = slice(low, high)
            inside = x[part] + span.offset if span.offset else x[part]
            curve = span.source.curve if isinstance(span.source, Corner) else span.source.shape
            positions[part], tangents = curve.at(inside)
            np.multiply(tangents, v[part, None], out=velocities[part])
            if isinstance(span.source, Corner):
                quaternions[part] = span.source.orientation(inside)
            else:
                quaternions[part] = span.source.turning.at(inside)
        if not self.legs[0].moves:
            path[:] = 0.0
        return positions, velocities, quaternions, path


def build_piece(legs: Sequence[Leg], corners: Sequence[Corner]) -> Piece:
    """Join legs by corners.

    Args:
        legs: One or more.
        corners: One between each two; they do not overlap.
    """
    if not corners:
        (leg,) = legs
        span = Span(0.0, leg.length, 0.0, leg, leg.number, leg.profile.phases)
        return Piece((span,), leg.profile, (leg,))
    entry, leave = _speeds(legs, corners)
    spans: list[Span] = []
    place = 0.0
    for k, leg in enumerate(legs):
        low = corners[k - 1].join if k else 0.0
        high = corners[k].leave if k < len(corners) else leg.length
        phases = _leg_phases(leg, low, high, leave[k], entry[k])
        spans.append(Span(place, place + high - low, low - place, leg, leg.number, tuple(phases)))
        place += high - low
        if k < len(corners):
            curve = corners[k]
            driven = _corner_phases(curve, entry[k], leave[k + 1], legs[k], legs[k + 1])
            end = place + curve.length
            spans.append(Span(place, end, -place, curve, leg.number, tuple(driven)))
            place = end
    whole = Profile.of([phase for span in spans for phase in span.phases], place)
    return Piece(tuple(spans), whole, tuple(legs))


def _speeds(legs: Sequence[Leg], corners: Sequence[Corner]) -> tuple[list[float], list[float]]:
    """Speeds into the corners and out of them.

    `entry[k]` is the speed at the end of leg k's own part, `leave[k]` that at its start. A forward
    and a backward pass lower them until each leg's part has room for its change of speed (T A27).
    """
    last = len(legs) - 1
    entry, leave = [0.0] * len(legs), [0.0] * len(legs)
    for k, curve in enumerate(corners):
        cap = curve.speed_cap()
        before, after = legs[k], legs[k + 1]
        if curve.blend.speed == "min":
            entry[k] = leave[k + 1] = min(before.rates.speed, after.rates.speed, cap)
        else:
            entry[k] = min(before.profile.speed_at(curve.leave), cap)
            leave[k + 1] = min(after.profile.speed_at(curve.join), cap)
    for k in range(last):
        room = _room(legs, corners, k)
        most = farthest_speed(leave[k], room, legs[k].rates) if entry[k] > leave[k] else inf
        entry[k] = min(entry[k], most)
        if corners[k].blend.speed == "min":
            leave[k + 1] = entry[k]
    for k in range(last, 0, -1):
        room = _room(legs, corners, k)
        most = farthest_speed(entry[k], room, legs[k].rates, up=False)
        leave[k] = min(leave[k], most if leave[k] > entry[k] else inf)
        if corners[k - 1].blend.speed == "min":
            entry[k - 1] = leave[k]
    return entry, leave


def _room(legs: Sequence[Leg], corners: Sequence[Corner], k: int) -> float:
    low = corners[k - 1].join if k else 0.0
    high = corners[k].leave if k < len(corners) else legs[k].length
    return max(high - low, 0.0)


def _leg_phases(leg: Leg, low: float, high: float, start: float, end: float) -> list[Phase]:
    """Drive a leg's own part: as its own profile does if that has the speeds, else anew."""
    if high - low <= 1e-12 * leg.length:
        return []
    old = leg.profile
    alike = [
        abs(old.speed_at(x) - v) <= 1e-12 * leg.rates.speed for x, v in ((low, start), (high, end))
    ]
    if all(alike):
        return old.part(low, high)
    return list(profile(high - low, leg.rates, start, end).phases)


def _corner_phases(curve: Corner, start: float, end: float, before: Leg, after: Leg) -> list[Phase]:
    """Drive a corner: the speed is linear in time from one side's to the other's (T A27)."""
    length = curve.length
    capped = max(start, end) >= SAME_SPEED * curve.speed_cap()
    limit = "centripetal acceleration" if capped else "speed beside the corner"
    if start + end > 0.0:
        time = 2.0 * length / (start + end)
        return [Phase(time, start, (end - start) / time, 0.0, limit)]
    # Both old paths are used up by their corner: it runs from rest to rest.
    sides = (before.rates, after.rates)
    rates = Rates(
        min(min(r.speed for r in sides), curve.speed_cap()),
        min(r.acceleration for r in sides),
        min(r.deceleration for r in sides),
        min(r.jerk for r in sides),
    )
    return list(profile(length, rates).phases)
