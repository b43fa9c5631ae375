"""Compiled vectors and rotations (000 §4), as tuples that live in registers.

A vector is a tuple of three floats, a matrix a tuple of three rows. Left-handed, Y up; conventions
as in `limbik.core.rotation`. `vector`, `matrix` read rows of arrays, `store_` functions write them.
"""

from math import atan2, cos, pi, sin, sqrt

from limbik.core.jit import kernel
from limbik.core.rotation import Array

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
Trig = tuple[float, float, float]
"""An angle [rad], its sine and its cosine."""

ZERO_TURN = 1e-9  # [rad]; a smaller turn is none (DECISIONS, "zero tolerance")
ZERO_LENGTH = 1e-12  # a vector this short has no direction


@kernel
def vector(array: Array, row: int) -> Vector:
    """Read a row of an array (k, 3)."""
    return array[row, 0], array[row, 1], array[row, 2]


@kernel
def store_vector(value: Vector, array: Array, row: int) -> None:
    """Write a row of an array (k, 3)."""
    array[row, 0] = value[0]
    array[row, 1] = value[1]
    array[row, 2] = value[2]


@kernel
def matrix(array: Array, index: int) -> Matrix:
    """Read one matrix of an array (k, 3, 3)."""
    return (
        (array[index, 0, 0], array[index, 0, 1], array[index, 0, 2]),
        (array[index, 1, 0], array[index, 1, 1], array[index, 1, 2]),
        (array[index, 2, 0], array[index, 2, 1], array[index, 2, 2]),
    )


@kernel
def store_matrix(value: Matrix, array: Array, index: int) -> None:
    """Write one matrix of an array (k, 3, 3)."""
    array[index, 0, 0], array[index, 0, 1], array[index, 0, 2] = value[0]
    array[index, 1, 0], array[index, 1, 1], array[index, 1, 2] = value[1]
    array[index, 2, 0], array[index, 2, 1], array[index, 2, 2] = value[2]


@kernel
def copy_rows(source: Array, out: Array) -> None:
    """Copy a matrix element by element; a slice assignment would allocate."""
    for row in range(out.shape[0]):
        for place in range(out.shape[1]):
            out[row, place] = source[row, place]


@kernel
def wrap_angle(angle: float) -> float:
    """Return an angle [rad] wrapped into (-π, π]."""
    if -pi < angle <= pi:
        return angle
    return pi - (pi - angle) % (2.0 * pi)


@kernel
def clamp(value: float, low: float, high: float) -> float:
    """Return a value pulled into low..high."""
    return min(max(value, low), high)


@kernel
def clamp_vector(angles: Vector, low: Vector, high: Vector) -> Vector:
    """Return a triple of angles pulled into ranges."""
    return (
        clamp(angles[0], low[0], high[0]),
        clamp(angles[1], low[1], high[1]),
        clamp(angles[2], low[2], high[2]),
    )


@kernel
def trig(angle: float) -> Trig:
    """Return an angle [rad] with its sine and cosine."""
    return angle, sin(angle), cos(angle)


@kernel
def hpb_to_matrix(hpb: Vector) -> Matrix:
    """Return RY(heading) RX(pitch) RZ(bank) of angles [rad]."""
    return trig_to_matrix(trig(hpb[0]), trig(hpb[1]), trig(hpb[2]))


@kernel
def trig_to_matrix(heading: Trig, pitch: Trig, bank: Trig) -> Matrix:
    """Return RY(heading) RX(pitch) RZ(bank)."""
    _, sh, ch = heading
    _, sp, cp = pitch
    _, sb, cb = bank
    return (
        (ch * cb - sh * sp * sb, ch * sb + sh * sp * cb, -sh * cp),
        (-cp * sb, cp * cb, sp),
        (sh * cb + ch * sp * sb, sh * sb - ch * sp * cb, ch * cp),
    )


@kernel
def matrix_to_hpb(m: Matrix, bank: float) -> Vector:
    """Return the HPB angles of a rotation matrix [rad], |pitch| ≤ 90°.

    At a pitch of ±90° heading and bank share one axis; `bank` [rad] is kept there (3D A-62).
    """
    level = sqrt(m[0][2] * m[0][2] + m[2][2] * m[2][2])
    pitch = atan2(m[1][2], level)
    if level > 1e-9:
        return atan2(-m[0][2], m[2][2]), pitch, atan2(-m[1][0], m[1][1])
    # Upright: the matrix is RY(h) RX(±90°) RZ(b), a turn about Y by h ± b.
    turn = atan2(m[2][0], m[0][0])
    return turn - (bank if m[1][2] > 0.0 else -bank), pitch, bank


@kernel
def other_form(hpb: Vector) -> Vector:
    """Return the second HPB form: (h + 180°, 180° - p, b + 180°), wrapped."""
    return wrap_angle(hpb[0] + pi), wrap_angle(pi - hpb[1]), wrap_angle(hpb[2] + pi)


@kernel
def near(hpb: Vector, reference: Vector) -> Vector:
    """Return angles [rad] moved by whole turns to within a half turn of a reference."""
    return (
        reference[0] + wrap_angle(hpb[0] - reference[0]),
        reference[1] + wrap_angle(hpb[1] - reference[1]),
        reference[2] + wrap_angle(hpb[2] - reference[2]),
    )


@kernel
def nearest_form(hpb: Vector, reference: Vector) -> Vector:
    """Return the HPB form nearest to a reference: least sum of squared differences [rad]."""
    first = near(hpb, reference)
    second = near(other_form(hpb), reference)
    if _square(subtract(second, reference)) < _square(subtract(first, reference)):
        return second
    return first


@kernel
def _square(v: Vector) -> float:
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


@kernel
def rotate(m: Matrix, v: Vector) -> Vector:
    """Return matrix times vector."""
    return (
        m[0][0] * v[0] + m[0][1] * v[1] + m[0][2] * v[2],
        m[1][0] * v[0] + m[1][1] * v[1] + m[1][2] * v[2],
        m[2][0] * v[0] + m[2][1] * v[1] + m[2][2] * v[2],
    )


@kernel
def rotate_back(m: Matrix, v: Vector) -> Vector:
    """Return the transposed matrix times vector."""
    return (
        m[0][0] * v[0] + m[1][0] * v[1] + m[2][0] * v[2],
        m[0][1] * v[0] + m[1][1] * v[1] + m[2][1] * v[2],
        m[0][2] * v[0] + m[1][2] * v[1] + m[2][2] * v[2],
    )


@kernel
def multiply(left: Matrix, right: Matrix) -> Matrix:
    """Return left times right."""
    return (
        rotate_back(right, left[0]),
        rotate_back(right, left[1]),
        rotate_back(right, left[2]),
    )


@kernel
def transposed(m: Matrix) -> Matrix:
    """Return the transposed matrix."""
    return column(m, 0), column(m, 1), column(m, 2)


@kernel
def column(m: Matrix, index: int) -> Vector:
    """Return a column of a matrix."""
    return m[0][index], m[1][index], m[2][index]


@kernel
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@kernel
def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def scale(v: Vector, factor: float) -> Vector:
    """Return a vector times a number."""
    return v[0] * factor, v[1] * factor, v[2] * factor


@kernel
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def norm(v: Vector) -> float:
    """Return the length of a vector."""
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])


@kernel
def unit(v: Vector) -> Vector:
    """Return a vector scaled to length 1, or the zero vector if it has no direction."""
    length = norm(v)
    if not length > ZERO_LENGTH:
        return 0.0, 0.0, 0.0
    return v[0] / length, v[1] / length, v[2] / length


@kernel
def has_direction(v: Vector) -> bool:
    """Return whether what `unit` gave is a direction."""
    return v[0] != 0.0 or v[1] != 0.0 or v[2] != 0.0


@kernel
def angle_between(a: Vector, b: Vector) -> float:
    """Return the angle between two vectors [rad], exact near 0 and 180°."""
    return atan2(norm(cross(a, b)), dot(a, b))


@kernel
def across(v: Vector, direction: Vector) -> Vector:
    """Return the unit vector of v's part across a unit direction; zero where nothing is left."""
    first = unit(subtract(v, scale(direction, dot(v, direction))))
    # Twice: after one pass a nearly parallel vector still leans by its own rounding.
    again = unit(subtract(first, scale(direction, dot(first, direction))))
    if abs(dot(first, direction)) > 1e-6:
        return 0.0, 0.0, 0.0
    return again


@kernel
def turned(v: Vector, axis: Vector, angle: float) -> Vector:
    """Return a vector turned about a unit axis by an angle [rad].

    Positive is the sense in which the axis a x b carries a to b.
    """
    s, c = sin(angle), cos(angle)
    side = cross(axis, v)
    along = dot(axis, v) * (1.0 - c)
    return (
        v[0] * c + side[0] * s + axis[0] * along,
        v[1] * c + side[1] * s + axis[1] * along,
        v[2] * c + side[2] * s + axis[2] * along,
    )


@kernel
def turn_about(axis: Vector, angle: float) -> Matrix:
    """Return the matrix that turns vectors about a unit axis as `turned` does."""
    return axis_trig_to_matrix(axis, sin(angle), cos(angle))


@kernel
def axis_trig_to_matrix(axis: Vector, s: float, c: float) -> Matrix:
    """Return the matrix of a turn about a unit axis by the angle of a sine and a cosine."""
    x, y, z = axis
    d = 1.0 - c
    return (
        (c + x * x * d, x * y * d - z * s, x * z * d + y * s),
        (y * x * d + z * s, c + y * y * d, y * z * d - x * s),
        (z * x * d - y * s, z * y * d + x * s, c + z * z * d),
    )


@kernel
def turn_by(v: Vector) -> Matrix:
    """Return the matrix of a rotation vector: its axis times its angle [rad]."""
    angle = norm(v)
    if not angle > 0.0:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    return turn_about(scale(v, 1.0 / angle), angle)


@kernel
def rotation_vector(m: Matrix) -> Vector:
    """Return axis times angle [rad] of a rotation matrix, 0..π: `turn_by` backwards."""
    twice_sine = (m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1])
    size = norm(twice_sine)
    cosine = m[0][0] + m[1][1] + m[2][2] - 1.0
    angle = atan2(size, cosine)
    if size > 1e-4 or cosine > 0.0:
        return scale(twice_sine, angle / size) if size > 0.0 else (0.0, 0.0, 0.0)
    # Near a half turn: m + mᵀ - 2 cos(angle) is 2 (1 - cos(angle)) a aᵀ; take its longest column.
    xx, yy, zz = 2.0 * m[0][0] - cosine, 2.0 * m[1][1] - cosine, 2.0 * m[2][2] - cosine
    shared = (m[0][1] + m[1][0], m[0][2] + m[2][0], m[1][2] + m[2][1])
    if xx >= yy and xx >= zz:
        axis = unit((xx, shared[0], shared[1]))
    elif yy >= zz:
        axis = unit((shared[0], yy, shared[2]))
    else:
        axis = unit((shared[1], shared[2], zz))
    return scale(axis, -angle if dot(axis, twice_sine) < 0.0 else angle)
