"""Orientation along a move: SLERP in each section, smoothed at inner key points if asked (003)."""

from dataclasses import dataclass

import numpy as np

from limbik.core.rotation import Array
from limbik.plugins.paths.cubic import Cubic
from limbik.plugins.paths.quaternions import TINY, continuous, double_slerp, half_angle, short_way
from limbik.plugins.paths.shapes import Shape, shares

HALF_TURN = 1e-7  # [rad] from 180° down to which the way round is ambiguous (T A21)


@dataclass(frozen=True, eq=False)
class Window:
    """A stretch near an inner key point where two SLERPs are blended.

    Attributes:
        low, high: Bounds, in the variable that drives the orientation.
        start, middle, goal: Quaternions, (4,).
    """

    low: float
    high: float
    start: Array
    middle: Array
    goal: Array


class Turning:
    """The orientation of one move by its length.

    Args:
        shape: The move's shape.
        quaternions: At its key points, (n + 1, 4); with `ends` only the first and last count.
        drive: `length`, even in the length of each section, or `parameter`, the sources' s (T A23).
        ends: One way from first to last, past the middle points' orientations (T A24).
        smooth: Half window of the smoothing as a share of a section, 0 for none (T A25).
    """

    def __init__(
        self, shape: Shape, quaternions: Array, drive: str, ends: bool, smooth: float
    ) -> None:
        self.shape = shape
        chosen = quaternions[[0, -1]] if ends else quaternions
        self.knots: Array = shape.knots[[0, -1]] if ends else shape.knots
        self._by_length = drive == "length" or ends or not isinstance(shape, Cubic)
        signed = [chosen[0]]
        for q in chosen[1:]:
            signed.append(short_way(signed[-1], q))
        self.starts, self.goals = np.array(signed[:-1]), np.array(signed[1:])
        self.halves = half_angle(self.starts, self.goals)
        near = self.halves < TINY
        self._all_far = not near.any()
        self._near = near
        self._divisors = np.where(near, 1.0, np.sin(self.halves))
        self.windows = self._windows(smooth) if smooth > 0.0 and not ends else []

    @property
    def ambiguous(self) -> list[int]:
        """Sections that turn by 180°, where both ways round are equally short."""
        return np.flatnonzero(self.halves > np.pi / 2.0 - HALF_TURN).tolist()

    def drive_at(self, x: Array) -> Array:
        """Return the variable that drives the orientation: section number + share, (m,)."""
        if self._by_length:
            return shares(self.knots, x) if self.knots[-1] > 0.0 else np.zeros(len(x))
        return self.shape.parameter(x)

    def at(self, x: Array) -> Array:
        """Return unit quaternions at lengths, (m, 4)."""
        s = self.drive_at(x)
        q = self._plain(s)
        for window in self.windows:
            inside = np.flatnonzero((s > window.low) & (s < window.high))
            if len(inside):
                t = self._window_share(window, s[inside])
                q[inside] = double_slerp(t, window.start, window.middle, window.goal)
        return q

    def _plain(self, s: Array) -> Array:
        n = len(self.starts)
        if n == 1:
            half, divisor, r = self.halves[0], self._divisors[0], s
            q0, q1, near = self.starts[0], self.goals[0], self._near[0]
        else:
            section = np.minimum(s.astype(np.intp), n - 1)
            half, divisor, r = self.halves[section], self._divisors[section], s - section
            q0, q1, near = self.starts[section], self.goals[section], self._near[section]
        if self._all_far:
            first = np.sin((1.0 - r) * half) / divisor
            second = np.sin(r * half) / divisor
            return np.asarray(first[:, None] * q0 + second[:, None] * q1)
        first = np.where(near, 1.0 - r, np.sin((1.0 - r) * half) / divisor)
        second = np.where(near, r, np.sin(r * half) / divisor)
        mixed = first[:, None] * q0 + second[:, None] * q1
        return np.asarray(mixed / np.linalg.norm(mixed, axis=1, keepdims=True))

    def _window_share(self, window: Window, s: Array) -> Array:
        """Share of a window; by length if that drives, though the sections' lengths differ."""
        if not self._by_length:
            return np.asarray((s - window.low) / (window.high - window.low))
        middle = round(0.5 * (window.low + window.high))
        before = np.diff(self.knots)[middle - 1]
        after = np.diff(self.knots)[middle]
        way = np.where(s < middle, (s - middle) * before, (s - middle) * after)
        low, high = (window.low - middle) * before, (window.high - middle) * after
        return np.asarray((way - low) / (high - low))

    def _windows(self, smooth: float) -> list[Window]:
        """Windows of equal halves about the inner key points: even rates need it (T A30)."""
        lengths = np.diff(self.knots) if self._by_length else np.ones(len(self.starts))
        found = []
        for m in range(1, len(self.starts)):
            half = smooth * min(lengths[m - 1], lengths[m])
            low, high = m - half / lengths[m - 1], m + half / lengths[m]
            start, goal = self._plain(np.array([low, high]))
            found.append(Window(low, high, start, self.starts[m], goal))
        return found

    def rate(self, x: float) -> float:
        """Return how much of its section's share a unit of length turns at x [1/length]."""
        if not self._by_length and isinstance(self.shape, Cubic):
            return float(self.shape.parameter_slope(np.array([x]))[0])
        section = int(np.searchsorted(self.knots[1:-1], x, side="right"))
        return 1.0 / float(self.knots[section + 1] - self.knots[section])

    def free_length(self, first: bool) -> float:
        """Return the length of the first or last section outside the smoothing windows."""
        knots = self.shape.knots
        if not self.windows:
            return float(np.diff(knots)[0 if first else -1])
        edge = self.windows[0].low if first else self.windows[-1].high
        section = int(edge)
        share = edge - section
        if self._by_length:
            place = float(knots[section] + share * (knots[section + 1] - knots[section]))
        else:
            grid = np.linspace(knots[section], knots[section + 1], 4097)
            place = float(np.interp(edge, self.drive_at(grid), grid))
        return place if first else float(knots[-1]) - place

    def fastest(self) -> float:
        """Return the largest rotation per length [rad/length], sampled where it varies (T A41)."""
        if self._by_length and not self.windows:
            lengths = np.diff(self.knots)
            return float((2.0 * self.halves / np.where(lengths > 0.0, lengths, np.inf)).max())
        x = np.linspace(0.0, self.knots[-1], 512 * len(self.starts) + 1)
        if not self.windows and isinstance(self.shape, Cubic):
            section = np.minimum(self.drive_at(x).astype(np.intp), len(self.starts) - 1)
            return float((2.0 * self.halves[section] * self.shape.parameter_slope(x)).max())
        q = continuous(self.at(x))
        return float(2.0 * half_angle(q[:-1], q[1:]).max() / (x[1] - x[0]))
