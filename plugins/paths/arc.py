"""Arcs: through three points, about a centre, and the full circle (003 "円弧").

The angles count modulo a full turn, so that an arc of more than half a circle goes the way its
middle point asks for (T A13). The axis is a unit vector (T A11).
"""

from math import atan2, pi

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.plugins.paths.shapes import Polyline, shares

COLLINEAR = 1e-6  # sine of the angle at the middle point (T A12)
HUGE = 1000.0  # radius over chord beyond which three noisy points were probably meant as a line


class Arc:
    """A circle's arc.

    Args:
        center: (3,) [length].
        start: First point, (3,).
        axis: Unit vector; the arc goes from the start toward `axis × (start - center)`.
        angles: Angles at the key points, rising, the first one 0 [rad], (n + 1,).

    Attributes:
        center: (3,) [length].
        radius: [length].
        sweep: Angle of the whole arc [rad].
        angles: As given.
    """

    name = "arc"

    def __init__(self, center: Array, start: Array, axis: Array, angles: Array) -> None:
        self.center, self.start, self.axis, self.angles = center, start, axis, angles
        out = start - center
        self.radius = float(np.linalg.norm(out))
        self.sweep = float(angles[-1])
        self.out = out / self.radius
        self.side = np.cross(axis, self.out)
        self.knots: Array = self.radius * angles

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return points and unit tangents at lengths, (m, 3) each."""
        angle = x / self.radius
        cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
        sagitta = 2.0 * np.sin(angle / 2.0)[:, None] ** 2
        # Counted from the start, not from the centre, which may be a thousand chords away.
        places = self.start + self.radius * (sin * self.side - sagitta * self.out)
        return places, cos * self.side - sin * self.out

    def parameter(self, x: Array) -> Array:
        """Return s, even in length inside each section, (m,)."""
        return shares(self.knots, x)

    def curvature(self, x: Array) -> Array:
        """Return the one curvature, (m,)."""
        return np.full(len(x), 1.0 / self.radius)

    def sharpest(self) -> float:
        """Return the curvature."""
        return 1.0 / self.radius


def arc_through(points: Array, full: bool = False) -> Arc | Polyline:
    """Make the arc through three points; straight on when the middle one lies between the others.

    Args:
        points: (3, 3).
        full: Go on from the last point to the first: a whole circle with three sections.

    Raises:
        InputError: Two points coincide, or the three lie on a line that no arc can follow.
    """
    before, after = points[0] - points[1], points[2] - points[1]
    gaps = np.linalg.norm([before, after, points[2] - points[0]], axis=1)
    if gaps.min() <= 1e-12 * max(gaps.max(), 1e-300):
        raise _error(
            "two of the three arc points coincide: three different points are needed "
            "(for a full circle give two more points and full=True)"
        )
    normal = np.cross(after, before)  # the sense of travel: start, middle, end
    sine = float(np.linalg.norm(normal)) / (gaps[0] * gaps[1])
    if sine <= COLLINEAR:
        if before @ after < 0.0 and not full:
            return Polyline(points)
        raise _error(
            f"the three arc points lie on one line and the middle one is not between the others: "
            f"it may lie at most {gaps[2]:g} from the first point along that line, or must leave "
            f"it by more than {COLLINEAR * gaps.min():.2g}"
        )
    axis = normal / np.linalg.norm(normal)
    return _circle(points, axis, full)


def _circle(points: Array, axis: Array, full: bool) -> Arc:
    """Lay the circle; angles at the corners of the triangle are half those at the centre."""
    at_end = 2.0 * _angle(points[0] - points[2], points[1] - points[2])
    at_start = 2.0 * _angle(points[1] - points[0], points[2] - points[0])
    chord = points[1] - points[0]
    half = float(np.linalg.norm(chord)) / 2.0
    # The centre lies off the first chord's middle, to the left of the way seen along the axis.
    inward = np.cross(axis, chord / (2.0 * half))
    center = points[0] + chord / 2.0 + inward * (half / np.tan(at_end / 2.0))
    angles = [0.0, at_end, at_end + at_start]
    if full:
        angles.append(2.0 * pi)
    return Arc(center, points[0], axis, np.array(angles))


def arc_about(start: Array, center: Array, axis: Array, angle: float) -> Arc:
    """Make an arc by centre, axis and angle.

    Args:
        start: Where it begins, (3,).
        center: (3,); only its place on the axis through it counts if it is off the arc's plane.
        axis: (3,), any length.
        angle: [rad]; negative goes the other way, 2π or more are whole turns.

    Raises:
        InputError: The start lies on the axis, the axis is zero, or the angle is 0.
    """
    length = float(np.linalg.norm(axis))
    if length <= 0.0 or angle == 0.0:
        raise _error("an arc about a centre needs an axis that is not zero and an angle above 0")
    unit = axis / length * (1.0 if angle > 0.0 else -1.0)
    foot = center + unit * float((start - center) @ unit)
    if np.linalg.norm(start - foot) <= 1e-12 * max(1.0, float(np.abs(start).max())):
        raise _error("the arc starts on its own axis: the radius must be above 0")
    return Arc(foot, start, unit, np.array([0.0, abs(angle)]))


def is_huge(arc: Arc, points: Array) -> bool:
    """Tell whether three points almost on a line made a circle that was hardly meant (T A12)."""
    return arc.radius > HUGE * float(np.linalg.norm(points[2] - points[0]))


def _angle(first: Array, second: Array) -> float:
    return atan2(float(np.linalg.norm(np.cross(first, second))), float(first @ second))


def _error(message: str) -> InputError:
    return InputError(Fault("arc", message))
