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

EXACT = 1e-11  # of the curve's length
MOST_HALVINGS = 24  # only intervals at a cusp, where the curve turns back, come this far
FIRST = 16  # intervals a section before any is halved
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


def _speeds_squared(c: Array) -> Array:
    """Coefficients of |dF/dr|² by r, lowest first, (5, n)."""
    b, c2, d3 = c[:, 1], 2.0 * c[:, 2], 3.0 * c[:, 3]
    pairs = ((b, b, 1.0), (b, c2, 2.0), (c2, c2, 1.0), (b, d3, 2.0), (c2, d3, 2.0), (d3, d3, 1.0))
    p = [factor * np.einsum("ij,ij->i", first, second) for first, second, factor in pairs]
    return np.stack([p[0], p[1], p[2] + p[3], p[4], p[5]])


def _horner(powers: Array, r: Array) -> Array:
    """Values of polynomials, lowest power first, (…)."""
    value = powers[-1]
    for power in powers[-2::-1]:
        value = value * r + power
    return np.asarray(value)


def _lengths(quartic: Array, low: Array, high: Array) -> Array:
    """Lengths of the curve between ratios, (k,), by Gauss-Legendre."""
    r = low[:, None] + (high - low)[:, None] * _NODES
    squares = _horner(quartic[:, :, None], r)
    return np.asarray((high - low) * (np.sqrt(np.maximum(squares, 0.0)) @ _WEIGHTS))


def _quintic(quartic: Array, low: Array, high: Array, length: Array) -> Array:
    """Coefficients of the ratio by the share of an interval's length, (6, k)."""
    ends = np.stack([low, high])
    squares = np.maximum(_horner(quartic, ends), 1e-300)
    slopes = _horner(quartic[1:] * np.arange(1.0, 5.0)[:, None], ends)
    d0, d1 = length / np.sqrt(squares)
    e0, e1 = -0.5 * length**2 * slopes / squares**2
    rise = high - low
    c3 = 10.0 * rise - 6.0 * d0 - 4.0 * d1 - 1.5 * e0 + 0.5 * e1
    c4 = -15.0 * rise + 8.0 * d0 + 7.0 * d1 + 1.5 * e0 - e1
    c5 = 6.0 * rise - 3.0 * (d0 + d1) - 0.5 * (e0 - e1)
    return np.stack([low, d0, e0 / 2.0, c3, c4, c5])


def _error(powers: Array, quartic: Array, middle: Array, share: Array) -> Array:
    """Error of the polynomials at the middle ratios, as a length, (k,)."""
    speeds = np.sqrt(np.maximum(_horner(quartic, middle), 0.0))
    return np.asarray(np.abs(_horner(powers, share) - middle) * speeds)


def length_table(coefficients: Array) -> LengthTable:
    """Measure a piecewise cubic curve.

    Args:
        coefficients: a, b, c, d of `F = a + b r + c r² + d r³`, r in 0..1, (n, 4, 3).
    """
    n = len(coefficients)
    quartics = _speeds_squared(coefficients)
    section = np.repeat(np.arange(n), FIRST)
    low = np.tile(np.arange(FIRST) / FIRST, n)
    high = low + 1.0 / FIRST
    one = _lengths(quartics[:, section], low, high)
    most = EXACT * float(one.sum())
    kept: list[tuple[NDArray[Any], ...]] = []
    for halving in range(MOST_HALVINGS + 1):
        own = quartics[:, section]
        middle = 0.5 * (low + high)
        left, right = _lengths(own, low, middle), _lengths(own, middle, high)
        total = left + right
        powers = _quintic(own, low, high, total)
        share = left / np.where(total > 0.0, total, 1.0)
        good = np.abs(one - total) + _error(powers, own, middle, share) <= most
        good |= halving == MOST_HALVINGS
        kept.append((section[good], low[good], total[good], powers[:, good]))
        if good.all():
            break
        bad = ~good
        section, one = np.tile(section[bad], 2), np.concatenate([left[bad], right[bad]])
        low, middle, high = low[bad], middle[bad], high[bad]
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
    return _assembled(kept, n)


def _assembled(kept: list[tuple[NDArray[Any], ...]], n: int) -> LengthTable:
    """Put intervals in order along the curve."""
    section, low, lengths, powers = (
        np.concatenate([part[k] for part in kept], axis=-1) for k in range(4)
    )
    order = np.lexsort((low, section))
    x = np.concatenate([[0.0], np.cumsum(lengths[order])])
    bounds = np.searchsorted(section[order], np.arange(n + 1))
    return LengthTable(x, section[order], powers[:, order], x[bounds])
