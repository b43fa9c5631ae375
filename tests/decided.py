"""What limits let a small chain reach, decided by branch and bound.

Boxes of angles are halved until every one is proved too far from the goal or a pose near it is
found. A box is too far by a bound on the way the end makes inside it: exact to first order about
its middle, the rest bounded by the lengths of the bones.
"""

from collections.abc import Iterator
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics

Array = NDArray[np.float64]
Rows = NDArray[np.int64]

MOST_BOXES = 400_000
AT_ONCE = 40_000


class Decision(IntEnum):
    """What is known of a goal: no pose is nearer than asked, one is, or the boxes ran out."""

    FAR, NEAR, OPEN = 0, 1, 2


def decide(chain: Chain, goals: Array, radii: Array) -> NDArray[np.int64]:
    """Decide for every goal whether a pose within the limits ends nearer than a radius.

    Args:
        chain: A chain of few axes that turn; free axes count as -180..180°.
        goals: (m, 3) [length].
        radii: (m,) [length].

    Returns:
        Decisions, (m,).
    """
    found = np.full(len(goals), Decision.OPEN, np.int64)
    for row, (goal, radius) in enumerate(zip(goals, radii.tolist(), strict=True)):
        found[row] = _decide(chain, goal, radius)
    return found


def _decide(chain: Chain, goal: Array, radius: float) -> Decision:
    axes = np.argwhere(chain.high > chain.low)
    low = np.maximum(chain.low, -np.pi)[axes[:, 0], axes[:, 1]]
    high = np.minimum(chain.high, np.pi)[axes[:, 0], axes[:, 1]]
    reaches = np.array([chain.lengths[joint:].sum() for joint in axes[:, 0]])
    boxes = [(0.5 * (low + high)[None], 0.5 * (high - low)[None])]
    for _ in range(MOST_BOXES // AT_ONCE * 40):
        if not boxes:
            return Decision.FAR
        middle, half = boxes.pop()
        away, motion = _ends(chain, axes, goal, middle)
        distance = np.linalg.norm(away, axis=1)
        if distance.min() < radius:
            return Decision.NEAR
        first = np.abs(np.einsum("bk,bdk->bd", away / distance[:, None], motion))
        later = np.minimum(reaches[:, None], reaches[None, :])
        bend = 0.5 * np.einsum("bi,bj,ij->b", half, half, later)
        nearest = distance - np.minimum((first * half).sum(1) + bend, half @ reaches)
        kept = nearest < radius
        boxes.extend(_halves(middle[kept], half[kept], reaches))
        if sum(len(part) for part, _ in boxes) > MOST_BOXES:
            return Decision.OPEN
    return Decision.OPEN


def _halves(middle: Array, half: Array, reaches: Array) -> Iterator[tuple[Array, Array]]:
    """Cut boxes across the axis that moves the end most; give them back in portions."""
    if not len(middle):
        return
    rows, cut = np.arange(len(middle)), (half * reaches).argmax(axis=1)
    smaller = half.copy()
    smaller[rows, cut] *= 0.5
    shift = np.zeros_like(half)
    shift[rows, cut] = smaller[rows, cut]
    both = np.concatenate([middle - shift, middle + shift])
    sizes = np.concatenate([smaller, smaller])
    for start in range(0, len(both), AT_ONCE):
        yield both[start : start + AT_ONCE], sizes[start : start + AT_ONCE]


def _ends(chain: Chain, axes: Rows, goal: Array, values: Array) -> tuple[Array, Array]:
    """Return end to goal, (b, 3), and how every axis moves the end, (b, axes, 3) [length/rad]."""
    angles = np.zeros((len(values), len(chain), 3)) + np.clip(0.0, chain.low, chain.high)
    angles[:, axes[:, 0], axes[:, 1]] = values
    positions, rotations = forward_kinematics(chain, angles)
    end = positions[:, -1]
    motion = np.empty((len(values), len(axes), 3))
    for place, (joint, axis) in enumerate(axes.tolist()):
        above = rotations[:, joint - 1] if joint else chain.base_rotation
        frame = above @ chain.frozen[joint]
        if axis == 0:
            about = np.broadcast_to(frame[..., :, 1], end.shape)
        elif axis == 1:
            heading = angles[:, joint, 0, None]
            about = np.cos(heading) * frame[..., :, 0] + np.sin(heading) * frame[..., :, 2]
        else:
            about = rotations[:, joint, :, 2]
        motion[:, place] = np.cross(end - positions[:, joint], about)
    return goal - end, motion


def random_chain(random: np.random.Generator, joints: int) -> Chain:
    """Return a chain of joints that turn, and an end; two to four limited axes in all."""
    axes = {(joint, int(random.integers(0, 2))) for joint in range(joints)}
    while len(axes) < min(joints + int(random.integers(0, 2)), 4):
        joint = int(random.integers(0, joints))
        # The last joint's bank does not move the end.
        axes.add((joint, int(random.integers(0, 3 if joint < joints - 1 else 2))))
    made = []
    for joint in range(joints):
        spans = []
        for axis in range(3):
            low = random.uniform(-120.0, 30.0)
            span = (low, low + random.uniform(20.0, 150.0))
            spans.append(span if (joint, axis) in axes else (0.0, 0.0))
        bone = float(random.uniform(0.4, 1.0)) if joint else 0.0
        made.append(Joint.degrees(f"j{joint}", (0, 0, bone), (0, 0, 0), (0, 0, 0), *spans))
    still = Joint.degrees(
        "end", (0, 0, float(random.uniform(0.4, 1.0))), heading=(0, 0), pitch=(0, 0), bank=(0, 0)
    )
    return Chain([*made, still])


def poses(chain: Chain, count: int, random: np.random.Generator) -> Array:
    """Return random poses inside the limits, (count, n, 3) [rad]."""
    low, high = np.maximum(chain.low, -np.pi), np.minimum(chain.high, np.pi)
    return low + (high - low) * random.random((count, len(chain), 3))
