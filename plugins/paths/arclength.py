"""Arc length of piecewise cubic curves, and back: a table that is fine where the curve is wild.

Even steps of a curve's parameter are not even in length (T A9). The table holds, for intervals of
length x, the parameter as a polynomial of degree 5 through its value and two derivatives at both
ends. Intervals are halved until that polynomial and the quadrature are right to `EXACT` of the
whole length, so that sampling needs no search.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.core.rotation import Array

Index = NDArray[np.intp]

EXACT = 2e-12  # of the curve's length
MOST_HALVINGS = 24  # only intervals at a cusp, where the curve turns back, come this far
FIRST = 8  # intervals a section before any is halved
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_NODES, _WEIGHTS = (_NODES + 1.0) / 2.0, _WEIGHTS / 2.0


@dataclass(frozen=True, eq=False)
class LengthTable:
    """Parameter by length.

    Attributes:
        x: Lengths at the interval bounds, (k + 1,).
        section: Section each interval lies in, (k,) integers.
        powers: Coefficients of the section's own parameter 0..1 by the share of the interval,
            lowest first, (6, k).
        knots: Lengths at the section bounds, (n + 1,).
    """

    x: Array
    section: Index
    powers: Array
    knots: Array

    @property
    def length(self) -> float:
        """Length of the whole curve."""
        return float(self.x[-1])

    def find(self, lengths: Array) -> tuple[Index, Array]:
        """Return section and its parameter 0..1 at lengths along the curve, (m,) each."""
        where = np.searchsorted(self.x[1:-1], lengths, side="right")
        share = (lengths - self.x[where]) / (self.x[where + 1] - self.x[where])
        c = self.powers[:, where]
        ratio = c[5]
        for power in (4, 3, 2, 1, 0):
            ratio = ratio * share + c[power]
        return self.section[where], np.clip(ratio, 0.0, 1.0)


def derivative(coefficients: Array, section: Index, ratio: Array) -> Array:
    """Return dF/dr of sections (…) at ratios (…): (…, 3)."""
    c, r = coefficients[section], ratio[..., None]
    return np.asarray(c[..., 1, :] + r * (2.0 * c[..., 2, :] + r * 3.0 * c[..., 3, :]))


def _lengths(c: Array, section: Index, low: Array, high: Array) -> Array:
    """Lengths of the curve between ratios, (k,), by Gauss-Legendre."""
    r = low[:, None] + (high - low)[:, None] * _NODES
    slopes = derivative(c, section[:, None], r)
    speeds = np.sqrt(np.einsum("ijk,ijk->ij", slopes, slopes))
    return np.asarray((high - low) * (speeds @ _WEIGHTS))


def _quintic(c: Array, section: Index, low: Array, high: Array, length: Array) -> Array:
    """Coefficients of the ratio by the share of an interval's length, (6, k)."""
    ends = np.stack([low, high])
    slope = derivative(c, np.stack([section, section]), ends)
    bend = 2.0 * c[section][None, :, 2] + 6.0 * ends[..., None] * c[section][None, :, 3]
    speed2 = np.maximum((slope * slope).sum(-1), 1e-300)
    first = length / np.sqrt(speed2)
    second = -(length**2) * (slope * bend).sum(-1) / speed2**2
    rise, (d0, d1), (e0, e1) = high - low, first, second
    c3 = 10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1
    c4 = -15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1
    c5 = 6.0 * rise - 3.0 * (d0 + d1) - 0.5 * (e0 - e1)
    return np.stack([low, d0, e0 / 2.0, c3, c4, c5])


def _is_off(powers: Array, c: Array, section: Index, ends: tuple[Array, Array, Array]) -> Array:
    """Error of the polynomials at the middle ratios, as a length, (k,)."""
    first_half, middle, total = ends
    share = first_half / np.where(total > 0.0, total, 1.0)
    guess = powers[5]
    for power in (4, 3, 2, 1, 0):
        guess = guess * share + powers[power]
    speed = np.linalg.norm(derivative(c, section, middle), axis=-1)
    return np.asarray(np.abs(guess - middle) * speed)


def length_table(coefficients: Array) -> LengthTable:
    """Measure a piecewise cubic curve.

    Args:
        coefficients: a, b, c, d of `F = a + b r + c r² + d r³`, r in 0..1, (n, 4, 3).
    """
    n = len(coefficients)
    section = np.repeat(np.arange(n), FIRST)
    low = np.tile(np.arange(FIRST) / FIRST, n)
    high = low + 1.0 / FIRST
    whole = float(_lengths(coefficients, section, low, high).sum())
    kept: list[tuple[NDArray[Any], ...]] = []
    for halving in range(MOST_HALVINGS + 1):
        middle = 0.5 * (low + high)
        one = _lengths(coefficients, section, low, high)
        left = _lengths(coefficients, section, low, middle)
        right = _lengths(coefficients, section, middle, high)
        total = left + right
        powers = _quintic(coefficients, section, low, high, total)
        off = np.abs(one - total) + _is_off(powers, coefficients, section, (left, middle, total))
        good = (off <= EXACT * whole) | (halving == MOST_HALVINGS)
        kept.append((section[good], low[good], total[good], powers[:, good]))
        if good.all():
            break
        again, at, to, cut = section[~good], low[~good], high[~good], middle[~good]
        section, low, high = np.r_[again, again], np.r_[at, cut], np.r_[cut, to]
    parts = [np.concatenate([part[k] for part in kept], axis=-1) for k in range(4)]
    order = np.lexsort((parts[1], parts[0]))
    section, lengths = parts[0][order], parts[2][order]
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    bounds = np.searchsorted(section, np.arange(n + 1))
    return LengthTable(x, section, parts[3][:, order], x[bounds])
