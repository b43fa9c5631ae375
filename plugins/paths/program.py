"""`plan`: key points and moves become a `Trajectory`, which is asked by time (003)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.plugins.paths.corner import Corner, corner
from limbik.plugins.paths.keypoint import KeyPoint
from limbik.plugins.paths.leg import Leg, build_leg
from limbik.plugins.paths.moves import Blend, Junction, Limits, Move, Overlap, Stop
from limbik.plugins.paths.overlap import OverlapReport, overlap_time, report
from limbik.plugins.paths.piece import Piece, build_piece
from limbik.plugins.paths.quaternions import continuous, inverse, product
from limbik.plugins.paths.samples import Samples, sample_times

Order = Literal["base", "tool"]


class Stretch(NamedTuple):
    """A part of the trajectory with one limit.

    Attributes:
        start, end: Times [s].
        move: Number of the move, from 1; of a corner that before it.
        shape: `line`, `arc`, `spline`, `turn`, `corner` or `pause`.
        limit: What keeps it from being faster.
        first_speed, last_speed: Along the path [length/s], on turns [rad/s].
    """

    start: float
    end: float
    move: int
    shape: str
    limit: str
    first_speed: float
    last_speed: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A planned program.

    Attributes:
        pieces: What runs from rest to rest, in order.
        starts: When each piece starts, (k,) [s].
        order: How the rotations of an overlap are joined: increments in the `base` frame, as
            printed, or in the `tool` frame (T A34).
        key_points: All key points.
        overlaps: What each overlap came to.
        warnings: What the user should look at.
    """

    pieces: tuple[Piece, ...]
    starts: Array
    order: Order
    key_points: tuple[KeyPoint, ...]
    overlaps: tuple[OverlapReport, ...]
    warnings: tuple[str, ...]

    @property
    def duration(self) -> float:
        """Time from start to end [s]."""
        return float(self.starts[-1]) + self.pieces[-1].duration

    def at(self, times: ArrayLike) -> Samples:
        """Return poses at times.

        Args:
            times: Rising times from the start [s], (m,); outside the ends the ends hold.

        Raises:
            InputError: The times do not rise or are not finite.
        """
        t = np.ascontiguousarray(times, np.float64).reshape(-1)
        if not (np.isfinite(t).all() and (np.diff(t) >= 0.0).all()):
            raise InputError("times: must be finite and rise")
        places, velocities = np.empty((len(t), 3)), np.empty((len(t), 3))
        turned, path = np.empty((len(t), 4)), np.empty((len(t), 3))
        move = np.empty(len(t), np.int64)
        cuts = [0, *np.searchsorted(t, self.starts[1:]).tolist(), len(t)]
        for k, piece in enumerate(self.pieces):
            own = slice(cuts[k], cuts[k + 1])
            parts = piece.at(t[own] - self.starts[k])
            for whole, part in zip((places, velocities, turned, path), parts, strict=True):
                whole[own] = part
            move[own] = piece.legs[0].number
            if k and self.starts[k] < self.starts[k - 1] + self.pieces[k - 1].duration:
                self._overlap(k, t, own, (places, velocities, turned, path))
        # Beside corners a piece holds several moves; the samples carry the first one's number.
        return Samples(t, places, continuous(turned), velocities, path, move)

    def _overlap(self, k: int, t: Array, own: slice, whole: tuple[Array, ...]) -> None:
        """Add what is left of the piece before, where it still runs (T A33, A34, A36)."""
        before = self.pieces[k - 1]
        begin = float(self.starts[k - 1])
        count = int(np.searchsorted(t[own], begin + before.duration, side="right"))
        window = slice(own.start, own.start + count)
        if not count:
            return
        places, velocities, turned, path = whole
        p1, v1, q1, _ = before.at(t[window] - begin)
        zero = np.zeros(1)
        p2, _, q2, _ = (part[0] for part in self.pieces[k].at(zero))
        places[window] += p1 - p2
        velocities[window] += v1
        back = np.broadcast_to(inverse(q2), q1.shape)
        pair = (turned[window], q1) if self.order == "base" else (q1, turned[window])
        turned[window] = product(product(pair[0], back), pair[1])
        speed = np.linalg.norm(velocities[window], axis=1)
        path[window] = np.stack([path[window, 0], speed, np.full(count, np.nan)], -1)

    def sample(self, dt: float, stretch: bool = False) -> Samples:
        """Return poses at 0, dt, 2 dt, ... and at the end (T A38).

        Args:
            dt: Time between samples [s].
            stretch: Run a little slower, so that the end falls on a step and all are equal.

        Raises:
            InputError: dt is not above 0, or gives more than ten million samples.
        """
        own, shown = sample_times(self.duration, dt, stretch)
        samples = self.at(own)
        return samples if not stretch else samples.retimed(shown)

    def stretches(self) -> list[Stretch]:
        """Return what limits each part; in overlaps the parts of both moves (T A41)."""
        found = []
        for piece, start in zip(self.pieces, self.starts.tolist(), strict=True):
            t = start
            for span in piece.spans:
                for phase in span.phases:
                    first, last = phase.speed, phase.last_speed
                    tiny = 1e-12 * max(first, last)  # rounding where it stands
                    speeds = (first if first > tiny else 0.0, last if last > tiny else 0.0)
                    found.append(
                        Stretch(t, t + phase.duration, span.number, span.name, phase.limit, *speeds)
                    )
                    t += phase.duration
        return found


def plan(
    start: KeyPoint,
    steps: Sequence[Move | Junction],
    limits: Limits | None = None,
    order: Order = "base",
) -> Trajectory:
    """Plan a program.

    Args:
        start: The first key point.
        steps: Moves, with a `Stop`, `Blend` or `Overlap` between two of them or nothing, which
            is a stop.
        limits: For moves without their own.
        order: See `Trajectory`.

    Raises:
        InputError: A move or a junction is impossible; the message has the largest value that fits.
        EnvironmentProblem: scipy is not installed.
    """
    moves, junctions = _sorted(steps)
    if order not in ("base", "tool"):
        raise InputError(f"order: must be base or tool, not {order!r}")
    legs = _legs(start, moves, limits)
    pieces, joints = _pieces(legs, junctions)
    overlapping = _overlap_times(pieces, joints)
    ends = np.array([piece.duration for piece in pieces[:-1]]) - overlapping
    reports = tuple(
        report(pieces[k], pieces[k + 1], overlapping[k])
        for k, joint in enumerate(joints)
        if isinstance(joint, Overlap)
    )
    points = (start, *(point for leg in legs for point in leg.key_points[1:]))
    told = [text for leg in legs for text in leg.warnings]
    told += [_overrun(done) for done in reports if done.overrun]
    starts = np.concatenate([[0.0], np.cumsum(ends)])
    return Trajectory(tuple(pieces), starts, order, points, reports, tuple(told))


def _overlap_times(pieces: list[Piece], joints: list[Stop | Overlap]) -> list[float]:
    """How long each piece runs on beside the next; negative for pauses (T A36)."""
    times: list[float] = []
    for k, joint in enumerate(joints):
        if isinstance(joint, Overlap):
            used = max(times[-1], 0.0) if times else 0.0
            times.append(overlap_time(pieces[k], pieces[k + 1], joint, used))
        else:
            times.append(-joint.pause)
    return times


def _overrun(done: OverlapReport) -> str:
    return (
        f"overlap after move {done.move}: {done.time:g} s is longer than the ramps "
        f"({done.ramp:.4g} s); the speed reaches {done.peak:.4g}, "
        f"{done.overrun:.4g} above the limit"
    )


def _sorted(steps: Sequence[Move | Junction]) -> tuple[list[Move], list[Junction]]:
    """Split steps into moves and the junctions between them."""
    moves: list[Move] = []
    junctions: list[Junction] = []
    waiting: Junction | None = None
    for step in steps:
        if isinstance(step, Stop | Blend | Overlap):
            if waiting is not None or not moves:
                raise _error("stop, blend and overlap stand between two moves, one at a time")
            waiting = step
            continue
        if moves:
            junctions.append(waiting or Stop())
        moves.append(step)
        waiting = None
    if not moves or waiting is not None:
        raise _error("a program needs a move, and ends with one")
    for joint in junctions:
        if isinstance(joint, Stop) and not 0.0 <= joint.pause < 1e9:
            raise _error(f"a pause must be 0 s or more, not {joint.pause:g}")
    return moves, junctions


def _legs(start: KeyPoint, moves: list[Move], limits: Limits | None) -> list[Leg]:
    legs: list[Leg] = []
    for number, move in enumerate(moves, 1):
        legs.append(build_leg(number, start, move, limits))
        start = legs[-1].key_points[-1]
    return legs


def _pieces(legs: list[Leg], junctions: list[Junction]) -> tuple[list[Piece], list[Stop | Overlap]]:
    """Join legs with blends between them into pieces; give the junctions that are left."""
    pieces: list[Piece] = []
    joints: list[Stop | Overlap] = []
    group, corners = [legs[0]], list[Corner]()
    for leg, joint in zip(legs[1:], junctions, strict=True):
        if isinstance(joint, Blend):
            used = corners[-1].join if corners else 0.0
            corners.append(corner(group[-1], leg, joint, used))
            group.append(leg)
            continue
        pieces.append(build_piece(group, corners))
        joints.append(joint)
        group, corners = [leg], []
    pieces.append(build_piece(group, corners))
    return pieces, joints


def _error(message: str) -> InputError:
    return InputError(Fault("program", message))
