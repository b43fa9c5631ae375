"""The pole of the 2D solver, and the pole rotor that turns it with the chain (000 §6.2).

A fixed pole turns the bend over when the goal crosses the line base to pole. A rotor is a frame on
the base that turns the pole with the chain, so that it stays beside it: by the shortest turn from
the rest pose's line base→end to the line base→goal, and by the share of the goal's own twist that
the limb follows.
"""

from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from limbik.core.chain import Chain
from limbik.core.rotation import Array
from limbik.core.settings import Model

NO_LENGTH: Final = 1e-12
HALF_TURN: Final = (
    1e-6  # [rad]; a turn this near to half a turn (or to none) has no axis of its own
)
Preset = Literal["arm", "leg"]


class PoleRotor(Model):
    """How a pole turns with the chain."""

    swing: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the chain's turn about its base")
    ] = 1.0
    twist: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the goal's twist about the chain's line")
    ] = 0.0
    orient_goal: Annotated[bool, Field(description="the goal takes the rotor's axes")] = False
    sync_z: Annotated[bool, Field(description="goal and rotor have one Z axis")] = False


ROTORS: Final[dict[str, PoleRotor]] = {
    # An elbow follows its hand half, a knee points where its foot does.
    "arm": PoleRotor(twist=0.5),
    "leg": PoleRotor(twist=1.0),
}
"""Rotors by name (M-10): the pole follows hand and shoulder, or foot and hip."""


def _place(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


class Pole(Model):
    """Where the chain bends to (D-01).

    Attributes:
        position: World position [length]; with a rotor, the one in the rest pose.
        rotor: None for a fixed pole, a preset's name, or a rotor.
    """

    position: Annotated[tuple[float, float, float], BeforeValidator(_place)]
    rotor: Preset | PoleRotor | None = None

    @property
    def turns_by(self) -> PoleRotor | None:
        """The rotor, looked up if it is a preset's name."""
        return ROTORS[self.rotor] if isinstance(self.rotor, str) else self.rotor


def rest_line(chain: Chain) -> Array:
    """Return the unit vector base→end of the rest pose, world; the base's Z axis if they meet."""
    positions, rotations = chain.rest_pose
    away = positions[-1] - positions[0]
    length = float(np.linalg.norm(away))
    return np.asarray(away / length if length > NO_LENGTH else rotations[0, :, 2])


def rotor_frames(
    chain: Chain, rotor: PoleRotor, pole: Array, goals: Array, turns: Array | None
) -> Array:
    """Return the axes of a rotor for goals.

    In the rest pose they are those of the chain's base. A goal exactly opposite to the rest pose
    is turned to in the plane of the rest line and the pole.

    Args:
        chain: The chain.
        rotor: The rotor.
        pole: Position in the rest pose, world, (3,) [length].
        goals: World positions, (m, 3) [length].
        turns: Axes of the goals, (m, 3, 3), NaN for goals without, or None.

    Returns:
        Axes as columns in the world, (m, 3, 3).
    """
    positions, rotations = chain.rest_pose
    start = rest_line(chain)
    line = _directions(goals - positions[0], start)
    spare = np.cross(start, pole - positions[0])
    axis, angle = _shortest(start, line, spare)
    frames = turn_matrices(axis, angle * rotor.swing) @ chain.base_rotation
    if turns is None:
        return frames
    swung = turn_matrices(axis, angle) @ rotations[-1]
    given = np.isfinite(turns).all((-2, -1), keepdims=True)
    left = np.where(given, turns, swung) @ np.swapaxes(swung, -1, -2)
    frames = turn_matrices(line, rotor.twist * _twist(left, line)) @ frames
    if rotor.sync_z:
        frames = np.where(given, align_z(frames, np.where(given, turns, frames)), frames)
    return np.asarray(frames)


def goal_axes(
    chain: Chain, rotor: PoleRotor | None, frames: Array | None, turns: Array | None
) -> Array | None:
    """Return the axes the goals have: given, or from the rotor (D-07).

    Args:
        chain: The chain.
        rotor: The rotor, if any.
        frames: Its axes, (m, 3, 3).
        turns: Axes given for the goals, (m, 3, 3), NaN for goals without, or None.
    """
    found = None
    if rotor is not None and frames is not None and (rotor.orient_goal or rotor.sync_z):
        found = frames
        if not rotor.orient_goal:
            _, rotations = chain.rest_pose
            found = align_z(np.broadcast_to(rotations[-1], frames.shape), frames)
    if turns is None or found is None:
        return found if turns is None else turns
    return np.where(np.isfinite(turns), turns, found)


def align_z(frames: Array, to: Array) -> Array:
    """Return frames turned the shortest way until their Z axes are those of others."""
    axis, angle = _shortest(frames[..., 2], to[..., 2], frames[..., 0])
    return np.asarray(turn_matrices(axis, angle) @ frames)


def turned_poles(chain: Chain, pole: Array, frames: Array) -> Array:
    """Return where a pole is when its rotor has turned, (m, 3) [length], world."""
    origin = chain.rest_pose[0][0]
    return np.asarray(origin + frames @ (chain.base_rotation.T @ (pole - origin)))


def turn_matrices(axis: Array, angle: Array) -> Array:
    """Return rotations about unit axes (..., 3) by angles (...) [rad], as `turned` of the kernels.

    Positive is the sense in which the axis a x b carries a to b.
    """
    x, y, z = np.moveaxis(axis, -1, 0)
    zero = np.zeros_like(x)
    side = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], -1).reshape(*axis.shape, 3)
    s, c = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + s * side + (1.0 - c) * (side @ side))


def _directions(vectors: Array, instead: Array) -> Array:
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit = vectors / np.where(length > NO_LENGTH, length, 1.0)
    return np.where(length > NO_LENGTH, unit, instead)


def _shortest(start: Array, target: Array, spare: Array) -> tuple[Array, Array]:
    """Return unit axes and angles of the shortest turns; `spare` is the axis of a half turn."""
    start, target = np.broadcast_arrays(start, target)
    across = np.cross(start, target)
    size = np.linalg.norm(across, axis=-1)
    angle = np.arctan2(size, (start * target).sum(-1))
    spare = _directions(spare, np.array([1.0, 0.0, 0.0]))
    spare = spare - start * (start * spare).sum(-1, keepdims=True)
    spare = _directions(spare, np.roll(start, 1, -1))
    return np.where(size[..., None] > HALF_TURN, _directions(across, spare), spare), angle


def _twist(turns: Array, axis: Array) -> Array:
    """Return the part of rotations that is about unit axes, (-π, π] [rad]."""
    skew = np.stack(
        [
            turns[..., 2, 1] - turns[..., 1, 2],
            turns[..., 0, 2] - turns[..., 2, 0],
            turns[..., 1, 0] - turns[..., 0, 1],
        ],
        -1,
    )
    trace = np.trace(turns, axis1=-2, axis2=-1)
    angle = 2.0 * np.arctan2((skew * axis).sum(-1), np.maximum(1.0 + trace, 0.0))
    return np.asarray(np.arctan2(np.sin(angle), np.cos(angle)))
