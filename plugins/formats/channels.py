"""Rotation channels: three angles in any order of axes, and back; right-handed textbook turns."""

from collections.abc import Sequence

import numpy as np

from limbik.core.frames import turn_about
from limbik.core.rotation import Array, wrap

_EVEN = {(0, 1, 2), (1, 2, 0), (2, 0, 1)}


def channels_to_matrix(angles: Array, order: Sequence[int]) -> Array:
    """Return the product of turns about the axes in order.

    Args:
        angles: One a turn [rad], (..., k).
        order: k axes, 0 to 2.

    Returns:
        Matrices (..., 3, 3).
    """
    turned = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3))
    for place, axis in enumerate(order):
        turned = turned @ turn_about(np.eye(3)[axis], angles[..., place])
    return np.asarray(turned)


def matrix_to_channels(matrices: Array, order: tuple[int, int, int]) -> Array:
    """Return the angles of rotations, frame after frame near the ones before.

    The angles are taken off one by one, so that their product gives the matrix back to the last
    bits even where two axes meet.

    Args:
        matrices: (m, 3, 3).
        order: Three different axes.

    Returns:
        Angles [rad], (m, 3).
    """
    i, j, k = order
    sign = 1.0 if order in _EVEN else -1.0
    first = np.arctan2(-sign * matrices[:, j, k], matrices[:, k, k])
    left = turn_about(np.eye(3)[i], -first) @ matrices
    second = np.arctan2(sign * left[:, i, k], left[:, k, k])
    left = turn_about(np.eye(3)[j], -second) @ left
    third = np.arctan2(-sign * left[:, i, j], left[:, i, i])
    return _steady(np.stack([first, second, third], axis=-1))


def _steady(angles: Array) -> Array:
    """Choose each frame's form of three angles, and whole turns, nearest to the frame before."""
    flipped = np.stack([angles[:, 0] + np.pi, np.pi - angles[:, 1], angles[:, 2] + np.pi], axis=-1)
    steady = np.empty_like(angles)
    before = np.zeros(3)
    for frame in range(len(angles)):
        forms = [before + wrap(form[frame] - before) for form in (angles, flipped)]
        sizes = [float(np.abs(form - before).sum()) for form in forms]
        before = steady[frame] = forms[0] if sizes[0] <= sizes[1] else forms[1]
    return steady
