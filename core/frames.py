"""Between limbik's axes and those of other programs: the one module that knows both (A-01).

limbik is left-handed with Y up, and its elementary rotations are the transposes of the textbook
formulas. Everybody else here is right-handed: robots with Z up, motion clips and glTF with Y up.
A swap or a change of sign of one axis goes either way, since doing it twice gives the bits back.
It turns the right-handed rotation by an angle about an axis into limbik's rotation by the same
number about the axis swapped likewise, so hinge angles and their ranges pass unchanged.

| axes   | (x, y, z) becomes | used by |
|--------|-------------------|---------|
| `Z_UP` | (x, z, y)         | URDF, ROS: x forward, y left, z up |
| `Y_UP` | (-x, y, z)        | BVH, glTF: x left, y up, z forward; forward stays forward |
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.rotation import Array, hpb_to_matrix


@dataclass(frozen=True)
class Axes:
    """Right-handed axes, as a swap or mirror of limbik's.

    Attributes:
        name: Name for messages.
        order: Which component of a point stands first, second, third after the change.
        signs: What the components are multiplied by after that.
    """

    name: str
    order: tuple[int, int, int]
    signs: tuple[float, float, float]

    def points(self, points: ArrayLike) -> Array:
        """Change points, directions or hinge axes, (..., 3); the same both ways."""
        given = np.asarray(points, np.float64)
        return np.ascontiguousarray(given[..., self.order] * np.array(self.signs) + 0.0)

    def rotations(self, matrices: ArrayLike) -> Array:
        """Change rotation matrices, (..., 3, 3); the same both ways."""
        given = np.asarray(matrices, np.float64)
        swapped = given[..., self.order, :][..., self.order]
        return np.ascontiguousarray(swapped * np.outer(self.signs, self.signs) + 0.0)


Z_UP: Final = Axes("right-handed, Z up", (0, 2, 1), (1.0, 1.0, 1.0))
Y_UP: Final = Axes("right-handed, Y up", (0, 1, 2), (-1.0, 1.0, 1.0))
BY_NAME: Final = {"y-up": Y_UP, "z-up": Z_UP}
"""Axes other than limbik's, by the names scenes give them."""


def turn_about(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Return right-handed rotations about an axis, the textbook formula.

    Args:
        axis: Unit vector, (3,).
        angle: [rad], any shape (...).

    Returns:
        Matrices (..., 3, 3).
    """
    x, y, z = np.asarray(axis, np.float64)
    turned = np.asarray(angle, np.float64)[..., None, None]
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    half = np.sin(0.5 * turned)
    return np.asarray(np.eye(3) + np.sin(turned) * cross + 2.0 * half * half * (cross @ cross))


def rpy_to_matrix(angles: ArrayLike) -> Array:
    """Return right-handed rotations by roll, pitch, yaw about the fixed X, Y, Z [rad], (..., 3).

    That is URDF's `rpy`: RZ(yaw) RY(pitch) RX(roll).
    """
    rpy = np.asarray(angles, np.float64)
    roll, pitch, yaw = (turn_about(np.eye(3)[k], rpy[..., k]) for k in range(3))
    return np.asarray(yaw @ pitch @ roll)


def mirror_hpb(angles: ArrayLike) -> Array:
    """Return the HPB angles of the pose mirrored left to right, (..., 3) (M-14).

    Heading and bank change their sign; so they do in the forms limbik gives pitch ±90°.
    """
    return np.asarray(angles, np.float64) * (-1.0, 1.0, -1.0) + 0.0


def hpb_of(matrix: ArrayLike) -> Array:
    """Return HPB angles that give one rotation matrix back to the last bits, (3,) [rad].

    Unlike `rotation.matrix_to_hpb` the angles are taken off one by one, each from what the ones
    before leave over. Near a pitch of ±90°, where heading and bank are ill defined, the errors of
    one then cancel in the next.
    """
    left = np.asarray(matrix, np.float64)
    heading = np.arctan2(-left[0, 2], left[2, 2]) if np.hypot(left[0, 2], left[2, 2]) else 0.0
    left = hpb_to_matrix([heading, 0.0, 0.0]).T @ left
    pitch = np.arctan2(left[1, 2], left[2, 2])
    left = hpb_to_matrix([0.0, pitch, 0.0]).T @ left
    return np.array([heading, pitch, np.arctan2(left[0, 1], left[0, 0])]) + 0.0
