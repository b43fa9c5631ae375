"""The IK space of a 2D solve: base, goal and pole make its axes (000 §6.2(5), §7.5)."""

from math import hypot

from limbik.core.jit import kernel
from limbik.core.kernels.frames import base_rotation
from limbik.core.kernels.layout import Body
from limbik.core.kernels.memory import BEND, FLAGS, HAS_PLANE, LINE
from limbik.core.kernels.planar_layout import FROM_POLE, FROM_REST, KEPT, Planar
from limbik.core.kernels.rotation import (
    ZERO_LENGTH,
    Matrix,
    Vector,
    across,
    add,
    angle_between,
    cross,
    has_direction,
    norm,
    rotate,
    store_vector,
    subtract,
    turn_about,
    turned,
    unit,
    vector,
)
from limbik.core.rotation import Array

ON_BASE = 1e-9  # share of the chain's length within which a goal has no direction


@kernel
def find_plane(
    goal: Vector, pole: Vector, body: Body, planar: Planar, memory: Array
) -> tuple[Matrix, float, int]:
    """Return the axes of the IK space and remember them for the next solve.

    A goal on the base, or a pole on the line base to goal, gives no plane: the last one holds if
    there was one, otherwise the rest pose's line and reference axis (2D 2, 3).

    Args:
        goal: World [length].
        pole: World [length].
        body: The chain.
        planar: Of the solve.
        memory: Continuity, (n + 4, 3): row 0 the line, row 2 the bend vector, [3, 1] whether they
            are a plane's.

    Returns:
        The axes as columns in the world, the distance base to goal [length], where they come from.
    """
    origin = base_origin(body)
    away = subtract(goal, origin)
    distance = norm(away)
    known = memory[FLAGS, HAS_PLANE] > 0.0
    source = FROM_POLE
    line = unit(away)
    bend = (0.0, 0.0, 0.0)
    if distance > ON_BASE * body.along[body.along.shape[0] - 1]:
        bend = across(unit(subtract(pole, origin)), line)
    elif known:
        line, source = vector(memory, LINE), KEPT
    else:
        line = (planar.rest_direction[0], planar.rest_direction[1], planar.rest_direction[2])
        bend, source = across(unit(subtract(pole, origin)), line), FROM_REST
    if has_direction(bend):
        bend = turned(bend, line, -planar.pole_turn)
    elif known:
        bend, source = across(vector(memory, BEND), line), KEPT
    if not has_direction(bend):
        bend, source = _rest_bend(line, planar), FROM_REST
    store_vector(line, memory, LINE)
    store_vector(bend, memory, BEND)
    memory[FLAGS, HAS_PLANE] = 1.0
    normal = cross(line, bend)
    frame = (
        (line[0], bend[0], normal[0]),
        (line[1], bend[1], normal[1]),
        (line[2], bend[2], normal[2]),
    )
    return frame, distance, source


@kernel
def base_origin(body: Body) -> Vector:
    """Return the world position of joint 0 [length]."""
    fastened = (body.base_position[0], body.base_position[1], body.base_position[2])
    return add(fastened, rotate(base_rotation(body), vector(body.offsets, 0)))


@kernel
def _rest_bend(line: Vector, planar: Planar) -> Vector:
    """Return the rest pose's reference axis across a line, after the shortest turn to it."""
    start = (planar.rest_direction[0], planar.rest_direction[1], planar.rest_direction[2])
    axis = (planar.rest_axis[0], planar.rest_axis[1], planar.rest_axis[2])
    bend = across(rotate(shortest_turn(start, line), axis), line)
    if not has_direction(bend):
        bend = across((0.0, 1.0, 0.0), line)
    if not has_direction(bend):
        bend = across((0.0, 0.0, 1.0), line)
    return bend


@kernel
def shortest_turn(start: Vector, target: Vector) -> Matrix:
    """Return the shortest turn from one unit vector to another; a half turn is about Z or X."""
    axis = unit(cross(start, target))
    if not has_direction(axis):
        axis = across((0.0, 0.0, 1.0), start)
    if not has_direction(axis):
        axis = (1.0, 0.0, 0.0)
    return turn_about(axis, angle_between(start, target))


@kernel
def along_x(direction: Vector) -> Matrix:
    """Return the turn about Y and then about Z that carries a direction to X (000 §7.5)."""
    level = hypot(direction[0], direction[2])
    c, s = 1.0, 0.0
    if level > ZERO_LENGTH:
        c, s = direction[0] / level, direction[2] / level
    length = hypot(level, direction[1])
    k, h = level / length, direction[1] / length
    return (k * c, h, k * s), (-h * c, k, -h * s), (-s, 0.0, c)
