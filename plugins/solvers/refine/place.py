"""Where the hinges' angles put the end, how far off that is, and how each hinge moves it."""

from math import atan2, cos, pi, sin
from typing import NamedTuple

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    add,
    column,
    cross,
    dot,
    hpb_to_matrix,
    matrix,
    multiply,
    norm,
    rotate,
    scale,
    store_matrix,
    store_vector,
    subtract,
    vector,
)
from limbik.core.rotation import Array
from limbik.plugins.solvers.refine.hinges import Hinges, Joints

Pose = tuple[Vector, Matrix]


class Poses(NamedTuple):
    """m poses of n joints, to write into."""

    angles: Array
    """HPB, (m, n, 3) [rad]."""
    positions: Array
    """World, (m, n, 3) [length]."""
    rotations: Array
    """World, (m, n, 3, 3)."""


# Columns of the working rows, one row a hinge.
ANGLE, TRIAL, BEST, NEAR, ACTIVE, STEP = 0, 1, 2, 3, 4, 5
PULLED, ORIGIN, AXIS, MOVES = 6, 7, 10, 13
WIDTH = 19


@kernel
def place(angles: int, hinges: Hinges, rows: Array) -> Pose:
    """Return where the end is, and write every hinge's place and axis in the world.

    An axis is signed so that a growing angle moves a point r away from the hinge by axis x r.

    Args:
        angles: Column of the angles [rad].
        hinges: The chain.
        rows: (k, WIDTH).
    """
    origin = vector(hinges.shift, 0)
    frame = matrix(hinges.before, 0)
    for k in range(rows.shape[0]):
        if k > 0:
            origin = add(origin, rotate(frame, vector(hinges.shift, k)))
            frame = multiply(frame, matrix(hinges.before, k))
        kind = hinges.axis[k]
        s, c = sin(rows[k, angles]), cos(rows[k, angles])
        # The elementary rotations have the sense opposite to the right-hand rule.
        if kind == 0:
            about = column(frame, 1)
            frame = (_about_y(frame[0], s, c), _about_y(frame[1], s, c), _about_y(frame[2], s, c))
        elif kind == 1:
            about = column(frame, 0)
            frame = (_about_x(frame[0], s, c), _about_x(frame[1], s, c), _about_x(frame[2], s, c))
        else:
            about = column(frame, 2)
            frame = (_about_z(frame[0], s, c), _about_z(frame[1], s, c), _about_z(frame[2], s, c))
        for i in range(3):
            rows[k, ORIGIN + i] = origin[i]
            rows[k, AXIS + i] = -about[i]
    last = rows.shape[0]
    origin = add(origin, rotate(frame, vector(hinges.shift, last)))
    return origin, multiply(frame, matrix(hinges.before, last))


@kernel
def place_joints(row: int, joints: Joints, pose: Poses) -> None:
    """Write positions and rotations of all joints at a row's angles.

    This goes joint by joint, not by the hinges, and so checks what these have found.
    """
    origin = vector(joints.base_position, 0)
    frame = matrix(joints.base_rotation, 0)
    for joint in range(joints.offsets.shape[0]):
        origin = add(origin, rotate(frame, vector(joints.offsets, joint)))
        turn = hpb_to_matrix(vector(pose.angles[row], joint))
        frame = multiply(multiply(frame, matrix(joints.frozen, joint)), turn)
        store_vector(origin, pose.positions[row], joint)
        store_matrix(frame, pose.rotations[row], joint)


@kernel
def _about_y(row: Vector, s: float, c: float) -> Vector:
    """Return a matrix' row after a turn by a heading."""
    return c * row[0] + s * row[2], row[1], c * row[2] - s * row[0]


@kernel
def _about_x(row: Vector, s: float, c: float) -> Vector:
    """Return a matrix' row after a turn by a pitch."""
    return row[0], c * row[1] - s * row[2], s * row[1] + c * row[2]


@kernel
def _about_z(row: Vector, s: float, c: float) -> Vector:
    """Return a matrix' row after a turn by a bank."""
    return c * row[0] - s * row[1], s * row[0] + c * row[1], row[2]


@kernel
def rotation_vector(goal: Matrix, found: Matrix) -> Vector:
    """Return the turn from one rotation to another in the world: axis times angle [rad]."""
    # goal x foundᵀ, whose antisymmetric part is the axis times the sine.
    m = (rotate(found, goal[0]), rotate(found, goal[1]), rotate(found, goal[2]))
    around = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1])
    sine = 0.5 * norm(around)
    cosine = 0.5 * (m[0][0] + m[1][1] + m[2][2] - 1.0)
    if sine > 1e-7:
        return scale(around, 0.5 * atan2(sine, cosine) / sine)
    if cosine > 0.0:
        return scale(around, 0.5)
    # Half a turn: the axis is a column of m + 1, the longest is exact.
    first = (m[0][0] + 1.0, m[1][0], m[2][0])
    second = (m[0][1], m[1][1] + 1.0, m[2][1])
    third = (m[0][2], m[1][2], m[2][2] + 1.0)
    axis = first
    if dot(second, second) > dot(axis, axis):
        axis = second
    if dot(third, third) > dot(axis, axis):
        axis = third
    return scale(axis, pi / norm(axis))


@kernel
def write_motions(end: Vector, size: float, turning: bool, rows: Array) -> None:
    """Write how the end moves as each hinge turns: a column of the Jacobian in each row.

    Args:
        end: Where the end is [length].
        size: Length that counts as much as a radian.
        turning: Whether its orientation counts.
        rows: (k, WIDTH), placed.
    """
    for k in range(rows.shape[0]):
        axis = (rows[k, AXIS], rows[k, AXIS + 1], rows[k, AXIS + 2])
        origin = (rows[k, ORIGIN], rows[k, ORIGIN + 1], rows[k, ORIGIN + 2])
        moved = cross(axis, subtract(end, origin))
        for i in range(3):
            rows[k, MOVES + i] = moved[i] / size
            rows[k, MOVES + 3 + i] = axis[i] if turning else 0.0
