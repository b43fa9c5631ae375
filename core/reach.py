"""How far a chain's end can get, and goals pulled to there (000 §6.1(7)(A))."""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import SHORTEST, Chain
from limbik.core.kernels.reach import least_reach
from limbik.core.rotation import Array


def reach_range(chain: Chain) -> tuple[float, float]:
    """Return the least and the greatest distance of a chain's end from joint 0 [length].

    Bones alone decide, limits do not: the greatest is their sum. Where one bone is longer than all
    others together the end cannot come nearer than what it has over, which is the least.

    Args:
        chain: The chain.
    """
    return least_reach(chain.length, float(chain.lengths.max())), chain.length


def pull_into_reach(chain: Chain, goals: ArrayLike) -> Array:
    """Return goals moved along their lines from joint 0 into the end's range (C-07A).

    A goal on joint 0 has no line; inside a hole it goes to where the end lies in the rest pose.

    Args:
        chain: The chain.
        goals: World positions, (..., 3) [length].
    """
    points = np.asarray(goals, np.float64)
    least, greatest = reach_range(chain)
    rest, _ = chain.rest_pose
    away = points - rest[0]
    distance = np.linalg.norm(away, axis=-1, keepdims=True)
    allowed = np.clip(distance, least, greatest)
    spare = rest[-1] - rest[0]
    length = np.linalg.norm(spare)
    spare = spare / length if length > SHORTEST else np.array([0.0, 0.0, 1.0])
    direction = np.where(distance > SHORTEST, away / np.maximum(distance, SHORTEST), spare)
    return np.where(allowed == distance, points, rest[0] + direction * allowed)
