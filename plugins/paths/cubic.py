"""Piecewise cubic curves: the natural spline of the source and the corner's single cubic (003)."""

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.plugins.paths.arclength import Index, LengthTable, derivative, length_table
from limbik.plugins.paths.scipy_parts import cubic_spline_class

PARAMETERS = {"uniform": 0.0, "centripetal": 0.5, "chord": 1.0}
UNEVEN = 3.0  # ratio of neighbouring chords from which a uniform parameter swings (T A15)


class Cubic:
    """A curve of cubic sections.

    Args:
        coefficients: a, b, c, d of `F = a + b r + c r² + d r³`, r in 0..1, (n, 4, 3).
        name: Name of the shape.
    """

    def __init__(self, coefficients: Array, name: str) -> None:
        self.name = name
        self.coefficients = coefficients
        self.table: LengthTable = length_table(coefficients)
        self.knots: Array = self.table.knots

    def at(self, x: Array) -> tuple[Array, Array]:
        """Return points and unit tangents at lengths, (m, 3) each."""
        section, ratio = self.table.find(x)
        a, b, c, d = np.moveaxis(self.coefficients, 1, 0)
        if len(a) > 1:
            a, b, c, d = a[section], b[section], c[section], d[section]
        r = ratio[:, None]
        slope = b + r * (2.0 * c + (3.0 * r) * d)
        sizes = np.sqrt(np.einsum("ij,ij->i", slope, slope))
        return a + r * (b + r * (c + r * d)), slope / np.maximum(sizes, 1e-300)[:, None]

    def parameter(self, x: Array) -> Array:
        """Return s = section + ratio, (m,)."""
        section, ratio = self.table.find(x)
        return np.asarray(section + ratio)

    def parameter_slope(self, x: Array) -> Array:
        """Return ds/dx [1/length], (m,)."""
        slope = derivative(self.coefficients, *self.table.find(x))
        return np.asarray(1.0 / np.maximum(np.linalg.norm(slope, axis=-1), 1e-300))

    def curvature(self, x: Array) -> Array:
        """Return curvatures [1/length], (m,)."""
        return self._bend(*self.table.find(x))

    def _bend(self, section: Index, ratio: Array) -> Array:
        slope = derivative(self.coefficients, section, ratio)
        c = self.coefficients[section]
        second = 2.0 * c[..., 2, :] + 6.0 * ratio[..., None] * c[..., 3, :]
        speed = np.maximum(np.linalg.norm(slope, axis=-1), 1e-300)
        return np.asarray(np.linalg.norm(np.cross(slope, second), axis=-1) / speed**3)

    def sharpest(self) -> float:
        """Return the largest curvature: on a grid, then on finer ones about its top."""
        n = len(self.coefficients)
        s, half = np.linspace(0.0, n, 128 * n + 1), 1.0 / 128.0
        best = 0.0
        for _ in range(6):
            section = np.minimum(s.astype(np.intp), n - 1)
            bends = self._bend(section, s - section)
            best, top = max(best, float(bends.max())), float(s[bends.argmax()])
            s = np.linspace(max(top - half, 0.0), min(top + half, float(n)), 33)
            half /= 16.0
        return best


def spline(points: Array, parameter: str = "centripetal") -> Cubic:
    """Make the natural cubic spline through three points or more (003 "スプライン曲線").

    Args:
        points: (n + 1, 3).
        parameter: How far apart the points are in the parameter: `uniform` (as printed), `chord`
            (their distance) or `centripetal` (its root) (T A15).

    Raises:
        InputError: Fewer than three points, two neighbours in one place, or another parameter.
    """
    if len(points) < 3:
        raise _error(f"a spline needs three key points or more, it has {len(points)}")
    if parameter not in PARAMETERS:
        raise _error(f"unknown parameter '{parameter}': {', '.join(PARAMETERS)}")
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if chords.min() <= 1e-12 * chords.max():
        place = int(chords.argmin())
        raise _error(
            f"key points {place} and {place + 1} of the spline are in one place "
            f"({points[place].tolist()}): leave one out"
        )
    steps = chords ** PARAMETERS[parameter]
    places = np.concatenate([[0.0], np.cumsum(steps)])
    fitted = cubic_spline_class()(places, points, bc_type="natural").c  # (4, n, 3), highest first
    scale = steps[:, None] ** np.arange(4)  # from the spline's parameter to each section's 0..1
    coefficients = fitted[::-1].transpose(1, 0, 2) * scale[..., None]
    return Cubic(np.ascontiguousarray(coefficients), "spline")


def is_uneven(points: Array) -> bool:
    """Tell whether neighbouring chords differ so much that a uniform spline swings (T A15)."""
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    ratios = chords[1:] / chords[:-1]
    return bool((np.maximum(ratios, 1.0 / ratios) > UNEVEN).any())


def hermite(start: Array, goal: Array, leave: Array, arrive: Array) -> Cubic:
    """Make the cubic with given ends and end tangents, (3,) each (003 "位置軌跡のあてはめ")."""
    way = goal - start
    coefficients = np.stack(
        [start, leave, 3.0 * way - 2.0 * leave - arrive, leave + arrive - 2.0 * way]
    )
    return Cubic(coefficients[None], "corner")


def _error(message: str) -> InputError:
    return InputError(Fault("spline", message))
