"""From chain and settings to the flat arrays the compiled solve runs on."""

from collections.abc import Mapping
from math import radians
from typing import Final

import numpy as np

from limbik.core.binding import Bound
from limbik.core.chain import SHORTEST, Chain
from limbik.core.errors import ChainError
from limbik.core.jointlimits import Limits, own_rows
from limbik.core.kernels.layout import Body as Body
from limbik.core.kernels.layout import Choice as Choice
from limbik.core.kernels.layout import Options as Options
from limbik.core.kernels.layout import Plugs as Plugs
from limbik.core.kernels.own import COMPLIANCE
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.slots import MAX_PARAMS, OPTIONS, PASSED_OVER

SLOT_ORDER: Final = tuple(OPTIONS)
"""The slots in the order of `Plugs`."""

_AXES: Final = {
    "free": (0.0, 0.0),
    "x+": (1.0, 0.0),
    "x-": (-1.0, 0.0),
    "y+": (0.0, 1.0),
    "y-": (0.0, -1.0),
}

CHOICES: Final = ("nearest", "margin")
"""The words of `Choose.by` in the order of `limbik.core.kernels.choose`, from 1."""


def facing_axis(settings: Settings) -> Array:
    """Return the reference joint's axis that faces the bend, in its frame, (3,): y if free."""
    x, y = _AXES[settings.reference_axis]
    return np.array([x, y or float(x == 0.0), 0.0])


def by_joint(chain: Chain, values: Mapping[str, float], default: float) -> Array:
    """Return what is given by joints' names as an array, (n,)."""
    return np.array([values.get(name, default) for name in chain.names], np.float64)


def reference_pose(chain: Chain, given: Mapping[str, tuple[float, float, float]] | None) -> Array:
    """Return the rest pose with some joints' angles [deg] replaced, inside the limits [rad]."""
    pose = chain.rest.copy()
    for name, angles in (given or {}).items():
        pose[chain.names.index(name)] = np.radians(angles)
    return np.clip(pose, chain.low, chain.high)


def flat_body(chain: Chain, settings: Settings) -> Body:
    """Return a chain as the arrays of a solve.

    The initial pose is the rest pose pulled into the limits. Operating vectors are the joints' Z
    axes, or in the off-axis layout their directions to the end in the initial pose (E-11K).
    """
    rest = np.clip(chain.rest, chain.low, chain.high)
    operating = np.tile([0.0, 0.0, 1.0], (len(chain), 1))
    if settings.off_axis:
        operating = _end_directions(chain, rest)
    return Body(
        chain.offsets,
        chain.frozen,
        rest,
        chain.low,
        chain.high,
        np.ascontiguousarray(operating),
        np.concatenate([[0.0], np.cumsum(chain.lengths)]),
        np.array(chain.base_position, np.float64),
        chain.base_rotation,
    )


def _end_directions(chain: Chain, rest: Array) -> Array:
    """Return unit vectors from each joint to the end in the rest pose, joint's frame, (n, 3)."""
    positions, rotations = forward_kinematics(chain, rest)
    away = np.einsum("nij,ni->nj", rotations, positions[-1] - positions)
    length = np.linalg.norm(away, axis=1, keepdims=True)
    return np.where(length > SHORTEST, away / np.maximum(length, SHORTEST), 0.0)


def _root_to_end(chain: Chain, settings: Settings) -> float:
    """Return the length from the bend root to the end (3D A-06).

    A bone sum in the Z layout, the straight distance in the initial pose in the off-axis layout.
    """
    root = settings.bend_reference - 1
    if not settings.off_axis:
        return float(chain.lengths[root:].sum())
    positions, _ = forward_kinematics(chain, np.clip(chain.rest, chain.low, chain.high))
    return float(np.linalg.norm(positions[-1] - positions[root]))


def flat_options(chain: Chain, settings: Settings) -> Options:
    """Return settings as the numbers of a solve: radians, flags, lengths.

    Raises:
        ChainError: The bones from the bend root on have no length.
    """
    root_to_end = _root_to_end(chain, settings)
    if not root_to_end > SHORTEST:
        name = chain.names[settings.bend_reference - 1]
        raise ChainError("the chain has no length from the bend root to the end", name)
    cone, held = settings.forbidden_cone, settings.held
    axis_x, axis_y = _AXES[settings.reference_axis]
    return Options(
        full_fk=not settings.ik,
        tolerance=settings.tolerance,
        max_iterations=settings.max_iterations,
        smoothing=settings.smoothing,
        max_violations=settings.max_violations,
        held_base=held.base,
        held_end=held.end,
        bend_held_base=held.base if held.bend_base else 0,
        bend_held_end=held.end if held.bend_end else 0,
        coefficient_base=settings.coefficient_base,
        weight_min=settings.weight_range[0],
        weight_max=settings.weight_range[1],
        root=settings.bend_reference - 1,
        root_to_end=root_to_end,
        axis_x=axis_x,
        axis_y=axis_y,
        twist=radians(settings.twist),
        aim_twist=settings.aim_twist,
        off_axis=settings.off_axis,
        from_previous=settings.aim_from == "previous",
        bank_lock=settings.bank_lock,
        cone_axis=-1 if cone is None else "xyz".index(cone.axis[0]),
        cone_sign=-1.0 if cone is not None and cone.axis[1] == "-" else 1.0,
        cone_angle=0.0 if cone is None else radians(cone.half_angle),
        cone_around=cone is not None and cone.entry == "go-around",
        hold_bend=settings.hold_bend_vector,
        bend_smoothing=radians(settings.bend_smoothing),
        plain_clamp=settings.clamp == "plain",
        from_current=settings.start == "current",
        soft_zone=settings.soft_zone,
        limit_ease=radians(settings.limit_ease),
        fk_strength=settings.fk_strength,
        fk_mix=settings.fk_mix,
    )


def flat_choice(chain: Chain, settings: Settings) -> Choice:
    """Return what few solves ask for."""
    choose = settings.choose
    return Choice(
        by=0 if choose is None else CHOICES.index(choose.by) + 1,
        candidates=0 if choose is None else choose.candidates,
        pose_given=choose is not None and choose.pose is not None,
        pose=reference_pose(chain, None if choose is None else choose.pose),
        weights=by_joint(chain, {} if choose is None else choose.weights, 1.0),
        end_orientation=settings.end_orientation,
    )


def flat_plugs(
    chain: Chain, settings: Settings, chosen: Mapping[str, Bound], limits: Limits
) -> Plugs:
    """Return addresses and parameters of the strategies; compiles them on first use."""
    unused = np.zeros(MAX_PARAMS)
    own = own_rows(chain, limits)
    own[:, COMPLIANCE] = 1.0 - by_joint(chain, settings.stiffness, 0.0)
    return Plugs(
        **{slot: _address(chosen[slot]) if slot in chosen else 0 for slot in SLOT_ORDER},
        params=np.array([chosen[slot].values if slot in chosen else unused for slot in SLOT_ORDER]),
        own=own,
    )


def _address(bound: Bound) -> int:
    """Return the address of a strategy, 0 for one that is passed over."""
    return 0 if bound.name == PASSED_OVER else bound.address
