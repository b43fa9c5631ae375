"""Shapes the page draws many times: a bone, a ball; and how to lay them between joints."""

from functools import cache
from typing import Final

import numpy as np

from limbik.core.rotation import Array

_SIDES: Final = 10
_SHOULDER: Final = 0.12  # where a bone is thickest, of its length
_THIN: Final = 0.45  # its far end, of its thickest
_OPPOSITE: Final = 1e-100  # sine of an angle that is half a turn about any axis


@cache
def bone() -> tuple[Array, Array]:
    """Return vertices and faces of a bone from the origin to (0, 0, 1), 1 thick."""
    around = np.linspace(0.0, 2.0 * np.pi, _SIDES, endpoint=False)
    ring = np.stack([np.cos(around), np.sin(around), np.zeros(_SIDES)], 1) / 2.0
    up = np.array([0.0, 0.0, 1.0])
    vertices = np.concatenate(
        [[0.0 * up], ring + _SHOULDER * up, _THIN * ring + (1.0 - _SHOULDER / 2.0) * up, [up]]
    )
    faces = []
    for k in range(_SIDES):
        a, b = 1 + k, 1 + (k + 1) % _SIDES
        c, d, top = a + _SIDES, b + _SIDES, 2 * _SIDES + 1
        faces += [(0, b, a), (a, b, d), (a, d, c), (c, d, top)]
    return vertices, np.array(faces)


@cache
def ball() -> tuple[Array, Array]:
    """Return vertices and faces of a ball of diameter 1 about the origin."""
    rows, columns = 8, 14
    tilt = np.linspace(0.0, np.pi, rows + 1)[:, None]
    around = np.linspace(0.0, 2.0 * np.pi, columns, endpoint=False)
    points = [np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around)]
    points.append(np.broadcast_to(np.cos(tilt), points[0].shape))
    faces = []
    for row in range(rows):
        for column in range(columns):
            a, b = row * columns + column, row * columns + (column + 1) % columns
            faces += [(a, a + columns, b), (b, a + columns, b + columns)]
    return np.stack(points, -1).reshape(-1, 3) / 2.0, np.array(faces)


def cone(half_angle: float, sides: int = 36) -> tuple[Array, Array]:
    """Return vertices and faces of an open cone with its tip in the origin, along +z, 1 long.

    Args:
        half_angle: From the axis to the rim [rad].
        sides: Number of facets.
    """
    around = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    s, c = np.sin(half_angle), np.cos(half_angle)
    rim = np.stack([s * np.cos(around), s * np.sin(around), np.full(sides, c)], 1)
    faces = [(0, 1 + k, 1 + (k + 1) % sides) for k in range(sides)]
    return np.concatenate([np.zeros((1, 3)), rim]), np.array(faces)


def along(directions: Array) -> Array:
    """Return quaternions (w, x, y, z) that turn +z the shortest way to directions, (m, 4).

    Args:
        directions: (m, 3), of any length; those without length turn nothing.
    """
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    unit = np.where(length > 0.0, directions / np.where(length > 0.0, length, 1.0), (0.0, 0.0, 1.0))
    x, y, z = unit.T
    near = np.where(z < 0.0, (x * x + y * y) / (1.0 + np.abs(z)), 1.0 + z)
    turned = np.stack([near, -y, x, np.zeros(len(unit))], 1)
    turned[np.abs(turned).max(1) < _OPPOSITE] = (0.0, 1.0, 0.0, 0.0)
    return np.asarray(turned / np.linalg.norm(turned, axis=1, keepdims=True))


def segments(points: Array) -> Array:
    """Return the segments of a line through points, (..., m, 3), as (k, 2, 3)."""
    pairs = np.stack([points[..., :-1, :], points[..., 1:, :]], -2)
    return pairs.reshape(-1, 2, 3)
