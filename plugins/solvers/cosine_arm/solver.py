"""The solver `cosine-arm`: a chain of waist, shoulder, elbow and wrist (004).

Waist: heading, on the base. Shoulder: above it, `frozen: [90, 90, 0]`, pitch. Elbow and wrist along
z, the elbow by pitch. With all angles 0 the arm stands straight up.
"""

from collections.abc import Iterable

import numpy as np

from limbik.core.chain import Chain
from limbik.core.frames import Z_UP
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.settings import Settings
from limbik.core.solution import Solution, Status
from limbik.core.strategy import NoParams, Strategy
from limbik.core.whole import Batch, assemble
from limbik.plugins.solvers.fit import require_axes, require_count, require_frozen, require_offset

NAME = "cosine-arm"
UPRIGHT = hpb_to_matrix((np.pi / 2, np.pi / 2, 0.0))
TURNING = ((0, 1, 2), (0, 1, 1))
"""Joint and axis of D1, D2, D3."""
NOTES = {0: "", 1: "too far", 2: "too near", 3: "beyond the joint limits"}


def prepare(chain: Chain, settings: Settings, params: NoParams) -> Batch:
    """Read the arm out of a chain.

    Raises:
        ChainError: The chain has another shape.
    """
    require_count(chain, 4, NAME)
    for joint, axis in zip(*TURNING, strict=True):
        require_axes(chain, joint, (axis,), NAME)
    require_frozen(chain, 0, np.eye(3), "[0, 0, 0]", NAME)
    require_frozen(chain, 1, UPRIGHT, "[90, 90, 0]", NAME)
    require_frozen(chain, 2, np.eye(3), "[0, 0, 0]", NAME)
    size = (
        require_offset(chain, 1, 1, NAME),
        require_offset(chain, 2, 2, NAME),
        require_offset(chain, 3, 2, NAME),
    )
    base = np.asarray(chain.base_position) + chain.base_rotation @ chain.offsets[0]

    def solve(goals: Array, follow: bool, near: Array | None = None) -> Solution:
        points = np.ascontiguousarray(Z_UP.points((goals - base) @ chain.base_rotation))
        start = chain.rest if near is None else near
        return _solve(chain, size, goals, points, follow, start)

    return solve


def _solve(
    chain: Chain,
    size: tuple[float, float, float],
    goals: Array,
    points: Array,
    follow: bool,
    start: Array,
) -> Solution:
    from limbik.plugins.solvers.cosine_arm.arm import FLAGS
    from limbik.plugins.solvers.cosine_arm.kernels import solve_goals

    low, high = chain.low[TURNING].copy(), chain.high[TURNING].copy()
    found, codes = np.empty((len(goals), 3)), np.empty((len(goals), 2))
    near = start[TURNING].copy()
    solve_goals(size, low, high, near, points, follow, np.empty((4, 3)), found, codes)
    angles = np.zeros((len(goals), len(chain), 3))
    angles[:, TURNING[0], TURNING[1]] = found
    angles[:, 3] = np.clip(chain.rest[3], chain.low[3], chain.high[3])
    states = codes.astype(np.int64)
    status = np.where(states[:, 0] == 0, int(Status.REACHED), int(Status.OUT_OF_REACH))
    notes = []
    for state, flags in states.tolist():
        words = [NOTES[state], *(text for flag, text in FLAGS.items() if flags & flag)]
        notes.append("; ".join(filter(None, words)))
    return assemble(chain, goals, angles, status, np.zeros(len(goals), np.int64), notes)


@hookimpl
def limbik_solvers() -> Iterable[Strategy]:
    """Offer the solver."""
    return [Strategy(NAME, prepare, description="Base yaw and two links by the law of cosines.")]
