"""The chain as a finish sees it: end position and how every axis moves it.

`Linkage` is the fixed part; the working numbers live in rows of a scratch matrix, one row a
joint, in the columns named here.
"""

from math import cos, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from limbik.core.jit import kernel
from limbik.core.kernels.limit import pulled_inside
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    add,
    column,
    cross,
    hpb_to_matrix,
    matrix,
    multiply,
    rotate,
    scale,
    subtract,
    turn_by,
    vector,
)
from limbik.core.rotation import Array

# First columns of the scratch rows, three numbers each.
ANGLES, TRIAL, BEST, START = 0, 3, 6, 9
POSITION, HEADING, PITCH, BANK = 12, 15, 18, 21
TURN = 24
ACTIVE = 27
MARGIN = 30
WIDTH = 31


class Linkage(NamedTuple):
    """A chain of n joints."""

    offsets: Array
    """(n, 3) [length]"""
    frozen: Array
    """(n, 3, 3)"""
    base_position: Array
    """(3,) [length]"""
    base_rotation: Array
    """(3, 3)"""
    low: Array
    """(n, 3) [rad]"""
    high: Array
    """(n, 3) [rad]"""
    limits: NDArray[np.int64]
    """Joints' own limits, (n,); 0 = none."""
    limit_params: Array
    """(n, 16)"""


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
        if chain.limits[joint] != 0:
            for axis in range(3):
                write(column(parent, axis), scratch, joint, HEADING + 3 * axis)
            continue
        # The elementary rotations have the sense opposite to the right-hand rule.
        write(scale(column(parent, 1), -1.0), scratch, joint, HEADING)
        write(scale(rotate(parent, (cos(hpb[0]), 0.0, sin(hpb[0]))), -1.0), scratch, joint, PITCH)
        write(scale(column(frame, 2), -1.0), scratch, joint, BANK)
    return origin


@kernel
def pulled(joint: int, angles: Vector, chain: Linkage, scratch: Array) -> Vector:
    """Return angles pulled into a joint's own limit, which it must have."""
    return pulled_inside(
        chain.limits[joint],
        angles,
        chain.limit_params[joint],
        scratch[joint, TURN : TURN + 3],
        scratch[joint, MARGIN : MARGIN + 1],
    )


@kernel
def turned_by(step: Vector, joint: int, scratch: Array) -> Matrix:
    """Return the rotation of a joint's angles turned on by a rotation vector [rad]."""
    return multiply(turn_by(step), hpb_to_matrix(read(scratch, joint, ANGLES)))


@kernel
def axis_of(joint: int, axis: int, scratch: Array) -> Vector:
    """Return a turning axis of a joint: 0 heading, 1 pitch, 2 bank."""
    return read(scratch, joint, HEADING + 3 * axis)


@kernel
def motion(joint: int, axis: int, end: Vector, scratch: Array) -> Vector:
    """Return how the end moves as one axis turns [length/rad]."""
    return cross(axis_of(joint, axis, scratch), subtract(end, read(scratch, joint, POSITION)))
