"""From chain and settings to the flat arrays of a 2D solve."""

from typing import Final

import numpy as np

from limbik.core.chain import Chain
from limbik.core.flatten import Body, Options, facing_axis, flat_body, flat_options
from limbik.core.kernels.planar_layout import Planar as Planar
from limbik.core.pole import rest_line
from limbik.core.rotation import Array
from limbik.core.settings import Settings

FULL_TURN: Final = 2.0 * np.pi - 1e-9  # [rad]; a range this wide is no limit
FIXED: Final = 1e-9  # [rad]; a range this narrow lets nothing turn


def planar_limits(chain: Chain, settings: Settings) -> Array:
    """Return the ranges of the planar joints, (2, n) [rad], ±inf where free (D-06, 2D 42).

    A joint without one of its own takes its pitch range. A pitch turns a bone toward the joint's Y
    axis, so with the reference axis `y-`, which turns Y away from the pole, the range is negated.
    The end turns nothing and is free.
    """
    limits = np.full((2, len(chain)), np.inf)
    limits[0] = -np.inf
    for number, joint in enumerate(chain.joints[:-1]):
        span = joint.planar
        if span is None and joint.pitch is not None:
            low, high = joint.pitch
            span = (-high, -low) if settings.reference_axis == "y-" else (low, high)
        if span is not None and span[1] - span[0] < FULL_TURN:
            limits[:, number] = span
    return limits


def _bend_side(limits: Array) -> float:
    """Return -1 where limits keep joints after the base from bending toward the pole at all.

    A chain that bends toward the pole comes back from it: its joints turn by negative angles.
    """
    low, high = limits[:, 1:-1]
    only_away = (low >= 0.0) & (high > FIXED)
    only_toward = (high <= 0.0) & (low < -FIXED)
    return -1.0 if only_away.any() and not only_toward.any() else 1.0


def flat_plane_body(chain: Chain, settings: Settings) -> Body:
    """Return a chain as the arrays of a 2D solve: its pose starts at rest, whatever the limits."""
    return flat_body(chain, settings)._replace(rest=chain.rest)


def flat_plane_options(chain: Chain, settings: Settings) -> Options:
    """Return settings as the numbers both solvers share; the 2D bend starts at the base."""
    return flat_options(chain, settings.model_copy(update={"bend_reference": 1}))


def flat_planar(chain: Chain, settings: Settings) -> Planar:
    """Return what only the 2D solver knows of a chain and its options."""
    limits = planar_limits(chain, settings)
    turning = np.nonzero(limits[1, :-1] - limits[0, :-1] > FIXED)[0]
    _, rotations = chain.rest_pose
    faced = rotations[settings.bend_reference] @ facing_axis(settings)
    return Planar(
        low=np.ascontiguousarray(limits[0]),
        high=np.ascontiguousarray(limits[1]),
        support=int(turning[0]) if turning.size else -1,
        limited=bool(np.isfinite(limits).any()),
        side=_bend_side(limits),
        reference=settings.bend_reference,
        axis_free=settings.reference_axis == "free",
        keeps_shape=chain.is_straight,
        pole_turn=0.0,
        bound=np.zeros(len(chain)),
        rest_direction=np.ascontiguousarray(rest_line(chain)),
        rest_axis=np.ascontiguousarray(faced),
    )
