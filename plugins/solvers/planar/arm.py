"""`PlanarArm`: the planar chain of source 001, angles counter-clockwise from +x."""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import InputError
from limbik.core.rotation import Array
from limbik.plugins.solvers.planar import solve as kernels
from limbik.plugins.solvers.planar.layout import CCD_NEAREST, FABRIK_BOTH, METHODS, Links
from limbik.plugins.solvers.planar.pairs import MOST_DECIDED

STATUS = ("reached", "stopped", "out-of-reach")
ROBUST = {"ccd": CCD_NEAREST, "fabrik": FABRIK_BOTH}
MARGIN_STEPS = 60


@dataclass(frozen=True)
class PlanarResult:
    """Poses of a planar arm for m goals.

    Attributes:
        angles: Relative angles, (m, n) [rad].
        status: Index into `STATUS`, (m,).
        sweeps: Sweeps used, (m,).
        distance: Tip to goal [length], (m,).
    """

    angles: Array
    status: Array
    sweeps: Array
    distance: Array

    @property
    def reached(self) -> Array:
        """Whether the tip is on the goal, (m,)."""
        return np.asarray(self.status == kernels.REACHED)


@dataclass(frozen=True)
class PlanarArm:
    """Links in a plane; the first turns against the ground, each other against the one before.

    Attributes:
        lengths: (n,) [length].
        low: Lower limits of the relative angles, (n,) [rad]; -inf where free.
        high: Upper limits, (n,) [rad]; never wrapped: 135° to 225° is a range.

    Raises:
        InputError: A length is not above 0 or a minimum is above its maximum.
    """

    lengths: Array
    low: Array
    high: Array

    def __init__(
        self,
        lengths: ArrayLike,
        low: ArrayLike | None = None,
        high: ArrayLike | None = None,
    ) -> None:
        sizes = np.atleast_1d(np.ascontiguousarray(lengths, np.float64))
        ends = [
            np.ascontiguousarray(np.broadcast_to(given, sizes.shape), np.float64)
            for given in (-inf if low is None else low, inf if high is None else high)
        ]
        if sizes.ndim != 1 or len(sizes) < 2 or not (np.isfinite(sizes) & (sizes > 0.0)).all():
            raise InputError("planar arm: two or more links with lengths above 0 are needed")
        if not (ends[0] <= ends[1]).all():
            raise InputError("planar arm: a minimum is above its maximum")
        for name, value in zip(("lengths", "low", "high"), (sizes, *ends), strict=True):
            object.__setattr__(self, name, value)

    @classmethod
    def article(cls, links: int, length: float = 1.0) -> "PlanarArm":
        """Return the article's arm: first link 0° to 180° from the ground, others ±90°."""
        low, high = np.full(links, -pi / 2), np.full(links, pi / 2)
        low[0], high[0] = 0.0, pi
        return cls(np.full(links, length), low, high)

    @property
    def links(self) -> Links:
        """The chain as the kernels take it."""
        return Links(self.lengths, self.low, self.high)

    def places(self, relative: ArrayLike) -> Array:
        """Return joints and tip, (..., n + 1, 2) [length], of relative angles (..., n) [rad]."""
        angles = np.cumsum(np.asarray(relative, np.float64), axis=-1)
        steps = self.lengths[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        places = np.zeros((*angles.shape[:-1], len(self.lengths) + 1, 2))
        places[..., 1:, :] = np.cumsum(steps, axis=-2)
        return places

    def sweeps(
        self,
        method: str,
        goal: ArrayLike,
        start: ArrayLike,
        tolerance: float = 1e-3,
        most: int = 100,
    ) -> tuple[Array, int, float]:
        """Run one of `METHODS` as it is, without restarts or a finish.

        Args:
            method: Name of the method.
            goal: (2,) [length].
            start: Relative angles, (n,) [rad].
            tolerance: Distance that counts as reached [length]; below 0 all sweeps are made.
            most: Sweeps at most.

        Returns:
            Relative angles (n,) [rad], sweeps used, distance left [length].

        Raises:
            InputError: There is no such method.
        """
        if method not in METHODS:
            raise InputError(f"no sweep is called '{method}'; known: {', '.join(METHODS)}")
        pose = np.array(start, np.float64)
        x, y = np.asarray(goal, np.float64).tolist()
        number = METHODS.index(method)
        used, left = kernels.run_sweeps(number, self.links, x, y, tolerance, most, pose)
        return pose, used, left

    def solve(
        self,
        goals: ArrayLike,
        method: str = "fabrik",
        start: ArrayLike | None = None,
        tolerance: float = 1e-3,
        most: int = 100,
        follow: bool = False,
        step: float = 0.0,
        continued: bool = False,
    ) -> PlanarResult:
        """Reach goals within limits, or say that they are out of reach.

        Args:
            goals: (m, 2) [length].
            method: `ccd` or `fabrik`: which sweeps come first.
            start: Relative angles, (n,) [rad]; the middle of the ranges if absent.
            tolerance: Distance that counts as reached [length].
            most: Sweeps at most from each starting pose.
            follow: Whether the goals are a path, each solved from the pose before.
            step: Largest turn of a joint from goal to goal of a path [rad]; 0 = unbounded.
            continued: Whether the path comes from `start`, so that its first step is bounded too.

        Raises:
            InputError: The goals are not (m, 2) finite numbers.
        """
        points = np.ascontiguousarray(goals, np.float64)
        if points.ndim != 2 or points.shape[1] != 2 or not np.isfinite(points).all():
            raise InputError("goals: expected finite numbers of shape (m, 2)")
        pose = self.middle if start is None else np.ascontiguousarray(start, np.float64)
        angles, numbers = np.empty((len(points), len(self.lengths))), np.empty((len(points), 3))
        kernels.solve_goals(
            ROBUST[method],
            self.links,
            points,
            tolerance,
            most,
            step,
            follow,
            continued,
            pose,
            angles,
            numbers,
        )
        return PlanarResult(angles, numbers[:, 0].astype(np.int64), numbers[:, 1], numbers[:, 2])

    @property
    def middle(self) -> Array:
        """The middle of each range, 0 where free, (n,) [rad]."""
        free = np.isinf(self.high - self.low)
        return (np.where(free, 0.0, self.low) + np.where(free, 0.0, self.high)) / 2.0

    def is_reachable(self, goal: ArrayLike) -> bool:
        """Decide whether a goal (2,) [length] can be reached within limits.

        Raises:
            InputError: The arm has more than six links.
        """
        if len(self.lengths) > MOST_DECIDED:
            raise InputError(f"reach is decided for up to {MOST_DECIDED} links")
        x, y = np.asarray(goal, np.float64).tolist()
        return bool(kernels.is_reachable(self.links, x, y, self.middle))

    def best_margin(self, goal: ArrayLike) -> float:
        """Return the largest distance all joints can keep from their limits at a goal [rad].

        Below 0 it is by how much the limits would have to be widened; NaN if no limits would do.
        """
        width = float((self.high - self.low).min()) / 2.0
        low, high = -pi, width
        for _ in range(MARGIN_STEPS):
            middle = (low + high) / 2.0
            if PlanarArm(self.lengths, self.low + middle, self.high - middle).is_reachable(goal):
                low = middle
            else:
                high = middle
        return low if low > -pi else float("nan")
