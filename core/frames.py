"""Right-handed data with Z up enters and leaves through here, and nowhere else (A-01).

A right-handed point (x, y, z) is limbik's (x, z, y): two axes change places. The swap is its own
inverse and keeps a rotation a rotation.
"""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.rotation import Array

_SWAP = (0, 2, 1)


def to_left_handed(points: ArrayLike) -> Array:
    """Return right-handed points or vectors with Z up in limbik's left-handed world with Y up.

    Args:
        points: Shape (..., 3).
    """
    return np.ascontiguousarray(np.asarray(points, np.float64)[..., _SWAP])


def to_right_handed(points: ArrayLike) -> Array:
    """Return left-handed points or vectors with Y up in the right-handed world with Z up.

    Args:
        points: Shape (..., 3).
    """
    return to_left_handed(points)


def rotation_to_left_handed(rotations: ArrayLike) -> Array:
    """Return rotations of the right-handed world with Z up in limbik's world.

    Args:
        rotations: Matrices whose columns are a frame's axes, (..., 3, 3).

    Returns:
        Matrices R' with `R' @ to_left_handed(p) == to_left_handed(R @ p)`.
    """
    matrices = np.asarray(rotations, np.float64)
    return np.ascontiguousarray(matrices[..., _SWAP, :][..., _SWAP])


def rotation_to_right_handed(rotations: ArrayLike) -> Array:
    """Return rotations of limbik's world in the right-handed world with Z up.

    Args:
        rotations: Matrices, (..., 3, 3).
    """
    return rotation_to_left_handed(rotations)
