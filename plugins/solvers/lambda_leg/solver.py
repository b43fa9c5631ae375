"""The solver `lambda-leg`: a chain of hip, knee, ankle and sole (002).

| joint | frozen | turns | angles |
|---|---|---|---|
| hip | [0, -90, 0] on an upright torso, z down | all | heading -j1, pitch -j2, bank j3 |
| knee | none | pitch | -j4 |
| ankle | [90, 90, 0], left [-90, 90, 0] | heading, bank | -j5, -j6 |
| end | any | nothing | the sole, anywhere on the foot |

The base's rotation is the torso's posture. The left leg is the right one mirrored: what
`Chain.mirrored` makes of it.
"""

from collections.abc import Iterable
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from limbik.core.chain import Chain
from limbik.core.frames import Z_UP
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.settings import Settings
from limbik.core.solution import Solution, Status
from limbik.core.strategy import Degrees, Strategy
from limbik.core.whole import Batch, assemble
from limbik.plugins.solvers.fit import (
    is_frozen,
    require_axes,
    require_count,
    require_frozen,
    require_offset,
)

NAME = "lambda-leg"
DOWN = hpb_to_matrix((0.0, -np.pi / 2, 0.0))
ANKLE = hpb_to_matrix((np.pi / 2, np.pi / 2, 0.0))
LEFT_ANKLE = hpb_to_matrix((-np.pi / 2, np.pi / 2, 0.0))
TURNING = ((0, 0, 0, 1, 2, 2), (0, 1, 2, 1, 0, 2))
"""Joint and axis of j1 to j6."""
SENSE = np.array([-1.0, -1.0, 1.0, -1.0, -1.0, -1.0])
NOTES = ("", "too far", "too near", "beyond the joint limits")
Tilt = Annotated[float, Field(ge=-180.0, le=180.0)]


class Foot(NamedTuple):
    """How the foot stands, against the level and the base's heading; all 0 is a level foot."""

    r: Annotated[Tilt, Field(description="yaw about the vertical [deg]"), Degrees] = 0.0
    t: Annotated[Tilt, Field(description="tilt about the foot's x [deg]"), Degrees] = 0.0
    p: Annotated[Tilt, Field(description="tilt about the foot's y [deg]"), Degrees] = 0.0


def prepare(chain: Chain, settings: Settings, params: Foot) -> Batch:
    """Read the leg out of a chain.

    Raises:
        ChainError: The chain has another shape.
    """
    require_count(chain, 4, NAME)
    if is_frozen(chain, 2, LEFT_ANKLE):
        return _mirrored(chain, settings, params)
    for joint, axes in ((1, (1,)), (2, (0, 2)), (3, ())):
        require_axes(chain, joint, axes, NAME)
    require_frozen(chain, 1, np.eye(3), "[0, 0, 0]", NAME)
    require_frozen(chain, 2, ANKLE, "[90, 90, 0], or [-90, 90, 0] of a left leg", NAME)
    lengths = require_offset(chain, 1, 2, NAME), require_offset(chain, 2, 2, NAME)

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        start = chain.rest if near is None else near
        return _solve(chain, lengths, params, goals, follow, start)

    return solve


def _mirrored(chain: Chain, settings: Settings, params: Foot) -> Batch:
    """Solve a left leg as the right one it mirrors."""
    flip, sense = np.array([-1.0, 1.0, 1.0]), np.array([-1.0, 1.0, -1.0])
    right = prepare(chain.mirrored(), settings, Foot(-params.r, params.t, -params.p))

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        found = right(goals * flip, follow, None if near is None else near * sense)
        angles = found.angles * sense
        status, iterations = np.asarray(found.status), np.asarray(found.iterations)
        return assemble(chain, goals, angles, status, iterations, getattr(found, "notes", ()))

    return solve


def _poses(chain: Chain, foot: Foot, goals: Array) -> Array:
    """Return ankle positions and foot rotations in the torso's right-handed frame, (m, 4, 3)."""
    from limbik.plugins.solvers.lambda_leg.posture import rotation

    stands = hpb_to_matrix((chain.base_turn[0], 0.0, 0.0)) @ Z_UP.rotations(rotation(*foot))
    torso = chain.base_rotation @ chain.frozen[0] @ DOWN.T
    hip = np.asarray(chain.base_position) + chain.base_rotation @ chain.offsets[0]
    ankles = goals - stands @ DOWN @ ANKLE @ chain.offsets[3] - hip
    poses = np.empty((len(goals), 4, 3))
    poses[:, 0] = Z_UP.points(ankles @ torso)
    poses[:, 1:] = Z_UP.rotations(torso.T @ stands)
    return poses


def _solve(
    chain: Chain,
    lengths: tuple[float, float],
    foot: Foot,
    goals: Array,
    follow: bool,
    start: Array,
) -> Solution:
    from limbik.plugins.solvers.lambda_leg.leg import LambdaLeg, flag_words

    ends = SENSE * chain.low[TURNING], SENSE * chain.high[TURNING]
    leg = LambdaLeg(*lengths, np.minimum(*ends), np.maximum(*ends))
    near = SENSE * start[TURNING]
    found, codes = leg.solve_many(_poses(chain, foot, goals), near, follow)
    angles = np.zeros((len(goals), len(chain), 3))
    angles[:, TURNING[0], TURNING[1]] = SENSE * found
    states = codes.astype(np.int64)
    status = np.where(states[:, 0] == 0, int(Status.REACHED), int(Status.OUT_OF_REACH))
    notes = [
        "; ".join(filter(None, (NOTES[state], *flag_words(flags))))
        for state, flags in states.tolist()
    ]
    return assemble(chain, goals, angles, status, np.zeros(len(goals), np.int64), notes)


@hookimpl
def limbik_solvers() -> Iterable[Strategy]:
    """Offer the solver."""
    return [Strategy(NAME, prepare, Foot, "Six hinges from hip to ankle, foot posture given.")]
