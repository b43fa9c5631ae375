"""Forward kinematics over arrays of poses (000 §4); plain numpy, any number of leading axes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import Chain
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.solution import Stage


def forward_kinematics(chain: Chain, angles: ArrayLike) -> tuple[Array, Array]:
    """Return where angles put a chain's joints.

    World transform of joint i = parent world x frozen x HPB(angles of i).

    Args:
        chain: n joints.
        angles: HPB [rad], shape (..., n, 3).

    Returns:
        World positions (..., n, 3) [length] and world rotations (..., n, 3, 3).

    Raises:
        ValueError: The last two axes are not (n, 3).
    """
    hpb = np.asarray(angles, np.float64)
    if hpb.shape[-2:] != (len(chain), 3):
        raise ValueError(f"angles must end in shape ({len(chain)}, 3), these have {hpb.shape}")
    own = chain.frozen @ hpb_to_matrix(hpb)
    positions = np.empty(hpb.shape)
    rotations = np.empty((*hpb.shape, 3))
    turned, origin = chain.base_rotation, np.asarray(chain.base_position, np.float64)
    for joint in range(len(chain)):
        origin = origin + turned @ chain.offsets[joint]
        turned = turned @ own[..., joint, :, :]
        positions[..., joint, :] = origin
        rotations[..., joint, :, :] = turned
    return positions, rotations


def spread_poses(chain: Chain, shares: ArrayLike) -> Array:
    """Return poses at shares of every axis's range; free axes count as -180° to 180°.

    Args:
        chain: n joints.
        shares: 0 for the lower end to 1 for the upper, (..., n, 3).

    Returns:
        HPB [rad], (..., n, 3).
    """
    low, high = np.maximum(chain.low, -np.pi), np.minimum(chain.high, np.pi)
    return np.asarray(low + np.asarray(shares, np.float64) * (high - low))


def stages_of(chain: Chain, names: Sequence[str], angles: Array) -> tuple[Stage, ...]:
    """Give the poses of a trace their names and positions.

    Args:
        chain: Chain of n joints.
        names: At least one a pose.
        angles: HPB, (t, n, 3) [rad].
    """
    positions, _ = forward_kinematics(chain, angles)
    return tuple(Stage(*parts) for parts in zip(names, angles, positions, strict=False))
