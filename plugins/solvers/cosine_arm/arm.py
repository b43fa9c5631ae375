"""`CosineArm`: the arm of source 004 in its own world, right-handed with Z up."""

from dataclasses import dataclass
from math import hypot

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import InputError
from limbik.core.rotation import Array

FLAGS = {
    1: "on the z axis: D1 is free and keeps its value",
    2: "arm straight",
    4: "arm folded",
}


@dataclass(frozen=True)
class ArmBranches:
    """All poses that reach a point.

    Attributes:
        status: `ok`, `too-far` or `too-near`.
        angles: D1, D2, D3, (k, 3) [rad]: front up (the source's), front down, back up, back down;
            a straight or folded arm has no second elbow; none if the point is out of reach.
        singular: What is not determined there, in words.
        distance: Shoulder to point [length].
        inner: Nearest distance in reach [length].
        outer: Farthest distance in reach [length].
        nearest: The point itself, or the nearest one in reach, (3,) [length].
    """

    status: str
    angles: Array
    singular: tuple[str, ...]
    distance: float
    inner: float
    outer: float
    nearest: Array


@dataclass(frozen=True)
class CosineArm:
    """Base yaw and two links; the source's lengths in millimetres by default (004).

    Attributes:
        shoulder: Height of the shoulder above the base [length].
        upper: Length of the upper arm [length].
        fore: Length of the forearm, to the wrist [length].

    Raises:
        InputError: A link has no length.
    """

    shoulder: float = 69.0
    upper: float = 83.0
    fore: float = 55.0

    def __post_init__(self) -> None:
        sizes = (self.shoulder, self.upper, self.fore)
        if not (np.isfinite(sizes).all() and min(self.upper, self.fore) > 0.0):
            raise InputError(f"cosine arm: upper arm and forearm need a length (found {sizes})")

    @property
    def size(self) -> tuple[float, float, float]:
        """The lengths as the kernels take them."""
        return float(self.shoulder), float(self.upper), float(self.fore)

    def forward(self, angles: ArrayLike) -> Array:
        """Return where the wrist is, (..., 3) [length], for D1, D2, D3, (..., 3) [rad]."""
        d1, d2, d3 = np.moveaxis(np.asarray(angles, np.float64), -1, 0)
        rho = self.upper * np.sin(d2) + self.fore * np.sin(d2 + d3)
        rise = self.upper * np.cos(d2) + self.fore * np.cos(d2 + d3)
        return np.stack([rho * np.cos(d1), rho * np.sin(d1), self.shoulder + rise], axis=-1)

    def branches(self, point: ArrayLike, yaw: float = 0.0) -> ArmBranches:
        """Find all poses that reach a point.

        Args:
            point: (3,) [length].
            yaw: D1 to keep where the point is above the shoulder [rad].

        Raises:
            InputError: The point is not three finite numbers.
        """
        from limbik.plugins.solvers.cosine_arm import kernels

        goal = np.asarray(point, np.float64)
        if goal.shape != (3,) or not np.isfinite(goal).all():
            raise InputError("point: expected three finite numbers")
        found = np.empty((4, 3))
        x, y, z = goal.tolist()
        state, flags = kernels.branches(self.size, (x, y, z), float(yaw), found)
        merged = flags & (kernels.STRAIGHT | kernels.FOLDED)
        kept = found[::2] if merged else found
        inner, outer = abs(self.upper - self.fore), self.upper + self.fore
        return ArmBranches(
            ("ok", "too-far", "too-near")[state],
            kept if state == kernels.OK else found[:0],
            tuple(text for flag, text in FLAGS.items() if flags & flag),
            hypot(x, y, z - self.shoulder),
            inner,
            outer,
            goal if state == kernels.OK else self.forward(found[0]),
        )
