"""The chain as a finish sees it: end position and how every axis moves it.

`Linkage` is the fixed part; the working numbers live in rows of a scratch matrix, one row a
joint, in the columns named here.
"""

from math import cos, sin
from typing import NamedTuple

from limbik.core.jit import kernel
from limbik.core.kernels.limit import PULL, do_task
from limbik.core.kernels.own import ANGLES as ANGLES_OF_OWN
from limbik.core.kernels.own import LIMIT, MARGIN, OTHER, STEP, TASK_WIDTH
from limbik.core.kernels.re_aim import FIXED
from limbik.core.kernels.rotation import (
    Vector,
    add,
    column,
    cross,
    hpb_to_matrix,
    matrix,
    multiply,
    norm,
    rotate,
    scale,
    subtract,
    vector,
)
from limbik.core.rotation import Array

# First columns of the scratch rows, three numbers each (AXES: three vectors). ANGLES is the pose
# that is worked on, TRIAL a step and then where it leads, BEST the answer so far, HOME the pose of
# CCD; WAY is how the angles are to go if the end lets them, ACTIVE 1 for axes that may turn.
ANGLES, TRIAL, BEST, HOME = 0, 3, 6, 9
POSITION, AXES, WAY, ACTIVE = 12, 15, 24, 27
OWN = 30  # what a joint's own limit works in, see `limbik.core.kernels.own`
OWN_ANGLES, OWN_STEP, OWN_MARGIN = OWN + ANGLES_OF_OWN, OWN + STEP, OWN + MARGIN
OWN_END = OWN + TASK_WIDTH
# Of a joint with a limit of its own: two gradients KNOWN at its ANGLES, two directions BARRED in
# this step, and the ROOM its ANGLES have to the limit [rad], 0 where nobody knows.
KNOWN, BARRED, ROOM = OWN_END, OWN_END + 6, OWN_END + 12
WIDTH = OWN_END + 13


class Linkage(NamedTuple):
    """A chain of n joints."""

    length: float
    """Sum of the bones [length]"""
    offsets: Array
    """Joint positions in the parent's frame, (n, 3) [length]"""
    frozen: Array
    """Frozen rotations, (n, 3, 3)"""
    base_position: Array
    """World, (3,) [length]"""
    base_rotation: Array
    """Axes of the IK space in the world, (3, 3)"""
    low: Array
    """Limits, (n, 3) [rad]; -inf where free, those of held joints equal"""
    high: Array
    """Limits, (n, 3) [rad]; inf where free"""


@kernel
def turns(joint: int, axis: int, chain: Linkage) -> bool:
    """Return whether an axis has a range to turn in."""
    return bool(chain.high[joint, axis] - chain.low[joint, axis] > FIXED)


@kernel
def read(scratch: Array, row: int, first: int) -> Vector:
    """Read three numbers of a scratch row."""
    return scratch[row, first], scratch[row, first + 1], scratch[row, first + 2]


@kernel
def write(value: Vector, scratch: Array, row: int, first: int) -> None:
    """Write three numbers of a scratch row."""
    scratch[row, first], scratch[row, first + 1], scratch[row, first + 2] = value


@kernel
def copy_columns(source: int, out: int, scratch: Array) -> None:
    """Copy three columns of the scratch."""
    for row in range(scratch.shape[0]):
        write(read(scratch, row, source), scratch, row, out)


@kernel
def end_at(angles: int, chain: Linkage, scratch: Array) -> Vector:
    """Place the chain at the angles of a column and return its end.

    Positions and the three turning axes of every joint are written too. An axis is signed so that
    a growing angle moves a point r away from the joint by axis x r. A joint with a limit of its own
    turns about the axes of its zero pose, by rotation vectors: there such a limit looks alike from
    all sides.

    Args:
        angles: First column of the angles [rad].
        chain: The chain.
        scratch: (n, WIDTH).
    """
    frame = (
        vector(chain.base_rotation, 0),
        vector(chain.base_rotation, 1),
        vector(chain.base_rotation, 2),
    )
    origin = (chain.base_position[0], chain.base_position[1], chain.base_position[2])
    for joint in range(chain.offsets.shape[0]):
        origin = add(origin, rotate(frame, vector(chain.offsets, joint)))
        parent = multiply(frame, matrix(chain.frozen, joint))
        hpb = read(scratch, joint, angles)
        frame = multiply(parent, hpb_to_matrix(hpb))
        write(origin, scratch, joint, POSITION)
        if has_limit(joint, scratch):
            for axis in range(3):
                write(column(parent, axis), scratch, joint, AXES + 3 * axis)
            continue
        # The elementary rotations have the sense opposite to the right-hand rule.
        write(scale(column(parent, 1), -1.0), scratch, joint, AXES)
        if turns(joint, 1, chain):
            pitch = rotate(parent, (cos(hpb[0]), 0.0, sin(hpb[0])))
            write(scale(pitch, -1.0), scratch, joint, AXES + 3)
        write(scale(column(frame, 2), -1.0), scratch, joint, AXES + 6)
    return origin


@kernel
def load_own(own: Array, scratch: Array) -> None:
    """Give the scratch what is each joint's own."""
    for joint in range(own.shape[0]):
        for place in range(TASK_WIDTH):
            scratch[joint, OWN + place] = own[joint, place]


@kernel
def has_limit(joint: int, scratch: Array) -> bool:
    """Return whether a joint has a limit of its own."""
    return bool(scratch[joint, OWN + LIMIT] != 0.0)


@kernel
def pull_inside(angles: int, joint: int, scratch: Array) -> None:
    """Pull the angles of a column into a joint's own limit, if it has one."""
    if has_limit(joint, scratch):
        own_task(PULL, joint, angles, WAY, scratch)
        write(read(scratch, joint, OWN_ANGLES), scratch, joint, angles)


@kernel
def own_task(task: int, joint: int, angles: int, step: int, scratch: Array) -> None:
    """Let a task be done on a joint with a limit of its own, see `do_task`.

    Args:
        task: Which.
        joint: Index.
        angles: First column of the angles [rad].
        step: First column of the step.
        scratch: (n, WIDTH); HOME is the other pose, the results are in OWN_ANGLES and OWN_STEP.
    """
    write(read(scratch, joint, angles), scratch, joint, OWN_ANGLES)
    write(read(scratch, joint, step), scratch, joint, OWN_STEP)
    write(read(scratch, joint, HOME), scratch, joint, OWN + OTHER)
    do_task(task, scratch[joint, OWN:OWN_END])


@kernel
def beyond_reach(goal: Vector, chain: Linkage, scratch: Array) -> float:
    """Return how far a goal lies beyond all bones that can turn, stretched toward it [length].

    Args:
        goal: World [length].
        chain: The chain.
        scratch: (n, WIDTH), its positions found.
    """
    reach, distance = 0.0, 0.0
    for joint in range(chain.offsets.shape[0] - 1, -1, -1):
        if turns(joint, 0, chain) or turns(joint, 1, chain) or turns(joint, 2, chain):
            distance = norm(subtract(goal, read(scratch, joint, POSITION))) - reach
        reach += norm(vector(chain.offsets, joint))
    return distance


@kernel
def axis_of(joint: int, axis: int, scratch: Array) -> Vector:
    """Return a turning axis of a joint: 0 heading, 1 pitch, 2 bank."""
    return read(scratch, joint, AXES + 3 * axis)


@kernel
def find_motions(end: Vector, chain: Linkage, scratch: Array) -> None:
    """Put in place of every turning axis how it moves the end [length/rad]."""
    for joint in range(chain.offsets.shape[0]):
        arm = subtract(end, read(scratch, joint, POSITION))
        for axis in range(3):
            if turns(joint, axis, chain):
                moves = cross(axis_of(joint, axis, scratch), arm)
                write(moves, scratch, joint, AXES + 3 * axis)


@kernel
def motion(joint: int, axis: int, scratch: Array) -> Vector:
    """Return how the end moves as one axis turns, after `find_motions` [length/rad]."""
    return read(scratch, joint, AXES + 3 * axis)
