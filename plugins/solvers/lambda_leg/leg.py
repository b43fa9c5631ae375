"""`LambdaLeg`: the right leg of source 002 in its own world, right-handed with Z up."""

from dataclasses import dataclass, field
from math import inf

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import InputError
from limbik.core.rotation import Array
from limbik.plugins.solvers.lambda_leg import kernels
from limbik.plugins.solvers.lambda_leg.posture import rotation, turn_x, turn_y, turn_z

STATUS = ("ok", "too-far", "too-near", "beyond-limits")
FLAGS = {
    kernels.HIP_GIMBAL: "hip gimbal: thigh level, only j1 and j3 together are fixed",
    kernels.KNEE_STRAIGHT: "knee straight",
    kernels.KNEE_FOLDED: "knee folded",
    kernels.ON_ANKLE_AXIS: "hip on the axis of j6: j6 is free and keeps its value",
}
MIRROR = np.array([-1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
LOW = np.radians([-180.0, -180.0, -180.0, 0.0, -180.0, -180.0])
HIGH = np.full(6, np.pi)


def flag_words(flags: int) -> tuple[str, ...]:
    """Say what a pose leaves undetermined."""
    return tuple(words for flag, words in FLAGS.items() if flags & flag)


@dataclass(frozen=True)
class LegBranches:
    """All joint angles that make a pose.

    Attributes:
        status: `ok`, `too-far` or `too-near`.
        angles: j1 to j6, (k, 6) [rad]; 8 unless some fall together, none if out of reach.
        singular: For each what it leaves undetermined, in words.
    """

    status: str
    angles: Array
    singular: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class LegSolution:
    """The joint angles chosen for a pose.

    Attributes:
        angles: j1 to j6, (6,) [rad], within the limits.
        status: `ok`, `too-far`, `too-near` or `beyond-limits`.
        flags: What is not determined there, as a sum of numbers; `singular` has the words.
    """

    angles: Array
    status: str
    flags: int

    @property
    def singular(self) -> tuple[str, ...]:
        """What is not determined there, in words."""
        return flag_words(self.flags)


@dataclass(frozen=True)
class LambdaLeg:
    """Hip (j1 about y, j2 about x, j3 about z), knee (j4), ankle (j5 about x, j6 about y).

    x points right, y forward, z up; the hip is the origin. Positive j4 bends the knee the human
    way, so the default limits keep the knee forward. The left leg is this one mirrored:
    `MIRROR` times its angles, x with the other sign.

    Attributes:
        thigh: l1 [length].
        shin: l2 [length].
        low: Lower limits of j1 to j6, (6,) [rad]; -inf where free.
        high: Upper limits, (6,) [rad].

    Raises:
        InputError: A link has no length, or a minimum is above its maximum.
    """

    thigh: float
    shin: float
    low: Array = field(default_factory=LOW.copy)
    high: Array = field(default_factory=HIGH.copy)

    def __post_init__(self) -> None:
        if not (0.0 < self.thigh < inf and 0.0 < self.shin < inf):
            found = f"{self.thigh:g} and {self.shin:g}"
            raise InputError(f"lambda leg: thigh and shin need lengths above 0 (found {found})")
        for name in ("low", "high"):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), np.float64))
        if self.low.shape != (6,) or self.high.shape != (6,) or (self.low > self.high).any():
            raise InputError("lambda leg: limits are six minima, none above its maximum")
        object.__setattr__(self, "thigh", float(self.thigh))
        object.__setattr__(self, "shin", float(self.shin))

    def forward(self, angles: ArrayLike) -> tuple[Array, Array, Array]:
        """Return knee (3,), ankle (3,) [length] and foot rotation (3, 3), torso's frame.

        Args:
            angles: j1 to j6, (6,) [rad], or (..., 6) for many.
        """
        j = np.asarray(angles, np.float64)
        hip = turn_y(-j[..., 0]) @ turn_x(-j[..., 1]) @ turn_z(-j[..., 2])
        shank = hip @ turn_x(-j[..., 3])
        knee = -self.thigh * hip[..., :, 2]
        ankle = knee - self.shin * shank[..., :, 2]
        return knee, ankle, shank @ turn_x(-j[..., 4]) @ turn_y(-j[..., 5])

    def branches(
        self, ankle: ArrayLike, foot: ArrayLike, hint: ArrayLike | None = None
    ) -> LegBranches:
        """Find all joint angles that make a pose, limits left aside.

        Args:
            ankle: Position in the torso's frame, (3,) [length].
            foot: Rotation in the torso's frame, (3, 3).
            hint: j1 to j6 that undetermined angles keep, (6,) [rad]; 0 if absent.

        Raises:
            InputError: The pose is not finite or has another shape.
        """
        near = np.zeros(6) if hint is None else np.ascontiguousarray(hint, np.float64)
        found = np.empty((kernels.BRANCHES, kernels.BRANCHES))
        state = kernels.branches(self.thigh, self.shin, _pose(ankle, foot), near, found)
        kept = found[found[:, 7] == 0.0] if state == kernels.OK else found[:0]
        words = tuple(flag_words(int(flags)) for flags in kept[:, 6])
        return LegBranches(STATUS[state], np.ascontiguousarray(kept[:, :6]), words)

    def solve(
        self, ankle: ArrayLike, foot: ArrayLike, near: ArrayLike | None = None
    ) -> LegSolution:
        """Choose the joint angles within limits that are nearest to others.

        Args:
            ankle: As in `branches`.
            foot: As in `branches`.
            near: j1 to j6, (6,) [rad]; 0 if absent. Undetermined angles keep these.

        Raises:
            InputError: The pose is not finite or has another shape.
        """
        start = np.zeros(6) if near is None else np.array(near, np.float64)
        angles, codes = self._solve(_pose(ankle, foot)[None], start, False)
        state, flags = codes[0].tolist()
        return LegSolution(angles[0], STATUS[int(state)], int(flags))

    def solve_many(
        self, poses: Array, near: ArrayLike | None = None, follow: bool = False
    ) -> tuple[Array, Array]:
        """Choose joint angles for many poses.

        Args:
            poses: Ankle position and rows of the foot's rotation, (m, 4, 3).
            near: As in `solve`, for all poses, or with `follow` for the first.
            follow: Whether each pose is solved near the one before.

        Returns:
            j1 to j6, (m, 6) [rad], and index into `STATUS` with flags, (m, 2).
        """
        start = np.zeros(6) if near is None else np.array(near, np.float64)
        return self._solve(np.ascontiguousarray(poses, np.float64), start, follow)

    def _solve(self, poses: Array, near: Array, follow: bool) -> tuple[Array, Array]:
        angles, codes = np.empty((len(poses), 6)), np.empty((len(poses), 2))
        kernels.solve_poses(
            (self.thigh, self.shin),
            self.low,
            self.high,
            near,
            poses,
            follow,
            np.empty((8, 8)),
            angles,
            codes,
        )
        return angles, codes


def _pose(ankle: ArrayLike, foot: ArrayLike) -> Array:
    """Return ankle position and foot rotation as one array, (4, 3)."""
    pose = np.empty((4, 3))
    try:
        pose[0] = ankle
        pose[1:] = foot
    except (TypeError, ValueError):
        raise InputError("lambda leg: expected an ankle (3,) and a foot rotation (3, 3)") from None
    if not np.isfinite(pose).all():
        raise InputError("lambda leg: every number of the pose must be finite")
    return pose


def level_pose(ankle: ArrayLike, rtp: ArrayLike, pitch: float, roll: float) -> tuple[Array, Array]:
    """Turn a pose of the level frame into the torso's.

    Args:
        ankle: Position in the level frame, (3,) [length].
        rtp: Foot yaw r, tilts t and p, (3,) [rad].
        pitch: Torso's turn bp about y [rad].
        roll: Torso's turn bt about x [rad].

    Returns:
        Ankle (3,) and foot rotation (3, 3) in the torso's frame.
    """
    torso = turn_y(pitch) @ turn_x(roll)
    yaw, t, p = np.asarray(rtp, np.float64).tolist()
    return torso.T @ np.asarray(ankle, np.float64), torso.T @ rotation(yaw, t, p)
