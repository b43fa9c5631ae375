"""What limits let a small chain reach, decided by branch and bound; statuses held against it.

Boxes of angles are halved until every one is proved too far from the goal or a pose near it is
found. A box is too far by a bound on the way the end makes inside it: exact to first order about
its middle, the rest bounded by the lengths of the bones.
"""

from collections import Counter
from collections.abc import Iterator
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics, spread_poses
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.solution import Status
from limbik.core.solver import Solver

Rows = NDArray[np.int64]

MOST_BOXES = 1_000_000
AT_ONCE = 40_000
TOLERANCE = 1e-3  # of the length
BEHIND = 0.01  # of the length; a blocked end may be this much farther than the nearest pose


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
    looked = 0
    boxes = [(0.5 * (low + high)[None], 0.5 * (high - low)[None])]
    while boxes:
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
        looked += len(middle)
        if looked > MOST_BOXES:
            return Decision.OPEN
    return Decision.FAR


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
    return spread_poses(chain, random.random((count, len(chain), 3)))


def audit(joints: int, count: int, seed: int, registry: Registry) -> Counter[str]:
    """Hold the statuses of a random chain's goals against what branch and bound decides.

    A third of the goals are ends of poses inside the limits, a third lies near such ends, a third
    anywhere in and about the reach.

    Args:
        joints: How many turn, 2 to 4.
        count: Goals of each third.
        seed: Of chain and goals.
        registry: Where the solver finds its strategies.

    Returns:
        Numbers of `cases`, of each status, of cases `open` (not decided), `false` (the status is
        not true) and `behind` (blocked, and more than 1 % of the length from the nearest pose).
    """
    random = np.random.default_rng(seed)
    chain = random_chain(random, joints)
    length = chain.length
    ends = forward_kinematics(chain, poses(chain, count, random))[0][:, -1]
    ways = random.normal(size=(2, count, 3))
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    near = ends + ways[0] * length * random.uniform(0.005, 0.2, (count, 1))
    anywhere = ways[1] * length * 1.2 * random.random((count, 1)) ** (1 / 3)
    goals = np.concatenate([ends, near, anywhere])

    tolerance = TOLERANCE * length
    found = Solver(chain, registry=registry, tolerance=tolerance).solve_many(goals)
    status, distance = np.asarray(found.status), np.asarray(found.distance)
    places = forward_kinematics(chain, found.angles)[0][:, -1]
    inside = ((found.angles >= chain.low - 1e-9) & (found.angles <= chain.high + 1e-9)).all((1, 2))
    on_goal = inside & (np.linalg.norm(places - goals, axis=1) < tolerance)
    false = on_goal != (status == Status.REACHED)
    false[:count] |= status[:count] != Status.REACHED
    false |= status == Status.STOPPED

    tally = Counter({Status(kind).label: int((status == kind).sum()) for kind in Status})
    for row in count + np.flatnonzero(status[count:] != Status.REACHED):
        goal, near = goals[row : row + 1], max(tolerance, distance[row] - BEHIND * length)
        (decision,) = decide(chain, goal, np.array([near]))
        if decision == Decision.NEAR:
            tally["behind"] += 1
            (decision,) = decide(chain, goal, np.array([tolerance]))
        tally["open"] += int(decision == Decision.OPEN)
        false[row] |= decision == Decision.NEAR
    return tally + Counter(cases=len(goals), false=int(false.sum()))
