"""Rotations as arrays: heading, pitch, bank (HPB) and matrices.

Left-handed, Y up, column vectors: `p_parent = offset + R p`. The elementary rotations have
CINEMA 4D's sense, the transpose of the textbook right-hand formulas, and a joint turns by
`RY(heading) RX(pitch) RZ(bank)` (000 §4). This is the array face, plain numpy;
`limbik.core.kernels.rotation` holds the compiled scalars the solvers run on.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def hpb_to_matrix(angles: ArrayLike) -> Array:
    """Return the matrices of HPB angles.

    Args:
        angles: Heading, pitch, bank [rad], shape (..., 3).

    Returns:
        Rotation matrices, shape (..., 3, 3); the third column is the joint's Z axis.
    """
    hpb = np.asarray(angles, np.float64)
    sines, cosines = np.sin(hpb), np.cos(hpb)
    sh, sp, sb = sines[..., 0], sines[..., 1], sines[..., 2]
    ch, cp, cb = cosines[..., 0], cosines[..., 1], cosines[..., 2]
    # Filled entry by entry: for a single turn stacking takes several times as long.
    m = np.empty((*hpb.shape, 3))
    m[..., 0, 0], m[..., 0, 1], m[..., 0, 2] = (
        ch * cb - sh * sp * sb,
        ch * sb + sh * sp * cb,
        -sh * cp,
    )
    m[..., 1, 0], m[..., 1, 1], m[..., 1, 2] = -cp * sb, cp * cb, sp
    m[..., 2, 0], m[..., 2, 1], m[..., 2, 2] = (
        sh * cb + ch * sp * sb,
        sh * sb - ch * sp * cb,
        ch * cp,
    )
    return m


def matrix_to_hpb(matrices: ArrayLike) -> Array:
    """Return the HPB angles of rotation matrices.

    At a pitch of ±90° heading and bank share one axis: the bank is then 0.

    Args:
        matrices: Rotation matrices, shape (..., 3, 3).

    Returns:
        Heading, pitch, bank [rad], shape (..., 3), the form with |pitch| ≤ 90°.
    """
    m = np.asarray(matrices, np.float64)
    level = np.hypot(m[..., 0, 2], m[..., 2, 2])
    pitch = np.arctan2(m[..., 1, 2], level)
    upright = level < 1e-12
    heading = np.where(
        upright, np.arctan2(m[..., 2, 0], m[..., 0, 0]), np.arctan2(-m[..., 0, 2], m[..., 2, 2])
    )
    bank = np.where(upright, 0.0, np.arctan2(-m[..., 1, 0], m[..., 1, 1]))
    return np.stack([heading, pitch, bank], axis=-1)


def other_form(angles: ArrayLike) -> Array:
    """Return the second HPB form of the same rotations: (h + 180°, 180° - p, b + 180°).

    Args:
        angles: Heading, pitch, bank [rad], shape (..., 3).
    """
    hpb = np.asarray(angles, np.float64)
    return wrap(np.stack([hpb[..., 0] + np.pi, np.pi - hpb[..., 1], hpb[..., 2] + np.pi], axis=-1))


def wrap(angles: ArrayLike) -> Array:
    """Return angles [rad] wrapped into (-π, π], any shape."""
    turned = np.pi - np.asarray(angles, np.float64)
    return np.pi - (turned - 2.0 * np.pi * np.floor(turned / (2.0 * np.pi)))


def nearest_form(angles: ArrayLike, reference: ArrayLike) -> Array:
    """Return the form of each HPB rotation whose angles lie nearest to a reference (000 §7.6).

    Both forms are tried, each angle moved by whole turns toward the reference; the smaller sum
    of squared differences wins.

    Args:
        angles: Heading, pitch, bank [rad], shape (..., 3).
        reference: Angles to stay near [rad], shape (..., 3).
    """
    near = np.asarray(reference, np.float64)
    first = near + wrap(np.asarray(angles, np.float64) - near)
    second = near + wrap(other_form(angles) - near)
    farther = ((second - near) ** 2).sum(-1) >= ((first - near) ** 2).sum(-1)
    return np.where(farther[..., None], first, second)
