"""From where a scene is seen: the plane of a flat one, the camera of any."""

from dataclasses import dataclass

import numpy as np

from limbik.core.chain import Chain
from limbik.core.pose import forward_kinematics, spread_poses
from limbik.core.rotation import Array

_FLAT = 1e-9  # thickness over length
_POSES = 16
_AWAY = np.array([-0.75, 0.35, 1.0])  # from here no two arrows of a gizmo lie on each other
_FILLED = 0.8  # of the angle of view


@dataclass(frozen=True, eq=False)
class Flat:
    """The plane a chain moves in.

    Attributes:
        origin: A point of it, world, (3,) [length].
        axes: Right, up and toward the viewer as columns, (3, 3); left-handed as the world is.
    """

    origin: Array
    axes: Array

    @classmethod
    def of(cls, chain: Chain) -> "Flat | None":
        """Find the plane of a chain; None for one that leaves every plane.

        It is tried out: the joints take poses from all over their ranges.
        """
        shares = np.random.default_rng(0).random((_POSES, len(chain), 3))
        positions, _ = forward_kinematics(chain, spread_poses(chain, shares))
        points = positions.reshape(-1, 3) - positions[0, 0]
        _, sizes, rows = np.linalg.svd(points - points.mean(0))
        if sizes[2] > _FLAT * chain.length * len(points) or sizes[1] <= _FLAT * chain.length:
            return None
        normal = rows[2]
        up = np.eye(3)[1] if abs(normal[1]) < 0.9 else np.eye(3)[2]
        up = up - normal * (normal @ up)
        up /= np.linalg.norm(up)
        right = np.cross(normal, up)  # of (x, y) -> z in numbers, which is left-handed here
        if right @ np.array([1.0, 0.1, 1.0]) < 0.0:  # x or z to the right
            normal, right = -normal, -right
        return cls(positions[0, 0], np.stack([right, up, -np.cross(right, up)], 1))

    def nearest(self, point: Array) -> Array:
        """Return the point of the plane nearest to one, (3,) [length]."""
        away = self.axes[:, 2]
        return np.asarray(point - away * (away @ (point - self.origin)))


@dataclass(frozen=True, eq=False)
class Camera:
    """Where the camera stands, world [length], and its angle of view [deg]."""

    position: Array
    look_at: Array
    field: float


def camera(points: Array, flat: Flat | None) -> Camera:
    """Return a camera that sees points, (m, 3): from the front left, or square to a plane."""
    low, high = points.min(0), points.max(0)
    middle = (low + high) / 2.0
    field = 12.0 if flat else 40.0
    away = _AWAY if flat is None else flat.axes[:, 2]
    away = away / np.linalg.norm(away)
    before = (points - middle) @ away
    aside = np.linalg.norm(points - middle - np.outer(before, away), axis=1)
    distance = (aside / np.tan(np.radians(_FILLED * field) / 2.0) + before).max()
    return Camera(middle + away * distance, middle, field)
