"""Velocity overlap (OVV): how long two pieces may run at once, and what that does (003, T A35)."""

from dataclasses import dataclass

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.plugins.paths.moves import Overlap
from limbik.plugins.paths.piece import Piece

FITS = 1.0 + 1e-9
POINTS = 257  # in the window, to find the closest approach and the highest speed


@dataclass(frozen=True)
class OverlapReport:
    """What an overlap came to.

    Attributes:
        move: Number of the move before it.
        time: How long both run [s].
        ramp: The longest overlap without overrun [s].
        cut: How near the path comes to the key point [length].
        peak: Highest speed in it [length/s].
        allowed: The larger speed limit of the two moves [length/s].
    """

    move: int
    time: float
    ramp: float
    cut: float
    peak: float
    allowed: float

    @property
    def overrun(self) -> float:
        """By how much the speed exceeds the limit [length/s]; 0 if it does not."""
        return self.peak - self.allowed if self.peak > self.allowed * (1.0 + 1e-9) else 0.0


def overlap_time(before: Piece, after: Piece, wanted: Overlap, used: float = 0.0) -> float:
    """Return how long two pieces run together [s].

    Args:
        before: The piece that ends.
        after: The piece that starts.
        wanted: What the user asked for.
        used: How long the piece that ends already overlaps the one before it: overlaps of one
            move may not overlap each other (T A36).

    Raises:
        InputError: Not exactly one of time, cut and full is given, the time is longer than a
            piece, or the cut is not above 0.
    """
    if (wanted.time is not None) + (wanted.cut is not None) + bool(wanted.full) != 1:
        raise error(before, "give exactly one of time, cut and full")
    most = min(before.duration - used, after.duration)
    if wanted.time is not None:
        if not 0.0 <= wanted.time <= most * FITS:
            raise error(
                before,
                f"the overlap of {wanted.time:g} s is longer than what is left of a move: at most "
                f"{most:.6g} s fits, and {longest(before, after):.6g} s without overrun",
            )
        return min(wanted.time, most)
    full = min(longest(before, after), most)
    if wanted.cut is None:
        return full
    if not wanted.cut > 0.0:
        raise error(before, f"the cut must be above 0, not {wanted.cut:g}")
    return _time_of_cut(before, after, wanted.cut, full)


def longest(before: Piece, after: Piece) -> float:
    """Return the shorter of the braking and the starting ramp [s]: no overrun up to there."""
    starting = 0.0
    for phase in after.profile.phases:
        if phase.last_speed <= phase.speed:
            break
        starting += phase.duration
    braking = 0.0
    for phase in reversed(before.profile.phases):
        if phase.last_speed >= phase.speed:
            break
        braking += phase.duration
    return min(braking, starting)


def window(before: Piece, after: Piece, time: float) -> tuple[Array, Array]:
    """Return positions and velocities while both run, (m, 3) each."""
    t = np.linspace(0.0, time, POINTS)
    p1, v1, _, _ = before.at(t + before.duration - time)
    p2, v2, _, _ = after.at(t)
    return p1 + p2 - p2[0], v1 + v2


def _cut(before: Piece, after: Piece, time: float) -> float:
    places, _ = window(before, after, time)
    corner = after.at(np.zeros(1))[0][0]
    distances = np.linalg.norm(places - corner, axis=1)
    k = int(distances.argmin())
    if 0 < k < POINTS - 1:  # the lowest point of the parabola through the three lowest
        d0, d1, d2 = distances[k - 1 : k + 2].tolist()
        bend = d0 - 2.0 * d1 + d2
        return float(d1 - (d0 - d2) ** 2 / (8.0 * bend)) if bend > 0.0 else float(d1)
    return float(distances[k])


def _time_of_cut(before: Piece, after: Piece, cut: float, full: float) -> float:
    """Search the overlap that passes the key point at a distance; the ramps bound it."""
    if _cut(before, after, full) <= cut:
        return full
    low, high = 0.0, full
    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _cut(before, after, middle) < cut else (low, middle)
    return low


def report(before: Piece, after: Piece, time: float) -> OverlapReport:
    """Tell what an overlap comes to."""
    _, velocities = window(before, after, time)
    return OverlapReport(
        before.legs[-1].number,
        time,
        longest(before, after),
        _cut(before, after, time) if time > 0.0 else 0.0,
        float(np.linalg.norm(velocities, axis=1).max()),
        max(p.rates.speed if p.moves else 0.0 for p in (before.legs[-1], after.legs[0])),
    )


def error(before: Piece, message: str) -> InputError:
    """Make the error of the overlap after a piece."""
    number = before.legs[-1].number
    return InputError(
        Fault("overlap", message, key=f"overlap between moves {number} and {number + 1}")
    )


def overlap_samples(
    positions: Array, rotations: Array, corner: int, count: int
) -> tuple[Array, Array]:
    """Overlap two moves that are sampled already, as printed (003, T A37).

    Args:
        positions: Both moves one after the other, (m, 3).
        rotations: (m, 3, 3).
        corner: Index of the sample at the key point between them.
        count: How many samples the second move starts earlier.

    Returns:
        (m - count, 3) and (m - count, 3, 3).

    Raises:
        InputError: The overlap is longer than a move.
    """
    most = min(corner, len(positions) - 1 - corner)
    if not 0 <= count <= most:
        raise InputError(Fault("overlap", f"an overlap of {count} samples: at most {most} fit"))
    window = slice(corner - count + 1, corner + 1)
    shifted = slice(corner + 1, corner + count + 1)
    places = np.concatenate([positions[: corner - count + 1], positions[corner + 1 :]])
    turned = np.concatenate([rotations[: corner - count + 1], rotations[corner + 1 :]])
    places[window] = positions[window] + positions[shifted] - positions[corner]
    turned[window] = rotations[shifted] @ rotations[corner].T @ rotations[window]
    return places, turned
