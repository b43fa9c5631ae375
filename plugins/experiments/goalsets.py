"""Sets of goals, any part of which can be made anywhere, always the same.

Random goals are drawn in blocks, each from a seed of its own: the goals from `start` to `stop` do
not depend on who asks for them, in which order, or how many at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal
from zlib import crc32

import numpy as np

from limbik.core.chain import Chain
from limbik.core.pose import forward_kinematics, spread_poses
from limbik.core.reach import reach_range
from limbik.core.rotation import Array

BLOCK = 1024  # goals drawn from one seed


@dataclass(frozen=True)
class Reach:
    """Goals drawn at random where a chain can get.

    Attributes:
        seed: The experiment's seed, a number for the set's name, and the repeat.
        by: `joints` or `ball`, see `ReachModel`.
        start: First goal of this part.
        stop: First goal behind it.
    """

    seed: tuple[int, int, int]
    by: Literal["joints", "ball"]
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start

    def part(self, start: int, stop: int) -> "Reach":
        """Return some of the goals, counted from the set's first."""
        return replace(self, start=start, stop=stop)

    def positions(self, chain: Chain) -> Array:
        """Return the goals in the world, (m, 3) [length]."""
        blocks = range(self.start // BLOCK, -(-self.stop // BLOCK))
        width = 3 * len(chain) if self.by == "joints" else 4
        drawn = np.concatenate([self._block(block, width) for block in blocks])
        first = self.start - blocks.start * BLOCK
        drawn = drawn[first : first + len(self)]
        return _by_joints(chain, drawn) if self.by == "joints" else _in_ball(chain, drawn)

    def _block(self, block: int, width: int) -> Array:
        """Draw numbers in 0..1 for one block of goals, (BLOCK, width)."""
        entropy, name, repeat = self.seed
        seed = np.random.SeedSequence(entropy, spawn_key=(name, repeat, block))
        return np.random.default_rng(seed).random((BLOCK, width))


def seed_of(seed: int, name: str, repeat: int) -> tuple[int, int, int]:
    """Return the seed of a set: the same however many other sets there are."""
    return seed, crc32(name.encode()), repeat


def _by_joints(chain: Chain, drawn: Array) -> Array:
    """Put the end where angles within the limits put it."""
    angles = spread_poses(chain, drawn.reshape(len(drawn), len(chain), 3))
    return np.ascontiguousarray(forward_kinematics(chain, angles)[0][:, -1])


def _in_ball(chain: Chain, drawn: Array) -> Array:
    """Spread points evenly between the least and the greatest distance of the end."""
    least, greatest = reach_range(chain)
    radius = np.cbrt(least**3 + drawn[:, 0] * (greatest**3 - least**3))
    height = 2.0 * drawn[:, 1] - 1.0
    side = np.sqrt(np.maximum(1.0 - height**2, 0.0))
    turn = 2.0 * np.pi * drawn[:, 2]
    direction = np.stack([side * np.cos(turn), height, side * np.sin(turn)], axis=1)
    return np.asarray(middle_of(chain) + radius[:, None] * direction)


def middle_of(chain: Chain) -> Array:
    """Where joint 0 is, (3,) [length]."""
    return np.asarray(chain.base_position + chain.base_rotation @ chain.offsets[0])


@dataclass(frozen=True)
class Grid:
    """Goals on a grid, x slowest.

    Attributes:
        steps: Goals along each axis; an axis with one goes through the middle.
        low: Corner [chain lengths] from joint 0.
        high: The other corner.
        start: First goal of this part.
        stop: First goal behind it.
    """

    steps: tuple[int, int, int]
    low: tuple[float, float, float]
    high: tuple[float, float, float]
    start: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.start

    def part(self, start: int, stop: int) -> "Grid":
        """Return some of the goals, counted from the set's first."""
        return replace(self, start=start, stop=stop)

    def positions(self, chain: Chain) -> Array:
        """Return the goals in the world, (m, 3) [length]."""
        at = np.stack(np.unravel_index(np.arange(self.start, self.stop), self.steps), axis=1)
        steps = np.array(self.steps)
        share = np.where(steps > 1, at / np.maximum(steps - 1, 1), 0.5)
        low, high = np.array(self.low), np.array(self.high)
        return np.asarray(middle_of(chain) + chain.length * (low + share * (high - low)))


@dataclass(frozen=True, eq=False)
class Points:
    """Goals given one by one.

    Attributes:
        points: (m, 3), in the world [length], or shares of the chain's length from joint 0.
        are_shares: Which of the two.
    """

    points: Array
    are_shares: bool = False

    def __len__(self) -> int:
        return len(self.points)

    def part(self, start: int, stop: int) -> "Points":
        """Return some of the goals."""
        return replace(self, points=self.points[start:stop])

    def positions(self, chain: Chain) -> Array:
        """Return the goals in the world, (m, 3) [length]."""
        if not self.are_shares:
            return self.points
        return np.asarray(middle_of(chain) + chain.length * self.points)


def along(corners: Sequence[Sequence[float]], count: int) -> Points:
    """Return points evenly spaced along straight lines from corner to corner [chain lengths]."""
    ends = np.array(corners, np.float64)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ends, axis=0), axis=1))])
    at = np.linspace(0.0, way[-1], count)
    columns = [np.interp(at, way, ends[:, axis]) for axis in range(3)]
    return Points(np.stack(columns, axis=1), are_shares=True)


Goals = Reach | Grid | Points
