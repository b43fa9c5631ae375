"""What a solve gives back: `Solution`, `Status`, `Trace` stages, `Continuity`."""

from dataclasses import dataclass, fields
from enum import IntEnum
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from limbik.core.chain import AXES, Chain
from limbik.core.errors import InputError
from limbik.core.jointlimits import Limits, margin_of
from limbik.core.kernels.memory import AIM_BASE, AIM_ROOT, ANGLES, BEND, FLAGS, HAS_POSE
from limbik.core.rotation import Array

AT_LIMIT = 1e-7  # [rad]; an axis this near to the end of its range rests on it
OF_ALL: Final = ("chain", "continuity", "trace", "planar_limits", "limits")
"""Fields of solutions that have no leading goal axis."""


class Status(IntEnum):
    """How a solve ended (M-01).

    `REACHED`: the end is within the tolerance of the goal. `OUT_OF_REACH`: no fold of the bones
    spans the distance, limits or not. `BLOCKED`: the bones would, the limits do not let them.
    `STOPPED`: the rounds ran out and nothing was proved, or the soft zone held the end back. The
    kernels return these numbers; `label` is the word for people.
    """

    REACHED = 0
    STOPPED = 1
    OUT_OF_REACH = 2
    BLOCKED = 3

    @property
    def label(self) -> str:
        """The status as tables and JSON show it."""
        return self.name.lower().replace("_", "-")


@dataclass(frozen=True)
class Stage:
    """One pose of a solve's trace.

    Attributes:
        name: `initial`, `aim`, `bend`, or `round k`.
        angles: (n, 3) HPB [rad].
        positions: World positions of the joints, (n, 3) [length].
    """

    name: str
    angles: Array
    positions: Array


class Continuity:
    """What one solve hands to the next (000 §7.6.3); a plain value, never kept by the solver.

    Get it from `Solution.continuity`, set it with the argument `continuity` of a solve. The
    properties are views: what is written into them counts in the next solve.

    Attributes:
        memory: The numbers as the kernels use them, (n + 4, 3): aim angles of the base and of the
            bend root, bend vector, a flag, angles of the finished pose.
    """

    __slots__ = ("memory",)

    def __init__(self, memory: Array) -> None:
        self.memory: Array = memory

    @classmethod
    def fresh(cls, chain: Chain) -> "Continuity":
        """Return a continuity without a past: a solve with it is a solve without one.

        Args:
            chain: The chain that will be solved.
        """
        return cls(np.zeros((len(chain) + 4, 3)))

    @classmethod
    def from_pose(cls, angles: ArrayLike, bend_reference: int = 1) -> "Continuity":
        """Return the continuity of a pose that no solve has made.

        Args:
            angles: (n, 3) HPB [rad].
            bend_reference: Index of the bend reference joint.

        Raises:
            InputError: The angles are not finite, not of that shape, or have no such joint.
        """
        pose = np.asarray(angles, np.float64)
        if pose.ndim != 2 or pose.shape[1] != 3 or not np.isfinite(pose).all():
            raise InputError(f"pose: expected finite angles (n, 3), found shape {pose.shape}")
        if not 1 <= bend_reference < len(pose):
            raise InputError(
                f"bend_reference must be 1 to {len(pose) - 1} for a pose of {len(pose)} joints, "
                f"not {bend_reference}"
            )
        memory = np.zeros((len(pose) + 4, 3))
        memory[AIM_BASE] = pose[0]
        memory[AIM_ROOT] = pose[bend_reference - 1]
        memory[FLAGS, HAS_POSE] = 1.0
        memory[ANGLES:] = pose
        return cls(memory)

    @property
    def known(self) -> bool:
        """Whether it holds a pose."""
        return bool(self.memory[FLAGS, HAS_POSE] > 0.0)

    @property
    def aim_base(self) -> Array:
        """Base angles of the aim pose, HPB [rad], (3,)."""
        return np.asarray(self.memory[AIM_BASE])

    @property
    def aim_root(self) -> Array:
        """Bend root's angles of the aim pose, HPB [rad], (3,)."""
        return np.asarray(self.memory[AIM_ROOT])

    @property
    def bend_vector(self) -> Array:
        """Bend vector in the world, (3,); zeros when there was none yet."""
        return np.asarray(self.memory[BEND])

    @property
    def angles(self) -> Array:
        """Angles of the finished pose, HPB [rad], (n, 3)."""
        return np.asarray(self.memory[ANGLES:])

    def reset(self) -> None:
        """Forget the past, in place."""
        self.memory[:] = 0.0

    def copy(self) -> "Continuity":
        """Return a copy that shares nothing with this one."""
        return Continuity(self.memory.copy())


@dataclass(frozen=True, slots=True)
class Solution:
    """The answer to one goal, or to many with a leading goal axis.

    Attributes:
        chain: The chain that was solved.
        goal: (3,) or (m, 3) [length].
        angles: (n, 3) HPB [rad], or (m, n, 3).
        positions: World positions of the joints, (n, 3) [length], or (m, n, 3).
        rotations: World rotations, (n, 3, 3), or (m, n, 3, 3).
        iterations: CCD rounds used, or the stage (-2, -1, 0) that was asked for; (m,) for many.
        distance: End to goal [length]; (m,) for many. Always the goal that was asked for, also in
            the soft zone, where the stages pursue a nearer one.
        status: `Status`, by that distance; (m,) of its numbers for many.
        bend_vector: Unit vector in the world toward which the chain bends, (3,) or (m, 3).
        bend_angle: Bend direction: angle about the bend root's Z from its Y axis [rad] (E-14).
        nearest: Least distance to the goal that any pose found would have [length], (m,) for many;
            below `distance` where the finish stays with the fold it is in. None where no other
            pose is looked for.
        continuity: What the next solve may be given; None for many.
        trace: Every stage's pose, when asked for.
        limits: The joints' own limits, n of them, None for joints with ranges; None if all have.
    """

    chain: Chain
    goal: Array
    angles: Array
    positions: Array
    rotations: Array
    iterations: int | NDArray[np.int64]
    distance: float | Array
    status: Status | NDArray[np.int64]
    bend_vector: Array
    bend_angle: float | Array
    nearest: float | Array | None = None
    continuity: Continuity | None = None
    trace: tuple[Stage, ...] | None = None
    limits: Limits | None = None

    @property
    def reached(self) -> bool | Array:
        """Whether the end is on the goal; (m,) for many."""
        return self.status == Status.REACHED

    @property
    def remark(self) -> str:
        """What a reader should know beside the status; empty for the 3D solver."""
        return ""

    def single(self, row: int) -> "Solution":
        """Return the solution of one goal out of many."""
        return type(self)(**self._row(row))

    def _row(self, row: int) -> dict[str, Any]:
        """Return the fields of one goal's solution."""
        picked: dict[str, Any] = {
            f.name: None if (value := getattr(self, f.name)) is None else value[row]
            for f in fields(self)
            if f.name not in OF_ALL
        }
        return picked | {
            "chain": self.chain,
            "limits": self.limits,
            "iterations": int(picked["iterations"]),
            "distance": float(picked["distance"]),
            "bend_angle": float(picked["bend_angle"]),
            "nearest": None if self.nearest is None else float(picked["nearest"]),
            "status": Status(int(picked["status"])),
        }

    def limits_touched(self) -> tuple[str, ...]:
        """Return what `resting_axes` does by the joints' names, like `elbow pitch`."""
        return tuple(f"{self.chain.names[joint]} {what}" for joint, what in self.resting_axes())

    def resting_axes(self) -> list[tuple[int, str]]:
        """Return joint and axis of all that rest on an end of their range, in the chain's order.

        Fixed axes are left out: they always rest. A joint that rests on its own limit is told with
        the limit's name in place of an axis, like `cone`.
        """
        low, high = self.chain.low, self.chain.high
        resting = (self.angles <= low + AT_LIMIT) | (self.angles >= high - AT_LIMIT)
        joints, axes = np.nonzero(resting & (high - low > AT_LIMIT))
        found = [
            (joint, AXES[axis]) for joint, axis in zip(joints.tolist(), axes.tolist(), strict=True)
        ]
        for joint, limit in enumerate(self.limits or ()):
            mirrored = self.chain.joints[joint].mirrored
            if limit and margin_of(limit, mirrored, self.angles[joint]) < AT_LIMIT:
                found.append((joint, limit.name))
        return sorted(found)
