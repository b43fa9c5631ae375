"""Between limbik's left-handed world and the right-handed one of the page, both ways.

The page mirrors x, as glTF does: x to the right of somebody who looks along z stays to the right.
Numbers shown to people are always limbik's.
"""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.frames import Y_UP
from limbik.core.rotation import Array, matrix_to_quaternion, quaternion_to_matrix


def to_page(points: ArrayLike) -> Array:
    """Return points or directions as the page has them, (..., 3); the same both ways."""
    return Y_UP.points(points)


def from_page(points: ArrayLike) -> Array:
    """Return points of the page as limbik has them, (..., 3)."""
    return Y_UP.points(points)


def turn_to_page(rotations: ArrayLike) -> Array:
    """Return rotation matrices (..., 3, 3) as the page's quaternions (w, x, y, z), (..., 4)."""
    return matrix_to_quaternion(Y_UP.rotations(rotations))


def turn_from_page(quaternions: ArrayLike) -> Array:
    """Return the page's quaternions (..., 4) as rotation matrices, (..., 3, 3)."""
    given = np.asarray(quaternions, np.float64)
    return Y_UP.rotations(
        quaternion_to_matrix(given / np.linalg.norm(given, axis=-1, keepdims=True))
    )


def frame_to_page(axes: ArrayLike) -> Array:
    """Return the quaternion of the page's frame whose axes look like given ones, (4,).

    Args:
        axes: World directions as columns, (3, 3), that are right, up and toward the viewer or the
            like: a right-handed frame to the eye.
    """
    return matrix_to_quaternion(to_page(np.asarray(axes).T).T)
