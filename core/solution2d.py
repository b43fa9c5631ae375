"""What the 2D solver gives back: `PlanarSolution`."""

from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.core.rotation import Array
from limbik.core.solution import AT_LIMIT, Solution


class PlaneFrom(IntEnum):
    """Where the IK plane of a solve comes from; the kernels return these numbers."""

    POLE = 0
    PREVIOUS = 1
    REST = 2

    @property
    def label(self) -> str:
        """The word for tables and JSON."""
        return self.name.lower()


@dataclass(frozen=True, slots=True)
class PlanarSolution(Solution):
    """A solution with its IK plane and planar joints.

    Attributes:
        plane: Axes of the IK space in the world as columns: toward the goal, toward the pole,
            across both; (3, 3) or (m, 3, 3). Its origin is the base.
        plane_from: The pole; or, where goal or pole gave no plane, the previous solve or the rest
            pose. `PlaneFrom`, or (m,) of its numbers.
        planar_angles: Angles of the planar joints from the bone before, the base's from the line
            base to goal, positive toward the pole, (n,) or (m, n) [rad].
        planar_limits: Their ranges, (2, n) [rad].
        pole: Where the pole was, (3,) or (m, 3) [length], world.
        rotor: Axes of the pole rotor in the world, (3, 3) or (m, 3, 3); None without a rotor.
        goal_rotation: Axes the goal has, given or from the rotor, (3, 3) or (m, 3, 3), or None.
    """

    plane: Array = field(default_factory=lambda: np.eye(3))
    plane_from: PlaneFrom | NDArray[np.int64] = PlaneFrom.POLE
    planar_angles: Array = field(default_factory=lambda: np.zeros(0))
    planar_limits: Array = field(default_factory=lambda: np.zeros((2, 0)))
    pole: Array = field(default_factory=lambda: np.zeros(3))
    rotor: Array | None = None
    goal_rotation: Array | None = None

    def resting_axes(self) -> list[tuple[int, str]]:
        """Return the planar joints that rest on an end of their range, each with `planar`."""
        low, high = self.planar_limits
        resting = (self.planar_angles <= low + AT_LIMIT) | (self.planar_angles >= high - AT_LIMIT)
        found = np.nonzero(resting & (high - low > AT_LIMIT))[0]
        return [(joint, "planar") for joint in found.tolist()]

    def _row(self, row: int) -> dict[str, Any]:
        fields = Solution._row(self, row)
        fields["plane_from"] = PlaneFrom(int(np.asarray(self.plane_from)[row]))
        fields["planar_limits"] = self.planar_limits
        return fields

    @property
    def remark(self) -> str:
        """What a reader should know beside the status; empty where the pole made the plane."""
        if self.plane_from == PlaneFrom.POLE:
            return ""
        known = self.plane_from == PlaneFrom.PREVIOUS
        return f"plane of the {'previous' if known else 'rest'} pose"
