"""From a model's joints, whose axes point anywhere, to limbik's joints, which turn about H, P, B.

A joint's frame is turned so that its Z runs along the next bone and its hinge axis is one of the
three; what that turn adds is taken back in the frozen rotation of the next joint. So positions,
hinge angles and limits stay exactly the model's:

    model  F_j = F_(j-1) · offset_j · turn_j · M_j        limbik  G_j = F_j Q_j
    G_j = G_(j-1) · Q_(j-1)ᵀ offset_j · (Q_(j-1)ᵀ turn_j Q_j) · (Q_jᵀ M_j Q_j)
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Final

import numpy as np

from limbik.core.chain import SHORTEST, Joint, Limit, vector
from limbik.core.frames import hpb_of
from limbik.core.rotation import Array, hpb_to_matrix

FREE, HEADING, PITCH, BANK, FIXED = -1, 0, 1, 2, 3
_ALONG: Final = 0.7071  # a hinge within 45° of its bone turns it about itself: bank
_AHEAD: Final = np.array([0.0, 0.0, 1.0])
_UP: Final = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True, eq=False)
class ModelJoint:
    """A joint as its model has it, in limbik's axes.

    Attributes:
        name: Its name.
        offset: In the parent joint's frame, (3,) [length].
        turn: Fixed rotation before the joint's own, (3, 3).
        kind: `hinge`, `free` (any rotation) or `fixed`.
        axis: Unit axis of a hinge in the frame after `turn`, (3,); None otherwise.
        limit: Range of a hinge [rad]; None if it turns without end.
        rest: Value of a hinge in the rest pose [rad]; the limit's nearest end if outside.
    """

    name: str
    offset: Array
    turn: Array
    kind: str
    axis: Array | None = None
    limit: Limit | None = None
    rest: float = 0.0


@dataclass(frozen=True, eq=False)
class Joined:
    """limbik's joints, and how to get back to the model's.

    Attributes:
        joints: n joints.
        frames: Q, limbik's joint frames in the model's, (n, 3, 3).
        slots: Which angle of each joint is the hinge; FREE or FIXED if none.
        shifts: What the model's hinge values exceed limbik's by, (n,) [rad].
        shifted: The shifts as rotations in limbik's joint frames, (n, 3, 3).
    """

    joints: tuple[Joint, ...]
    frames: Array
    slots: tuple[int, ...]
    shifts: Array
    shifted: Array

    def hinge_values(self, angles: Array) -> tuple[tuple[str, ...], Array]:
        """Return the names of the hinges and the model's values (m, k) [rad] for angles."""
        at = [k for k, slot in enumerate(self.slots) if slot in (HEADING, PITCH, BANK)]
        rows = np.stack([angles[:, k, self.slots[k]] + self.shifts[k] for k in at], axis=-1)
        return tuple(self.joints[k].name for k in at), rows

    def own_turns(self, angles: Array) -> Array:
        """Return the model's own rotations M, (m, n, 3, 3), of free joints for angles [rad]."""
        return np.asarray(self.frames @ hpb_to_matrix(angles) @ self.frames.transpose(0, 2, 1))


def joined(models: Sequence[ModelJoint]) -> Joined:
    """Make limbik's joints of a model's, base first."""
    joints, frames, slots, shifts, shifted = [], [], [], [], []
    before = np.eye(3)
    for index, model in enumerate(models):
        frame, slot = _frame(model, _bone(models, index), before)
        shift, limit = _range(model)
        turned = np.zeros(3)
        if slot in (HEADING, PITCH, BANK):
            turned[slot] = shift
        shifted.append(hpb_to_matrix(turned))
        frozen = hpb_of(before.T @ model.turn @ frame @ shifted[-1])
        limits: list[Limit | None] = [None if slot == FREE else (0.0, 0.0)] * 3
        rest = [0.0, 0.0, 0.0]
        if slot in (HEADING, PITCH, BANK):
            limits[slot] = limit
            rest[slot] = model.rest - shift
        place = vector(before.T @ model.offset)
        joints.append(Joint(model.name, place, vector(frozen), vector(rest), *limits))
        frames.append(frame)
        slots.append(slot)
        shifts.append(shift)
        before = frame
    return Joined(
        tuple(joints), np.array(frames), tuple(slots), np.array(shifts), np.array(shifted)
    )


def _range(model: ModelJoint) -> tuple[float, Limit | None]:
    """Give the shift of a hinge's zero and its range from there.

    A range that crosses ±180° has its zero in the middle; one of a whole turn or more is no limit.
    """
    if model.limit is None:
        return 0.0, None
    low, high = model.limit
    if high - low >= 2.0 * pi:
        return 0.0, None
    if low < -pi or high > pi:
        middle = 0.5 * (low + high)
        return middle, (low - middle, high - middle)
    return 0.0, model.limit


def _bone(models: Sequence[ModelJoint], index: int) -> Array | None:
    """Direction from a joint to the next one elsewhere in the zero pose, in the joint's frame."""
    turned, place = np.eye(3), np.zeros(3)
    for model in models[index + 1 :]:
        place = place + turned @ model.offset
        length = float(np.linalg.norm(place))
        if length > SHORTEST:
            return place / length
        turned = turned @ model.turn
    return None


def _frame(model: ModelJoint, bone: Array | None, before: Array) -> tuple[Array, int]:
    """Choose a joint's frame Q and the angle that is its hinge."""
    if model.kind == "fixed":
        return np.eye(3), FIXED
    if model.kind == "free":
        if bone is None:
            return model.turn.T @ before, FREE
        return along(bone), FREE
    axis = np.asarray(model.axis)
    if bone is None or abs(bone @ axis) > _ALONG:
        hint = model.turn.T @ before[:, 1]
        return _with_z(axis, hint), BANK
    z = bone - (bone @ axis) * axis
    z = z / np.linalg.norm(z)
    return np.stack([axis, np.cross(z, axis), z], axis=-1), PITCH


def along(bone: Array) -> Array:
    """Return the frame whose Z runs along a bone and whose Y faces ahead, or up if that cannot be.

    So a bend vector along Y takes knees, elbows and backs forward.
    """
    return _with_z(bone, _AHEAD if abs(bone[2]) < 0.9 else _UP)


def _with_z(z: Array, toward: Array) -> Array:
    """Frame with the given Z and Y as near to a direction as can be."""
    y = toward - (toward @ z) * z
    length = float(np.linalg.norm(y))
    if length < 0.1:
        other = np.eye(3)[int(np.abs(z).argmin())]
        y = other - (other @ z) * z
        length = float(np.linalg.norm(y))
    y = y / length
    return np.stack([np.cross(y, z), y, z], axis=-1)
