"""How a goal is turned: heading, pitch, bank, a quaternion or a matrix become HPB angles."""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.kernels import rotation as kernels
from limbik.core.rotation import Array, matrix_to_hpb, quaternion_to_matrix

UNIT = 1e-3  # largest error of a quaternion's length that is taken for rounding of the input
SQUARE = 1e-6  # likewise of RᵀR


def quaternion_to_hpb(quaternions: ArrayLike) -> Array:
    """Return the HPB angles [rad], (..., 3), of quaternions (w, x, y, z), (..., 4); NaN stays.

    Raises:
        ValueError: The length of one is not 1.
    """
    q = np.asarray(quaternions, np.float64)
    length = np.linalg.norm(q, axis=-1)
    wrong = np.abs(length - 1.0) > UNIT
    if wrong.any():
        raise ValueError(length_fault(float(length[wrong][0])))
    return matrix_to_hpb(quaternion_to_matrix(q / length[..., None]))


def carried(axes: Array, turn: Array) -> Array:
    """Return a turn that is given in axes, as one in what the axes are given in.

    One turn, in plain numbers: numpy takes several times as long, and a body asks in every frame.

    Args:
        axes: As columns, (3, 3).
        turn: HPB, (3,) [rad]; NaNs stay.
    """
    if np.isnan(turn[0]):
        return turn
    rows = axes.tolist()
    own = kernels.hpb_to_matrix(turn.tolist())
    return np.array(kernels.matrix_to_hpb(kernels.multiply(rows, own), 0.0))


def length_fault(length: float) -> str:
    """Say that a quaternion of this length does not turn."""
    return f"a quaternion must have length 1, this one has {length:g}"


def matrix_turn(matrix: ArrayLike) -> Array:
    """Return the HPB angles [rad] of a homogeneous matrix, (4, 4).

    Raises:
        ValueError: Its last row is not 0 0 0 1, or it does not only turn.
    """
    whole = np.asarray(matrix, np.float64)
    if np.abs(whole[3] - (0.0, 0.0, 0.0, 1.0)).max() > SQUARE:
        raise ValueError("the matrix's last row must be 0 0 0 1")
    turn = whole[:3, :3]
    if np.abs(turn.T @ turn - np.eye(3)).max() > SQUARE or np.linalg.det(turn) < 0.0:
        raise ValueError(
            "the matrix's first three columns must have length 1, stand at right angles and not "
            "mirror"
        )
    return matrix_to_hpb(turn)
