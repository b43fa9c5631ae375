"""Rotations as arrays: heading, pitch, bank (HPB), matrices and quaternions.

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


def matrix_to_quaternion(matrices: ArrayLike) -> Array:
    """Return the unit quaternions (w, x, y, z) of rotation matrices.

    Args:
        matrices: Rotation matrices, shape (..., 3, 3).

    Returns:
        Shape (..., 4), the largest part positive.
    """
    m = np.asarray(matrices, np.float64)
    diagonal = np.diagonal(m, axis1=-2, axis2=-1)
    x, y, z = np.moveaxis(diagonal, -1, 0)
    sizes = np.stack([x + y + z, x - y - z, y - x - z, z - x - y], -1)  # 4 part² - 1
    ax, ay, az = (
        m[..., 2, 1] - m[..., 1, 2],
        m[..., 0, 2] - m[..., 2, 0],
        m[..., 1, 0] - m[..., 0, 1],
    )
    xy, xz, yz = (
        m[..., 1, 0] + m[..., 0, 1],
        m[..., 0, 2] + m[..., 2, 0],
        m[..., 2, 1] + m[..., 1, 2],
    )
    w2, x2, y2, z2 = np.moveaxis(1.0 + sizes, -1, 0)
    rows = [[w2, ax, ay, az], [ax, x2, xy, xz], [ay, xy, y2, yz], [az, xz, yz, z2]]
    table = np.stack([np.stack(row, -1) for row in rows], -2)  # 4 q qᵀ
    largest = sizes.argmax(-1)
    q = np.take_along_axis(table, largest[..., None, None], -2)[..., 0, :]
    return np.asarray(q / np.linalg.norm(q, axis=-1, keepdims=True))


def quaternion_to_matrix(quaternions: ArrayLike) -> Array:
    """Return the rotation matrices of unit quaternions.

    Args:
        quaternions: (w, x, y, z), shape (..., 4).
    """
    w, x, y, z = np.moveaxis(np.asarray(quaternions, np.float64), -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, -1) for row in rows], -2)


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
