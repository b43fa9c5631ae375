"""The ranges of joints as arcs, and where in them the joints stand; world coordinates.

An axis with a range gets an arc that its pointer sweeps: the joint's z for heading and pitch, its y
for bank. Free and fixed axes get none. A joint with a limit of its own gets the rim that its z can
reach.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from limbik.core.binding import Bound
from limbik.core.chain import AXES, Chain
from limbik.core.jointlimits import margin_of, pulled
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb, quaternion_to_matrix
from limbik.core.solution import AT_LIMIT
from limbik.core.solution2d import PlanarSolution
from limbik.plugins.viewer.session import Shown
from limbik.plugins.viewer.shapes import along, segments

STEPS = 24
SIZES = (1.0, 0.82, 0.64)  # of heading, pitch, bank, over the arcs' size
PLANAR = "planar"
OWN = "own"
AROUND = 48  # directions in which a joint is swung out to its own limit
SPOKES = 6  # one at every so many of them
BEHIND = np.radians(179.0)


@dataclass(frozen=True, eq=False)
class Arc:
    """One range.

    Attributes:
        axis: `heading`, `pitch`, `bank`, `planar`, or `own` for a limit of its own.
        lines: The arc with its two ends, (k, 2, 3) [length].
        hand: From the joint to where it stands, (2, 3) [length].
        at_limit: Whether it stands at an end of its range.
    """

    axis: str
    lines: Array
    hand: Array
    at_limit: bool


def arcs(shown: Shown, size: float) -> list[Arc]:
    """Return the arcs of a chain's ranges; of its planar joints if it was solved in 2D.

    Args:
        shown: The chain.
        size: Radius of the largest [length].
    """
    if isinstance(shown.solution, PlanarSolution):
        return list(_planar(shown, shown.solution, size))
    return list(_turning(shown, shown.solution.chain, size))


def _turning(shown: Shown, chain: Chain, size: float) -> Iterator[Arc]:
    for joint in range(len(chain)):
        above = shown.rotations[joint - 1] if joint else chain.base_rotation
        zero, place = above @ chain.frozen[joint], shown.positions[joint]
        angles = shown.angles[joint]
        bound = (shown.solution.limits or (None,) * len(chain))[joint]
        if bound is not None:
            yield from _own(bound, chain.joints[joint].mirrored, place, size * zero, angles)
        for axis in range(3):
            low, high = chain.low[joint, axis], chain.high[joint, axis]
            if not AT_LIMIT < high - low < np.inf:
                continue
            swept = np.zeros((STEPS + 1, 3))
            swept[:, :axis] = angles[:axis]
            swept[:-1, axis], swept[-1, axis] = np.linspace(low, high, STEPS), angles[axis]
            rays = zero @ hpb_to_matrix(swept)[..., 1 if axis == 2 else 2].T
            yield _arc(AXES[axis], place, size * SIZES[axis] * rays.T, angles[axis], low, high)


def _own(bound: Bound, mirrored: bool, place: Array, axes: Array, angles: Array) -> Iterator[Arc]:
    """Give the rim of a joint's own limit with spokes to it; none where nothing limits the swing.

    Args:
        bound: The limit.
        mirrored: Whether it is meant for the mirror image.
        place: Of the joint [length].
        axes: Of its zero pose, as long as the rim is far, (3, 3) [length].
        angles: Where it stands, HPB [rad].
    """
    rim = _rim(bound, mirrored)
    if rim is None:
        return
    ends = place + rim @ axes.T
    spokes = np.stack([np.broadcast_to(place, ends.shape), ends], 1)[::SPOKES]
    hand = place + axes @ hpb_to_matrix(angles)[:, 2]
    at_limit = margin_of(bound, mirrored, angles) < AT_LIMIT
    lines = np.concatenate([segments(np.append(ends, ends[:1], 0)), spokes])
    yield Arc(OWN, lines, np.array([place, hand]), at_limit)


@lru_cache(maxsize=64)
def _rim(bound: Bound, mirrored: bool) -> Array | None:
    """Return where a limit lets z, swung out as far as it goes all around, (AROUND, 3)."""
    around = np.linspace(0.0, 2.0 * np.pi, AROUND, endpoint=False)
    s, c = np.sin(BEHIND), np.cos(BEHIND)
    ways = np.stack([s * np.cos(around), s * np.sin(around), np.full(AROUND, c)], 1)
    found = [
        pulled(bound, mirrored, matrix_to_hpb(quaternion_to_matrix(turn))) for turn in along(ways)
    ]
    if all(margin > 0.0 for _, margin in found):
        return None
    return np.array([hpb_to_matrix(turn)[:, 2] for turn, _ in found])


def _planar(shown: Shown, solution: PlanarSolution, size: float) -> Iterator[Arc]:
    low, high = solution.planar_limits
    toward, up = solution.plane[:, 0], solution.plane[:, 1]
    before = np.array([1.0, 0.0])
    for joint in range(len(low) - 1):
        bone = shown.positions[joint + 1] - shown.positions[joint]
        flat = np.array([bone @ toward, bone @ up])
        own = np.arctan2(before[0] * flat[1] - before[1] * flat[0], before @ flat)
        if AT_LIMIT < high[joint] - low[joint] < 2.0 * np.pi - AT_LIMIT:
            swept = np.append(np.linspace(low[joint], high[joint], STEPS), own)
            c, s = np.cos(swept), np.sin(swept)
            x, y = c * before[0] - s * before[1], s * before[0] + c * before[1]
            rays = size * SIZES[1] * (x[:, None] * toward + y[:, None] * up)
            yield _arc(PLANAR, shown.positions[joint], rays, own, low[joint], high[joint])
        length = np.linalg.norm(flat)
        before = flat / length if length > 0.0 else before


def _arc(axis: str, place: Array, rays: Array, angle: float, low: float, high: float) -> Arc:
    """Make an arc of its rays, (STEPS + 1, 3); the last is where the joint stands."""
    ends = np.array([[place, place + rays[0]], [place, place + rays[-2]]])
    lines = np.concatenate([segments(place + rays[:-1]), ends])
    resting = angle <= low + AT_LIMIT or angle >= high - AT_LIMIT
    return Arc(axis, lines, np.array([place, place + rays[-1]]), bool(resting))
