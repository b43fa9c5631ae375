"""Foot posture of the leg: yaw and tilts, the level foot, exact tilts (002; readings B-4 to B-11).

Right-handed, Z up. The level frame keeps the torso's heading; the torso stands in it at
Ry(bp) Rx(bt). The foot stands in it at Rz(r) Rx(t) Ry(p).
"""

from dataclasses import dataclass
from math import asin, atan2, cos, hypot, pi, sin

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.rotation import Array, wrap

UPRIGHT = 1e-12  # an x axis of the ankle this near to the vertical leaves j5 open


def _turn(angle: ArrayLike, first: int, second: int) -> Array:
    a = np.asarray(angle, np.float64)
    matrix = np.zeros((*a.shape, 3, 3))
    matrix[..., 3 - first - second, 3 - first - second] = 1.0
    matrix[..., first, first] = matrix[..., second, second] = np.cos(a)
    matrix[..., second, first] = np.sin(a)
    matrix[..., first, second] = -matrix[..., second, first]
    return matrix


def turn_x(angle: ArrayLike) -> Array:
    """Return right-handed rotations about x, (..., 3, 3), for angles (...) [rad]."""
    return _turn(angle, 1, 2)


def turn_y(angle: ArrayLike) -> Array:
    """Return right-handed rotations about y, (..., 3, 3), for angles (...) [rad]."""
    return _turn(angle, 2, 0)


def turn_z(angle: ArrayLike) -> Array:
    """Return right-handed rotations about z, (..., 3, 3), for angles (...) [rad]."""
    return _turn(angle, 0, 1)


def rotation(r: float, t: float, p: float) -> Array:
    """Return the foot's rotation in the level frame, Rz(r) Rx(t) Ry(p), (3, 3)."""
    return turn_z(r) @ turn_x(t) @ turn_y(p)


def foot_posture(matrix: Array) -> tuple[float, float, float]:
    """Return r, t, p [rad] of a foot's rotation in the level frame, by atan2 throughout."""
    m = matrix
    yaw = atan2(-m[0, 1], m[1, 1])
    return yaw, atan2(m[2, 1], hypot(m[0, 1], m[1, 1])), atan2(-m[2, 0], m[2, 2])


def shank_in_level(angles: ArrayLike, pitch: float, roll: float) -> Array:
    """Return the shin's rotation in the level frame, (3, 3): the source's a11 to a33.

    Args:
        angles: j1 to j4, or more, (4,) [rad].
        pitch: Torso's turn bp about y [rad].
        roll: Torso's turn bt about x [rad].
    """
    j1, j2, j3, j4 = np.asarray(angles, np.float64)[:4].tolist()
    leg = turn_y(-j1) @ turn_x(-j2) @ turn_z(-j3) @ turn_x(-j4)
    return np.asarray(turn_y(pitch) @ turn_x(roll) @ leg)


@dataclass(frozen=True)
class Ankle:
    """Ankle angles and the foot's yaw with them [rad]."""

    j5: float
    j6: float
    r: float


def level_ankle(shank: Array) -> tuple[Ankle, Ankle]:
    """Find the ankle angles of a level foot with the sole down.

    Args:
        shank: Shin in the level frame, (3, 3).

    Returns:
        The solution with |j6| ≤ 90°, and the one half a turn away.
    """
    a31, a32, a33 = shank[2].tolist()
    j5 = atan2(a32, a33) if hypot(a32, a33) > UPRIGHT else 0.0
    j6 = atan2(-a31, a32 * sin(j5) + a33 * cos(j5))
    other5, other6 = _wrapped(j5 + pi), _wrapped(pi - j6)
    return (
        Ankle(j5, j6, ankle_yaw(shank, j5)),
        Ankle(other5, other6, ankle_yaw(shank, other5)),
    )


def ankle_yaw(shank: Array, j5: float) -> float:
    """Return the foot's yaw r [rad], which j6 does not change."""
    s5, c5 = sin(j5), cos(j5)
    return atan2(-(shank[0, 1] * c5 - shank[0, 2] * s5), shank[1, 1] * c5 - shank[1, 2] * s5)


def ankle_for_tilt(shank: Array, t: float, p: float) -> tuple[Ankle, ...]:
    """Find the ankle angles that give the foot an exact tilt.

    The source's offsets from the level foot are joint angles, not tilts; they agree only where
    j5 is the level one (reading B-7).

    Args:
        shank: Shin in the level frame, (3, 3).
        t: Tilt about the foot's x, within ±90° [rad].
        p: Tilt about the foot's y [rad].

    Returns:
        Two solutions, the one nearer to level first; none if the ankle cannot tilt so far.
    """
    level = level_ankle(shank)[0]
    reach = hypot(shank[2, 1], shank[2, 2])
    if reach <= UPRIGHT or abs(sin(t)) > reach * (1.0 + UPRIGHT):
        return ()
    near = asin(max(-1.0, min(1.0, sin(t) / reach)))
    found = []
    for turn in (near, pi - near):
        j5 = _wrapped(level.j5 - turn)
        j6 = _wrapped(atan2(sin(level.j6), cos(level.j6) * cos(turn)) - p)
        found.append(Ankle(j5, j6, ankle_yaw(shank, j5)))
    return tuple(found)


def printed_offsets(angles: ArrayLike, shank: Array) -> tuple[float, float, float]:
    """Return fp, ft and r as the source prints them: offsets of j6 and j5 from level [rad]."""
    j5, j6 = np.asarray(angles, np.float64)[4:6].tolist()
    level = level_ankle(shank)[0]
    return level.j6 - j6, level.j5 - j5, level.r


def _wrapped(angle: float) -> float:
    return float(wrap(angle))
