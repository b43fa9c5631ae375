"""Shapes of a path by its length: the common face, the line and the stand still (003 "直線")."""

from typing import Protocol

import numpy as np

from limbik.core.rotation import Array


class Shape(Protocol):
    """A curve that is asked by its length x.

    Attributes:
        name: `line`, `arc`, `spline`, `corner` or `turn`.
        knots: x at the key points, first and last included, (n + 1,); n sections.
    """

    name: str
    knots: Array

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return points and unit tangents at lengths, (m, 3) each."""
        ...

    def parameter(self, x: Array) -> Array:
        """Return the sources' parameter s, 0 at the first key point, n at the last, (m,)."""
        ...

    def curvature(self, x: Array) -> Array:
        """Return curvatures [1/length], (m,)."""
        ...

    def sharpest(self) -> float:
        """Return the largest curvature anywhere [1/length]."""
        ...


def shares(knots: Array, x: Array) -> Array:
    """Return s that grows evenly with the length inside each section, (m,)."""
    section = np.searchsorted(knots[1:-1], x, side="right")
    low = knots[section]
    return np.asarray(section + (x - low) / (knots[section + 1] - low))


class Polyline:
    """Straight from point to point; with two points the line of the source.

    Args:
        points: (n + 1, 3), neighbours apart.
    """

    name = "line"

    def __init__(self, points: Array) -> None:
        ways = np.diff(points, axis=0)
        lengths = np.linalg.norm(ways, axis=1)
        self.points = points
        self.directions = ways / lengths[:, None]
        self.knots: Array = np.concatenate([[0.0], np.cumsum(lengths)])

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return points and unit tangents at lengths, (m, 3) each."""
        if len(self.directions) == 1:
            way = self.directions[0]
            return self.points[0] + x[:, None] * way, np.broadcast_to(way, (len(x), 3))
        section = np.searchsorted(self.knots[1:-1], x, side="right")
        way = self.directions[section]
        return self.points[section] + (x - self.knots[section])[:, None] * way, way

    def parameter(self, x: Array) -> Array:
        """Return s, even in length inside each section, (m,)."""
        return shares(self.knots, x)

    def curvature(self, x: Array) -> Array:
        """Return zeros, (m,)."""
        return np.zeros(len(x))

    def sharpest(self) -> float:
        """Return 0."""
        return 0.0


class Standstill:
    """No way at all: only the orientation moves, and x is the angle turned [rad] (T A10).

    Args:
        point: Where it happens, (3,).
        angle: How far the orientation turns [rad]; may be 0.
    """

    name = "turn"

    def __init__(self, point: Array, angle: float) -> None:
        self.point = point
        self.knots: Array = np.array([0.0, angle])

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return the one point and tangents of length zero, (m, 3) each."""
        return np.broadcast_to(self.point, (len(x), 3)), np.zeros((len(x), 3))

    def parameter(self, x: Array) -> Array:
        """Return s, the share of the angle, (m,)."""
        return x / (self.knots[1] or 1.0)

    def curvature(self, x: Array) -> Array:
        """Return zeros, (m,)."""
        return np.zeros(len(x))

    def sharpest(self) -> float:
        """Return 0."""
        return 0.0
