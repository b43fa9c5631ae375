"""A skeleton: joints that hang from each other, and the limbs cut out of it to be solved.

A scene with several chains has one. Every joint of a skeleton has one turn relative to its parent;
a limb is a chain whose angles stand for the turns of its joints. Formats bring skeletons of their
own, see `limbik.core.formats.SceneInput`; the one here is that of joints written out in a scene.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Final, Self

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.errors import Fault, InputError
from limbik.core.formats import Body, Motion
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.wording import near_match

WORLD: Final = -1
STILL: Final = 1.0 / 30.0  # seconds a frame, of a skeleton that does not move by itself


@dataclass(frozen=True, eq=False)
class Limb(Body):
    """A chain of a skeleton.

    Attributes:
        at: Index in the skeleton of each of the chain's n joints.
        before, after: What a joint's angles stand between: its turn relative to its parent in the
            skeleton is `before @ HPB(angles) @ after`, (n, 3, 3).
        written: How many of the joints take the angles; all, or all but the end.
        turns_end: Whether the end is turned to the goals too, not only carried to them.
    """

    at: tuple[int, ...] = field(kw_only=True)
    before: Array = field(kw_only=True)
    after: Array = field(kw_only=True)
    written: int = field(kw_only=True)
    turns_end: bool = field(default=False, kw_only=True)

    @property
    def turned(self) -> tuple[int, ...]:
        """Joints of the skeleton that a solve turns: all but the end, or all."""
        return self.at if self.turns_end else self.at[:-1]

    def turning_end(self) -> Self:
        """Return the limb for a solver that turns the end to its goals."""
        return replace(self, turns_end=True)

    def turns(self, angles: Array) -> Array:
        """Return the turns of the first `written` joints, (..., written, 3, 3), for angles [rad].

        Args:
            angles: HPB, (..., n, 3) [rad].
        """
        count = self.written
        own = hpb_to_matrix(angles[..., :count, :])
        return np.asarray(self.before[:count] @ own @ self.after[:count])


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Joints that hang from each other, standing still or moving.

    Attributes:
        motion: The skeleton before anything is solved: one frame, or those of its own motion.
        notes: What the user should know, one sentence each.
    """

    motion: Motion
    notes: tuple[str, ...] = ()
    whole: ClassVar[str] = "skeleton"
    part: ClassVar[str] = "joint"

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints, parents before their children."""
        return self.motion.names

    @property
    def parents(self) -> tuple[int, ...]:
        """Index of each joint's parent; -1 for a root."""
        return self.motion.parents

    def limb(self, base: str, end: str) -> Limb:
        """Cut out the chain from one joint down to another, standing as in the first frame.

        Raises:
            InputError: There is no such joint, or the one does not hang from the other; the keys of
                the faults are `base` and `end`.
            ChainError: It makes no chain.
        """
        raise NotImplementedError

    def at(self, name: str, key: str = "") -> int:
        """Return the index of a joint.

        Raises:
            InputError: There is none of this name.
        """
        if name not in self.names:
            raise InputError(_unknown(name, key, self.names, self.whole, self.part))
        return self.names.index(name)

    def above(self, joint: int) -> list[int]:
        """Return a joint and all it hangs from, upward."""
        return _upward(joint, self.parents)

    def way(self, base: str, end: str) -> list[int]:
        """Return the joints from one down to another.

        Raises:
            InputError: As `limb`.
        """
        return way_down(self.names, self.parents, base, end, self.whole, self.part)

    def seen_from(self, joint: int, limb: Limb) -> Limb:
        """Return a limb with its goals in the axes of a joint, as the skeleton itself moves.

        Args:
            joint: Its index.
            limb: With goals in the world, one a frame, or none.
        """
        if limb.goals is None:
            return limb
        positions, rotations = self.motion.world()
        axes = rotations[:, joint].swapaxes(-1, -2)
        away = limb.goals - positions[:, joint]
        turns = limb.goal_turns
        if turns is not None:
            turns = matrix_to_hpb(axes @ hpb_to_matrix(turns))
        return replace(limb, goals=(axes @ away[..., None])[..., 0], goal_turns=turns)

    def placed(self, limb: Limb, positions: Array, rotations: Array) -> tuple[Array, Array]:
        """Return where a limb's base is and how it is turned.

        Args:
            limb: The limb.
            positions: World positions of the skeleton's joints, (..., n, 3) [length].
            rotations: World rotations, (..., n, 3, 3).
        """
        place, parent = positions[..., limb.at[0], :], self.parents[limb.at[0]]
        if parent < 0:
            return place, np.broadcast_to(np.eye(3), (*rotations.shape[:-3], 3, 3))
        return place, rotations[..., parent, :, :]


def way_down(
    names: Sequence[str],
    parents: Sequence[int],
    base: str,
    end: str,
    whole: str = "skeleton",
    part: str = "joint",
) -> list[int]:
    """Return the indices of the joints from one down to another.

    Args:
        names: Of n joints.
        parents: Index of each joint's parent; -1 for a root.
        base: Where the way starts.
        end: Where it ends, below the base.
        whole: What messages call all joints together.
        part: What they call a joint.

    Raises:
        InputError: There is no such joint, or the end does not hang from the base; the keys of the
            faults are `base` and `end`.
    """
    given = (("base", base), ("end", end))
    unknown = [(key, name) for key, name in given if name not in names]
    if unknown:
        raise InputError(_unknown(name, key, names, whole, part) for key, name in unknown)
    way, first = _upward(names.index(end), parents), names.index(base)
    if first not in way[1:]:
        above = ", ".join(names[joint] for joint in way[1:13]) or "nothing, it is a root"
        message = f"the {part} '{end}' does not hang from '{base}'"
        raise InputError(Fault("chain", message, "base", hint=f"it hangs from: {above}"))
    return way[way.index(first) :: -1]


def _upward(joint: int, parents: Sequence[int]) -> list[int]:
    way = [joint]
    while parents[way[-1]] >= 0:
        way.append(parents[way[-1]])
    return way


def _unknown(name: str, key: str, names: Sequence[str], whole: str, part: str) -> Fault:
    hint = near_match(name, list(names)) or f"{part}s: {', '.join(names[:12])}"
    return Fault(f"unknown-{part}", f"the {whole} has no {part} '{name}'", key, hint=hint)


@dataclass(frozen=True, eq=False)
class JointSkeleton(Skeleton):
    """A skeleton of limbik's own joints; a root's offset and frozen rotation are in the world."""

    joints: tuple[Joint, ...] = field(kw_only=True)

    @classmethod
    def of(cls, joints: Sequence[Joint], parents: Sequence[int]) -> "JointSkeleton":
        """Make a skeleton.

        Args:
            joints: n joints, parents before their children.
            parents: Index of each joint's parent; -1 for a root.

        Raises:
            InputError: A parent does not come before its child, or a name is given twice.
        """
        names = tuple(joint.name for joint in joints)
        for index, (name, parent) in enumerate(zip(names, parents, strict=True)):
            if not WORLD <= parent < index:
                raise InputError(f"joint '{name}': its parent must come before it")
            if name in names[:index]:
                raise InputError(f"two joints are called '{name}'")
        zero = hpb_to_matrix([joint.frozen for joint in joints])
        turns = zero @ hpb_to_matrix([joint.rest for joint in joints])
        offsets = np.array([joint.offset for joint in joints], np.float64)
        motion = Motion(names, tuple(parents), offsets[None], turns[None], zero, STILL)
        return cls(motion, joints=tuple(joints))

    def limb(self, base: str, end: str) -> Limb:
        """Cut out a chain."""
        at = self.way(base, end)
        joints = [self.joints[index] for index in at]
        joints[0] = replace(joints[0], offset=(0.0, 0.0, 0.0))
        still = np.repeat(np.eye(3)[None], len(at), axis=0)
        chain, before = Chain(joints), self.motion.zero[at]
        limb = Limb(chain, at=tuple(at), before=before, after=still, written=len(at))
        return standing(self, limb)


def standing(skeleton: Skeleton, limb: Limb) -> Limb:
    """Return a limb whose chain stands where the skeleton's first frame has it."""
    places, turns = skeleton.motion.first.world()
    place, turn = skeleton.placed(limb, places[0], turns[0])
    return replace(limb, chain=limb.chain.moved(place, turn))
