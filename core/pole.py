"""The pole of the 2D solver, and the pole rotor that turns it with the chain (000 §6.2).

A fixed pole turns the bend over when the goal crosses the line base to pole. A rotor is a frame on
the base that turns the pole with the chain, so that it stays beside it: by the shortest turn from
the rest pose's line base→end to the line base→goal, and by the shares of the goal's own twist and
tilt that the limb follows.
"""

from typing import Annotated, Final, Literal

import numpy as np
from pydantic import BeforeValidator, Field

from limbik.core.chain import Chain
from limbik.core.rotation import Array
from limbik.core.settings import Model, list_as_tuple

NO_LENGTH: Final = 1e-12
Preset = Literal["arm", "leg"]


class PoleRotor(Model):
    """How a pole turns with the chain."""

    swing: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the chain's turn about its base")
    ] = 1.0
    twist: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the goal's twist about the chain's line")
    ] = 0.0
    tilt: Annotated[
        float, Field(ge=0.0, le=1.0, description="share of the goal's tilt across the chain's line")
    ] = 0.0
    orient_goal: Annotated[bool, Field(description="the goal takes the rotor's axes")] = False
    sync_z: Annotated[bool, Field(description="goal and rotor have one Z axis")] = False


ROTORS: Final[dict[str, PoleRotor]] = {
    # An elbow follows its hand half, a knee points where its foot does.
    "arm": PoleRotor(twist=0.5),
    "leg": PoleRotor(twist=1.0),
}
"""Rotors by name (M-10): the pole follows hand and shoulder, or foot and hip."""


class Pole(Model):
    """Where the chain bends to (D-01).

    Attributes:
        position: World position [length]; with a rotor, the one in the rest pose.
        rotor: None for a fixed pole, a preset's name, or a rotor.
    """

    position: Annotated[tuple[float, float, float], BeforeValidator(list_as_tuple)]
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


def turn_pole(
    chain: Chain, line: Array, pole: Pole, rotor: PoleRotor, goals: Array, turns: Array | None
) -> tuple[Array, Array, Array | None]:
    """Turn a pole by its rotor for goals.

    In the rest pose the rotor's axes are those of the chain's base. A goal exactly opposite to the
    rest pose is turned to in the plane of the rest line and the pole.

    Args:
        chain: The chain.
        line: Its `rest_line`.
        pole: The pole.
        rotor: Its rotor.
        goals: World positions, (m, 3) [length].
        turns: How the goals are turned, HPB, (m, 3) [rad], NaN for goals without, or None.

    Returns:
        Where the pole is, (m, 3) [length], and the axes, as columns in the world, of the rotor and
        of the goals, (m, 3, 3): those of the goals given or from the rotor (D-07), NaN or None
        for goals that have none.
    """
    from limbik.core.kernels.rotor import Rotor, turn_rotor

    places, axes = chain.rest_pose
    flat = Rotor(
        rotor.swing,
        rotor.twist,
        rotor.tilt,
        rotor.orient_goal,
        rotor.sync_z,
        np.array([places[0], pole.position, line]),
        np.array([chain.base_rotation, axes[-1]]),
    )
    poles, frames = np.empty(goals.shape), np.empty((2, len(goals), 3, 3))
    given = np.full(goals.shape, np.nan) if turns is None else turns
    turn_rotor(flat, np.ascontiguousarray(goals), np.ascontiguousarray(given), poles, frames)
    oriented = turns is not None or rotor.orient_goal or rotor.sync_z
    return poles, frames[0], frames[1] if oriented else None
