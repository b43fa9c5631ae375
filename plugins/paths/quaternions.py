"""Unit quaternions (w, x, y, z) as arrays: products, SLERP, and series without sign jumps (003).

A quaternion and its negative are one rotation. The angle between two is taken by atan2 of the
lengths of difference and sum, which is exact for equal, nearly equal and opposite ones (T A20).
"""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.rotation import Array

TINY = 1e-6  # [rad]; below it the weights of SLERP are those of a straight line, to rounding
EITHER_WAY = (
    -1e-9
)  # products down to here count as a right angle: both ways round are equal (T A21)


def product(first: ArrayLike, second: ArrayLike) -> Array:
    """Return `first ⊗ second`: the matrix product of the two rotations, (..., 4)."""
    a, b, c, d = np.moveaxis(np.asarray(first, np.float64), -1, 0)
    e, f, g, h = np.moveaxis(np.asarray(second, np.float64), -1, 0)
    parts = (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )
    return np.stack(parts, -1)


def inverse(quaternion: ArrayLike) -> Array:
    """Return the opposite rotations of unit quaternions, (..., 4)."""
    return np.asarray(quaternion, np.float64) * (1.0, -1.0, -1.0, -1.0)


def short_way(start: ArrayLike, goal: ArrayLike) -> Array:
    """Return the goals with the sign that makes the way from the starts the short one (T A22)."""
    q0, q1 = np.asarray(start, np.float64), np.asarray(goal, np.float64)
    away = (q0 * q1).sum(-1, keepdims=True) < EITHER_WAY
    return np.where(away, -q1, q1)


def half_angle(start: ArrayLike, goal: ArrayLike) -> Array:
    """Return half the rotation angle between quaternions of matching sign [rad], (...)."""
    q0, q1 = np.asarray(start, np.float64), np.asarray(goal, np.float64)
    return np.asarray(
        2.0 * np.arctan2(np.linalg.norm(q1 - q0, axis=-1), np.linalg.norm(q1 + q0, axis=-1))
    )


def slerp(ratio: ArrayLike, start: ArrayLike, goal: ArrayLike) -> Array:
    """Return rotations on the short way from one to another, at a share of its angle.

    Args:
        ratio: Shares 0..1, (...).
        start: (..., 4).
        goal: (..., 4); its sign does not matter.

    Returns:
        Unit quaternions, (..., 4), in the hemisphere of the start.
    """
    r, q0 = np.asarray(ratio, np.float64), np.asarray(start, np.float64)
    q1 = short_way(q0, goal)
    angle = half_angle(q0, q1)
    near = angle < TINY
    divisor = np.where(near, 1.0, np.sin(angle))
    first = np.where(near, 1.0 - r, np.sin((1.0 - r) * angle) / divisor)
    second = np.where(near, r, np.sin(r * angle) / divisor)
    mixed = first[..., None] * q0 + second[..., None] * q1
    # Rounding inside the sines is far below what a later product notices, except for near angles.
    return mixed if not near.any() else mixed / np.linalg.norm(mixed, axis=-1, keepdims=True)


def double_slerp(ratio: ArrayLike, start: Array, middle: Array, goal: Array) -> Array:
    """Return a smooth way past a middle rotation: SLERP between two SLERPs (003 "姿勢のあてはめ").

    Args:
        ratio: Shares 0..1, (m,).
        start: Where the window begins, (4,).
        middle: The key point's rotation, passed near by, (4,).
        goal: Where the window ends, (4,).
    """
    t = np.asarray(ratio, np.float64)
    return slerp(t, slerp(t, start, middle), slerp(t, middle, goal))


def continuous(quaternions: ArrayLike, first: ArrayLike | None = None) -> Array:
    """Return a series whose quaternions each lie in the hemisphere of the one before (T A18).

    Args:
        quaternions: (m, 4).
        first: A quaternion before the series, or None.
    """
    q = np.array(quaternions, np.float64)
    if not len(q):
        return q
    flips = np.where(np.einsum("ij,ij->i", q[1:], q[:-1]) < 0.0, -1.0, 1.0)
    sign = 1.0 if first is None or float(q[0] @ np.asarray(first)) >= 0.0 else -1.0
    if sign > 0.0 and (flips > 0.0).all():
        return q
    return np.asarray(q * np.concatenate([[sign], sign * np.cumprod(flips)])[:, None])
