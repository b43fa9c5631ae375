"""Pole rotors: how far the frame that carries the pole turns for a goal (000 §6.2)."""

from math import atan2, isnan, nan
from typing import NamedTuple

from limbik.core.jit import entry, kernel
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    across,
    add,
    column,
    cross,
    dot,
    has_direction,
    hpb_to_matrix,
    matrix,
    multiply,
    norm,
    rotate,
    rotation_vector,
    scale,
    store_matrix,
    store_vector,
    subtract,
    transposed,
    turn_about,
    turn_by,
    unit,
    vector,
    wrap_angle,
)
from limbik.core.rotation import Array

HALF_TURN = 1e-6  # [rad]; a turn this near to half a turn (or to none) has no axis of its own


class Rotor(NamedTuple):
    """A pole rotor and the rest pose of its chain."""

    swing: float
    twist: float
    tilt: float
    orient_goal: bool
    sync_z: bool
    places: Array
    """Base, pole at rest, unit vector base→end at rest, world, (3, 3) [length]."""
    axes: Array
    """Axes of the base and of the end at rest, as columns, (2, 3, 3)."""


@entry
def turn_rotor(rotor: Rotor, goals: Array, turns: Array, poles: Array, frames: Array) -> None:
    """Turn a rotor and its pole for goals that have nothing to do with each other.

    Args:
        rotor: The rotor.
        goals: World positions, (m, 3) [length].
        turns: How the goals are turned, HPB, (m, 3) [rad]; NaN for goals without.
        poles: Becomes where the pole is, world, (m, 3) [length].
        frames: Become the axes of rotor and goal in the world, as columns, (2, m, 3, 3); NaN for
            goals that have none.
    """
    base, pole = vector(rotor.places, 0), vector(rotor.places, 1)
    home = matrix(rotor.axes, 0)
    from_base = rotate(transposed(home), subtract(pole, base))
    for row in range(goals.shape[0]):
        turned, turn = not isnan(turns[row, 0]), _no_turn()
        if turned:
            turn = hpb_to_matrix(vector(turns, row))
        frame = _rotor_frame(rotor, vector(goals, row), turned, turn)
        goal = turn
        if not turned and rotor.orient_goal:
            goal = frame
        elif not turned and rotor.sync_z:
            goal = align_z(matrix(rotor.axes, 1), frame)
        store_matrix(frame, frames[0], row)
        store_matrix(goal, frames[1], row)
        store_vector(add(base, rotate(frame, from_base)), poles, row)


@kernel
def _no_turn() -> Matrix:
    return (nan, nan, nan), (nan, nan, nan), (nan, nan, nan)


@kernel
def _rotor_frame(rotor: Rotor, goal: Vector, turned: bool, turn: Matrix) -> Matrix:
    """Return the rotor's axes for a goal, which may be turned.

    A goal's turn, seen from the end after the chain's shortest turn to it, is a twist about the
    line base→goal followed by a tilt across it. All shares at 1 carry the rotor with the goal.
    """
    base, pole, start = vector(rotor.places, 0), vector(rotor.places, 1), vector(rotor.places, 2)
    line = unit(subtract(goal, base))
    if not has_direction(line):
        line = start
    # A goal opposite to the rest pose is turned to in the plane of rest line and pole.
    axis, angle = shortest_axis(start, line, cross(start, subtract(pole, base)))
    frame = multiply(turn_about(axis, angle * rotor.swing), matrix(rotor.axes, 0))
    if not turned:
        return frame
    swung = multiply(turn_about(axis, angle), matrix(rotor.axes, 1))
    left = multiply(turn, transposed(swung))
    twist = _twist(left, line)
    tilt = rotation_vector(multiply(left, turn_about(line, -twist)))
    frame = multiply(turn_about(line, rotor.twist * twist), frame)
    frame = multiply(turn_by(scale(tilt, rotor.tilt)), frame)
    return align_z(frame, turn) if rotor.sync_z else frame


@kernel
def align_z(frame: Matrix, to: Matrix) -> Matrix:
    """Return axes turned the shortest way until their Z axis is that of others."""
    axis, angle = shortest_axis(column(frame, 2), column(to, 2), column(frame, 0))
    return multiply(turn_about(axis, angle), frame)


@kernel
def shortest_axis(start: Vector, target: Vector, spare: Vector) -> tuple[Vector, float]:
    """Return unit axis and angle [rad] of the shortest turn between unit vectors.

    Args:
        start: From here.
        target: To here.
        spare: Axis of a half turn, as far as it is across the start.
    """
    side = cross(start, target)
    angle = atan2(norm(side), dot(start, target))
    if norm(side) > HALF_TURN:
        return unit(side), angle
    axis = across(spare, start)
    if not has_direction(axis):
        axis = across((start[2], start[0], start[1]), start)
    return axis, angle


@kernel
def _twist(turn: Matrix, axis: Vector) -> float:
    """Return the part of a rotation that is about a unit axis, (-π, π] [rad]."""
    skew = (turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1])
    trace = turn[0][0] + turn[1][1] + turn[2][2]
    return wrap_angle(2.0 * atan2(dot(skew, axis), max(1.0 + trace, 0.0)))
