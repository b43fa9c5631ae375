"""`Joint` and `Chain`: what a user builds; checked once, then frozen arrays (000 §4, §7.4)."""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite, pi, radians
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import ChainError
from limbik.core.kernels.rotation import matrix_to_hpb
from limbik.core.rotation import Array, hpb_to_matrix

Vector = tuple[float, float, float]
Limit = tuple[float, float]

AXES: Final = ("heading", "pitch", "bank")
MAX_JOINTS: Final = 256
STRAIGHT: Final = 1e-6  # largest difference of unit vectors on one line
SHORTEST: Final = 1e-9  # a bone this short has no direction


@dataclass(frozen=True)
class Joint:
    """A joint that turns in heading, pitch and bank and never slides.

    Attributes:
        name: Unique in its chain.
        offset: Position in the parent joint's frame [length].
        frozen: Fixed rotation that makes the joint's zero pose, HPB [rad].
        rest: Initial angles, HPB [rad], relative to the frozen rotation.
        heading: Range (low, high) [rad], or None where free. Equal ends fix the axis.
        pitch: As heading.
        bank: As heading.
        planar: Range of the planar joint's angle in the 2D solver (D-06), from the bone before it
            (the base's: from the line base to goal), positive toward the pole. None takes the
            pitch range instead (2D 42); (-π, π) is free.
        limit: A limit of its own in place of the ranges (M-08): a strategy of the slot `limit`, its
            name or a mapping with `use` and its parameters in degrees.
        mirrored: Whether that limit is meant for the joint's mirror image in its YZ plane.
    """

    name: str
    offset: Vector = (0.0, 0.0, 0.0)
    frozen: Vector = (0.0, 0.0, 0.0)
    rest: Vector = (0.0, 0.0, 0.0)
    heading: Limit | None = None
    pitch: Limit | None = None
    bank: Limit | None = None
    planar: Limit | None = None
    limit: str | Mapping[str, Any] | None = field(default=None, kw_only=True)
    mirrored: bool = field(default=False, kw_only=True)

    @classmethod
    def degrees(
        cls,
        name: str,
        offset: Vector = (0.0, 0.0, 0.0),
        frozen: Vector = (0.0, 0.0, 0.0),
        rest: Vector = (0.0, 0.0, 0.0),
        heading: Limit | None = None,
        pitch: Limit | None = None,
        bank: Limit | None = None,
        planar: Limit | None = None,
        *,
        limit: str | Mapping[str, Any] | None = None,
    ) -> "Joint":
        """Build a joint from angles in degrees; the arguments are those of the class."""
        given = (frozen, rest, heading, pitch, bank, planar)
        return cls(name, offset, *map(_radians, given), limit=limit)

    @property
    def limits(self) -> tuple[Limit | None, Limit | None, Limit | None]:
        """The ranges of heading, pitch and bank [rad]."""
        return self.heading, self.pitch, self.bank


@dataclass(frozen=True, eq=False)
class Chain:
    """Ordered joints, base first; checked when built and immutable after (C-02).

    Args and attributes:
        joints: At least 2, at most 256, with unique names. The last one is the end.
        base_position: Where the parent of joint 0 stands in the world [length].
        base_turn: How that parent is turned, HPB [rad].

    Arrays, read-only, n joints:
        names: n names.
        offsets: (n, 3) [length].
        frozen: Frozen rotation matrices, (n, 3, 3).
        rest: (n, 3) HPB [rad].
        low, high: (n, 3) HPB [rad], -inf and +inf where free.
        lengths: Bone lengths, (n - 1,) [length].
        base_rotation: (3, 3), the axes of the IK space in the world.

    Raises:
        ChainError: A joint or the whole is wrong; the message names joint, axis and what is right.
    """

    joints: tuple[Joint, ...]
    base_position: Vector = (0.0, 0.0, 0.0)
    base_turn: Vector = (0.0, 0.0, 0.0)
    names: tuple[str, ...] = field(init=False, repr=False)
    offsets: Array = field(init=False, repr=False)
    frozen: Array = field(init=False, repr=False)
    rest: Array = field(init=False, repr=False)
    low: Array = field(init=False, repr=False)
    high: Array = field(init=False, repr=False)
    lengths: Array = field(init=False, repr=False)
    base_rotation: Array = field(init=False, repr=False)

    def __init__(
        self,
        joints: Sequence[Joint],
        base_position: Vector = (0.0, 0.0, 0.0),
        base_turn: Vector = (0.0, 0.0, 0.0),
    ) -> None:
        joints = tuple(joints)
        _check_count(joints)
        _check_vector(base_position, "base position")
        _check_vector(base_turn, "base rotation")
        for joint in joints:
            _check_joint(joint)
        spans = [
            [(-np.inf, np.inf) if limit is None else limit for limit in joint.limits]
            for joint in joints
        ]
        offsets = np.array([joint.offset for joint in joints], np.float64)
        arrays = {
            "offsets": offsets,
            "frozen": hpb_to_matrix([joint.frozen for joint in joints]),
            "rest": np.array([joint.rest for joint in joints], np.float64),
            "low": np.array(spans, np.float64)[..., 0],
            "high": np.array(spans, np.float64)[..., 1],
            "lengths": np.linalg.norm(offsets[1:], axis=1),
            "base_rotation": hpb_to_matrix(base_turn),
        }
        if not arrays["lengths"].sum() > SHORTEST:
            raise ChainError("all joints are in one place: at least one bone needs a length")
        names = tuple(joint.name for joint in joints)
        checked = {
            "joints": joints,
            "base_position": base_position,
            "base_turn": base_turn,
            "names": names,
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)
        for name, array in arrays.items():
            array = np.ascontiguousarray(array)
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    def __len__(self) -> int:
        return len(self.joints)

    @property
    def length(self) -> float:
        """Sum of the bone lengths [length]."""
        return float(self.lengths.sum())

    @property
    def axis_names(self) -> list[str]:
        """Names of all axes, joint by joint: `elbow heading`, `elbow pitch`, `elbow bank`."""
        return [f"{name} {axis}" for name in self.names for axis in AXES]

    @property
    def moving_axes(self) -> list[tuple[int, int]]:
        """Joint and axis of all that can turn; the end's own move nothing and are left out."""
        spans = (self.high - self.low)[:-1]
        return [(joint, axis) for joint, axis in np.argwhere(spans > 0.0).tolist()]

    @cached_property
    def rest_pose(self) -> tuple[Array, Array]:
        """World positions (n, 3) [length] and rotations (n, 3, 3) of the joints at rest."""
        from limbik.core.pose import forward_kinematics

        return forward_kinematics(self, self.rest)

    @property
    def is_straight(self) -> bool:
        """Whether all joints lie on one line in the rest pose (bind type, 000 §7.4).

        Bones without length have no direction and are passed over.
        """
        turned = np.eye(3)
        first = None
        for i in range(len(self) - 1):
            turned = turned @ self.frozen[i] @ hpb_to_matrix(self.rest[i])
            if self.lengths[i] <= SHORTEST:
                continue
            direction = turned @ self.offsets[i + 1] / self.lengths[i]
            first = direction if first is None else first
            if np.abs(direction - first).max() > STRAIGHT:
                return False
        return True

    def moved(self, position: Array, rotation: Array) -> "Chain":
        """Return the chain with its base elsewhere; nothing is checked again.

        Args:
            position: Where the parent of joint 0 stands in the world, (3,) [length].
            rotation: Its axes in the world, (3, 3).
        """
        found = copy(self)
        rows = rotation.tolist()
        turn = matrix_to_hpb((tuple(rows[0]), tuple(rows[1]), tuple(rows[2])), 0.0)
        axes = np.array(rotation, np.float64, order="C")
        axes.flags.writeable = False
        object.__setattr__(found, "base_position", tuple(position.tolist()))
        object.__setattr__(found, "base_turn", turn)
        object.__setattr__(found, "base_rotation", axes)
        places, turns = self.rest_pose
        change = axes @ self.base_rotation.T
        found.__dict__["rest_pose"] = (
            position + (places - np.array(self.base_position)) @ change.T,
            change @ turns,
        )
        return found

    def mirrored(self) -> "Chain":
        """Return the chain mirrored in the world's YZ plane (M-14).

        Positions change the sign of x; heading and bank, frozen or resting, change their sign,
        so that mirrored angles give the mirrored pose.
        """

        def turn(hpb: Vector) -> Vector:
            return -hpb[0], hpb[1], -hpb[2]

        def flip(limit: Limit | None) -> Limit | None:
            return None if limit is None else (-limit[1], -limit[0])

        joints = [
            replace(
                joint,
                offset=(-joint.offset[0], joint.offset[1], joint.offset[2]),
                frozen=turn(joint.frozen),
                rest=turn(joint.rest),
                heading=flip(joint.heading),
                bank=flip(joint.bank),
                mirrored=joint.limit is not None and not joint.mirrored,
            )
            for joint in self.joints
        ]
        x, y, z = self.base_position
        return Chain(joints, (-x, y, z), turn(self.base_turn))


def vector(values: ArrayLike) -> Vector:
    """Return three numbers as a vector of a joint or a chain."""
    x, y, z = np.asarray(values, np.float64).tolist()
    return x, y, z


def _radians(degrees: Any) -> Any:
    """Return angles in radians; what is none stays as it is, for the chain to refuse."""
    return tuple(map(radians, degrees)) if _are_numbers(degrees) else degrees


def _are_numbers(values: Any) -> bool:
    return isinstance(values, Sequence | np.ndarray) and all(
        isinstance(value, int | float | np.number) for value in values
    )


def _check_count(joints: tuple[Joint, ...]) -> None:
    if not 2 <= len(joints) <= MAX_JOINTS:
        raise ChainError(f"a chain has 2 to {MAX_JOINTS} joints, this one has {len(joints)}")
    seen: set[str] = set()
    for joint in joints:
        if joint.name in seen:
            raise ChainError("two joints have this name; every joint needs its own", joint.name)
        seen.add(joint.name)


def _check_vector(vector: Vector, what: str, joint: str | None = None) -> None:
    if not _are_numbers(vector) or len(vector) != 3 or not all(map(isfinite, vector)):
        shown = list(vector) if isinstance(vector, tuple) else vector
        raise ChainError(f"{what} must be three finite numbers (found {shown})", joint)


def _check_joint(joint: Joint) -> None:
    if not joint.name:
        raise ChainError("every joint needs a name")
    for what in ("offset", "frozen", "rest"):
        _check_vector(getattr(joint, what), what, joint.name)
    _check_own_limit(joint)
    for axis, limit in zip((*AXES, "planar"), (*joint.limits, joint.planar), strict=True):
        if limit is not None:
            _check_limit(joint.name, axis, limit)


def _check_own_limit(joint: Joint) -> None:
    for axis, limit in zip(AXES, joint.limits, strict=True):
        if joint.limit is not None and limit is not None:
            raise ChainError(f"a joint has either a limit of its own or a {axis} range", joint.name)


def _check_limit(name: str, axis: str, limit: Limit) -> None:
    if not _are_numbers(limit) or len(limit) != 2:
        raise ChainError(f"{axis} range must be two finite numbers (found {limit!r})", name)
    low, high = limit
    shown = f"[{np.degrees(low):g}, {np.degrees(high):g}]"
    if not (isfinite(low) and isfinite(high)):
        raise ChainError(f"{axis} range must be two finite numbers (found {shown})", name)
    if low > high:
        raise ChainError(f"{axis} range {shown}: the minimum is above the maximum", name)
    rounding = 1e-12
    if low < -pi - rounding or high > pi + rounding:
        raise ChainError(
            f"{axis} range {shown} crosses ±180°: turn the joint's zero with `frozen` "
            "so that the range fits between -180 and 180",
            name,
        )
