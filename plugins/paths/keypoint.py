"""`KeyPoint`: a pose a trajectory passes, from whatever a user has (003 "区間設定")."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import Chain
from limbik.core.errors import Fault, InputError
from limbik.core.frames import Z_UP
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_quaternion, quaternion_to_matrix
from limbik.plugins.paths.scipy_parts import rotation_class

SQUARE = 1e-6  # largest error of RᵀR that is taken for rounding of the input (T A2)


@dataclass(frozen=True, eq=False)
class KeyPoint:
    """A position and an orientation of the chain's end.

    Attributes:
        position: In the world, (3,) [length].
        quaternion: Orientation in the world, unit, (w, x, y, z), (4,).
        name: For messages; may be empty.
        angles: The joint angles it was made of, HPB, (n, 3) [rad]; None if of none.
    """

    position: Array
    quaternion: Array
    name: str = ""
    angles: Array | None = None

    @classmethod
    def from_matrix(cls, matrix: ArrayLike, name: str = "") -> "KeyPoint":
        """Make a key point of a homogeneous matrix, (4, 4).

        Raises:
            InputError: The rotation part is not a right-angled frame of determinant +1, the last
                row is not 0 0 0 1, or something is not finite (T A2).
        """
        m = _array(matrix, (4, 4), "matrix", name)
        if np.abs(m[3] - (0.0, 0.0, 0.0, 1.0)).max() > SQUARE:
            raise _error(f"the matrix's last row must be 0 0 0 1, not {m[3].tolist()}", name)
        return cls(m[:3, 3].copy(), matrix_to_quaternion(_rotation(m[:3, :3], name)), name)

    @classmethod
    def from_rotation(cls, position: ArrayLike, rotation: ArrayLike, name: str = "") -> "KeyPoint":
        """Make a key point of a position (3,) and a rotation matrix (3, 3); errors as above."""
        turned = _rotation(_array(rotation, (3, 3), "rotation", name), name)
        return cls(_array(position, (3,), "position", name), matrix_to_quaternion(turned), name)

    @classmethod
    def from_quaternion(
        cls, position: ArrayLike, quaternion: ArrayLike, name: str = ""
    ) -> "KeyPoint":
        """Make a key point of a position (3,) and a quaternion (w, x, y, z).

        Raises:
            InputError: The quaternion's length is not 1 within 1e-3, or something is not finite.
        """
        q = _array(quaternion, (4,), "quaternion", name)
        length = float(np.linalg.norm(q))
        if abs(length - 1.0) > 1e-3:
            raise _error(f"a quaternion must have length 1, this one has {length:g}", name)
        return cls(_array(position, (3,), "position", name), q / length, name)

    @classmethod
    def from_euler(
        cls, position: ArrayLike, angles: ArrayLike, convention: str = "ZYX", name: str = ""
    ) -> "KeyPoint":
        """Make a key point of a position and three angles [rad] in a named convention.

        Args:
            position: (3,) [length].
            angles: In the order of the convention's letters, (3,) [rad].
            convention: `hpb`, limbik's own heading, pitch, bank; or three axis letters as scipy
                reads them: upper case about the turned axes (`ZYX` = yaw, pitch, roll), lower case
                about the fixed ones; textbook sense (T A3).
            name: For messages.

        Raises:
            InputError: The convention is unknown or something is not finite.
        """
        turn = _array(angles, (3,), "angles", name)
        place = _array(position, (3,), "position", name)
        return cls(place, matrix_to_quaternion(euler_matrix(turn, convention, name)), name)

    @classmethod
    def from_joints(cls, chain: Chain, angles: ArrayLike, name: str = "") -> "KeyPoint":
        """Make a key point of the pose a chain's end has at joint angles HPB [rad], (n, 3)."""
        pose = _array(angles, (len(chain), 3), "joint angles", name)
        positions, rotations = forward_kinematics(chain, pose)
        return cls(positions[-1].copy(), matrix_to_quaternion(rotations[-1]), name, pose)

    @property
    def rotation(self) -> Array:
        """Orientation as a matrix, (3, 3)."""
        return quaternion_to_matrix(self.quaternion)

    @property
    def matrix(self) -> Array:
        """The pose as a homogeneous matrix, (4, 4)."""
        whole = np.eye(4)
        whole[:3, :3], whole[:3, 3] = self.rotation, self.position
        return whole

    def to_left_handed(self) -> "KeyPoint":
        """Return a key point given in the right-handed world with Z up in limbik's world."""
        turned = matrix_to_quaternion(Z_UP.rotations(self.rotation))
        return KeyPoint(Z_UP.points(self.position), turned, self.name)


def euler_matrix(angles: Array, convention: str, name: str = "") -> Array:
    """Return the matrix of three angles [rad]; see `KeyPoint.from_euler`.

    Raises:
        InputError: The convention is unknown.
    """
    if convention == "hpb":
        return hpb_to_matrix(angles)
    letters = convention.lower()
    known = (
        len(letters) == 3
        and set(letters) <= set("xyz")
        and convention
        in (
            letters,
            letters.upper(),
        )
    )
    if not known or letters[0] == letters[1] or letters[1] == letters[2]:
        raise _error(
            f"unknown Euler convention '{convention}': hpb, or three letters of XYZ (turned axes) "
            "or xyz (fixed axes), no two neighbours equal",
            name,
        )
    return np.asarray(rotation_class().from_euler(convention, angles).as_matrix())


def _array(values: ArrayLike, shape: tuple[int, ...], what: str, name: str) -> Array:
    try:
        array = np.array(values, np.float64)
    except (TypeError, ValueError):
        raise _error(f"{what}: expected numbers of shape {shape}", name) from None
    if array.shape != shape:
        raise _error(f"{what}: expected shape {shape}, found {array.shape}", name)
    if not np.isfinite(array).all():
        raise _error(f"{what}: every number must be finite", name)
    return array


def _rotation(matrix: Array, name: str) -> Array:
    skew = float(np.abs(matrix.T @ matrix - np.eye(3)).max())
    if skew > SQUARE:
        raise _error(
            "the rotation's columns must have length 1 and stand at right angles: "
            f"RᵀR is off by {skew:.2g}, at most {SQUARE:g}",
            name,
        )
    if np.linalg.det(matrix) < 0.0:
        raise _error("the rotation mirrors: its determinant is -1, it must be +1", name)
    return matrix


def _error(message: str, name: str) -> InputError:
    return InputError(Fault("key-point", message, key=name))
