"""Compiled rotations: HPB, matrices and vectors of three, written into arrays (000 §4).

Left-handed, Y up; conventions as in `limbik.core.rotation`. Every function writes into its last
argument and allocates nothing.
"""

from math import atan2, cos, hypot, pi, sin, sqrt

from limbik.core.jit import kernel
from limbik.core.rotation import Array

ZERO_TURN = 1e-9  # [rad]; a smaller turn is none (DECISIONS, "zero tolerance")
ZERO_LENGTH = 1e-12  # a vector this short has no direction


@kernel
def wrap_angle(angle: float) -> float:
    """Return an angle [rad] wrapped into (-π, π]."""
    if -pi < angle <= pi:
        return angle
    turned = (pi - angle) % (2.0 * pi)
    return pi - turned


@kernel
def copy_vector(source: Array, out: Array) -> None:
    """Copy a vector (k,) element by element; a slice assignment would allocate."""
    for i in range(out.shape[0]):
        out[i] = source[i]


@kernel
def copy_matrix(source: Array, out: Array) -> None:
    """Copy a matrix (k, l) element by element; a slice assignment would allocate."""
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            out[row, column] = source[row, column]


@kernel
def hpb_to_matrix(hpb: Array, out: Array) -> None:
    """Write RY(heading) RX(pitch) RZ(bank) of angles (3,) [rad] into out (3, 3)."""
    sh, ch = sin(hpb[0]), cos(hpb[0])
    sp, cp = sin(hpb[1]), cos(hpb[1])
    sb, cb = sin(hpb[2]), cos(hpb[2])
    out[0, 0] = ch * cb - sh * sp * sb
    out[0, 1] = ch * sb + sh * sp * cb
    out[0, 2] = -sh * cp
    out[1, 0] = -cp * sb
    out[1, 1] = cp * cb
    out[1, 2] = sp
    out[2, 0] = sh * cb + ch * sp * sb
    out[2, 1] = sh * sb - ch * sp * cb
    out[2, 2] = ch * cp


@kernel
def matrix_to_hpb(matrix: Array, bank: float, out: Array) -> None:
    """Write the HPB angles of a rotation matrix (3, 3) into out (3,) [rad].

    At a pitch of ±90° heading and bank share one axis; `bank` [rad] is kept there (3D A-62).
    """
    level = hypot(matrix[0, 2], matrix[2, 2])
    out[1] = atan2(matrix[1, 2], level)
    if level > 1e-9:
        out[0] = atan2(-matrix[0, 2], matrix[2, 2])
        out[2] = atan2(-matrix[1, 0], matrix[1, 1])
        return
    # Upright: the matrix is RY(h) RX(±90°) RZ(b), a turn about Y by h ± b.
    turn = atan2(matrix[2, 0], matrix[0, 0])
    out[0] = turn + (-bank if matrix[1, 2] > 0.0 else bank)
    out[2] = bank


@kernel
def nearest_form(hpb: Array, reference: Array) -> None:
    """Turn angles (3,) in place into the HPB form nearest to a reference (3,) [rad]."""
    first = 0.0
    second = 0.0
    for axis in range(3):
        hpb[axis] = reference[axis] + wrap_angle(hpb[axis] - reference[axis])
        first += (hpb[axis] - reference[axis]) ** 2
        second += wrap_angle(other_angle(hpb[axis], axis) - reference[axis]) ** 2
    if second < first:
        for axis in range(3):
            other = other_angle(hpb[axis], axis)
            hpb[axis] = reference[axis] + wrap_angle(other - reference[axis])


@kernel
def other_angle(angle: float, axis: int) -> float:
    """Return one angle [rad] of the second HPB form: (h + 180°, 180° - p, b + 180°)."""
    return pi - angle if axis == 1 else angle + pi


@kernel
def rotate(matrix: Array, vector: Array, out: Array) -> None:
    """Write matrix (3, 3) times vector (3,) into out (3,), which must be another array."""
    for row in range(3):
        out[row] = (
            matrix[row, 0] * vector[0] + matrix[row, 1] * vector[1] + matrix[row, 2] * vector[2]
        )


@kernel
def rotate_back(matrix: Array, vector: Array, out: Array) -> None:
    """Write the transpose of matrix (3, 3) times vector (3,) into out (3,), another array."""
    for row in range(3):
        out[row] = (
            matrix[0, row] * vector[0] + matrix[1, row] * vector[1] + matrix[2, row] * vector[2]
        )


@kernel
def multiply(left: Array, right: Array, out: Array) -> None:
    """Write left times right, both (3, 3), into out (3, 3), which must be another array."""
    for row in range(3):
        for column in range(3):
            out[row, column] = (
                left[row, 0] * right[0, column]
                + left[row, 1] * right[1, column]
                + left[row, 2] * right[2, column]
            )


@kernel
def dot(a: Array, b: Array) -> float:
    """Return the scalar product of two vectors (3,)."""
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@kernel
def norm(vector: Array) -> float:
    """Return the length of a vector (3,)."""
    return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@kernel
def normalize(vector: Array) -> bool:
    """Scale a vector (3,) in place to length 1; leave it and return False if it has none."""
    length = norm(vector)
    if not length > ZERO_LENGTH:
        return False
    for axis in range(3):
        vector[axis] /= length
    return True


@kernel
def cross(a: Array, b: Array, out: Array) -> None:
    """Write the vector product of a and b, each (3,), into out (3,), another array."""
    out[0] = a[1] * b[2] - a[2] * b[1]
    out[1] = a[2] * b[0] - a[0] * b[2]
    out[2] = a[0] * b[1] - a[1] * b[0]


@kernel
def angle_between(a: Array, b: Array) -> float:
    """Return the angle between two vectors (3,) [rad], exact near 0 and 180°."""
    x = a[1] * b[2] - a[2] * b[1]
    y = a[2] * b[0] - a[0] * b[2]
    z = a[0] * b[1] - a[1] * b[0]
    return atan2(sqrt(x * x + y * y + z * z), dot(a, b))


@kernel
def make_perpendicular(vector: Array, direction: Array) -> bool:
    """Take the part along a unit direction (3,) out of a vector (3,) in place and normalise it.

    Returns:
        False where nothing is left; the vector is then not usable.
    """
    along = dot(vector, direction)
    for axis in range(3):
        vector[axis] -= along * direction[axis]
    # Twice: after one pass a nearly parallel vector still leans by its own rounding.
    if not normalize(vector):
        return False
    along = dot(vector, direction)
    for axis in range(3):
        vector[axis] -= along * direction[axis]
    return normalize(vector) and abs(along) < 1e-6


@kernel
def turn_about(vector: Array, axis: Array, angle: float, scratch: Array) -> None:
    """Turn a vector (3,) in place about a unit axis (3,) by an angle [rad].

    Positive is the sense in which the axis a x b carries a to b. `scratch` has shape (3,).
    """
    cross(axis, vector, scratch)
    along = dot(axis, vector) * (1.0 - cos(angle))
    for i in range(3):
        vector[i] = vector[i] * cos(angle) + scratch[i] * sin(angle) + axis[i] * along


@kernel
def turn_matrix(matrix: Array, axis: Array, angle: float) -> None:
    """Turn every column of a matrix (3, 3) in place about a unit axis (3,) by an angle [rad]."""
    s, c = sin(angle), cos(angle)
    for column in range(3):
        x, y, z = matrix[0, column], matrix[1, column], matrix[2, column]
        along = (axis[0] * x + axis[1] * y + axis[2] * z) * (1.0 - c)
        matrix[0, column] = x * c + (axis[1] * z - axis[2] * y) * s + axis[0] * along
        matrix[1, column] = y * c + (axis[2] * x - axis[0] * z) * s + axis[1] * along
        matrix[2, column] = z * c + (axis[0] * y - axis[1] * x) * s + axis[2] * along
