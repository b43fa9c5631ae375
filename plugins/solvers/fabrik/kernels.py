"""FABRIK for chains of joints with heading, pitch and bank, compiled (001; G-05).

The backward pass pulls the places to the goal, limits left aside. The forward pass turns each
joint, base first, toward where its bone's far end was put, as near as its limits let it. A round of
limited turns toward the goal follows: it frees joints whose limits pulled each other stuck.
"""

from math import inf, pi
from typing import NamedTuple

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.re_aim import re_aim
from limbik.core.kernels.rotation import (
    add,
    clamp,
    has_direction,
    hpb_to_matrix,
    matrix,
    multiply,
    norm,
    rotate,
    rotate_back,
    scale,
    store_matrix,
    store_vector,
    subtract,
    unit,
    vector,
)
from limbik.core.rotation import Array

REACHED, STOPPED, OUT_OF_REACH = 0, 1, 2
STARTS = 24
GAIN = 1e-3  # a round that gains a smaller share of the error is stuck
PRIMES = (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37)


class Limb(NamedTuple):
    """A chain of n joints."""

    offsets: Array
    """(n, 3) [length]; joint 0's is from the base."""
    frozen: Array
    """(n, 3, 3)."""
    low: Array
    """(n, 3) [rad]; -inf where free."""
    high: Array
    """(n, 3) [rad]."""
    base_position: Array
    """(1, 3) [length]."""
    base_rotation: Array
    """(1, 3, 3)."""


class Pose(NamedTuple):
    """The working pose of n joints."""

    angles: Array
    """HPB, (n, 3) [rad]."""
    places: Array
    """World positions, (n, 3) [length]."""
    parents: Array
    """Parent world x frozen, (n, 3, 3)."""
    world: Array
    """World rotations, (n, 3, 3)."""
    pulled: Array
    """Where the backward pass puts the joints, (n, 3) [length]."""


@kernel
def _place(first: int, limb: Limb, pose: Pose) -> None:
    """Make places and rotations of the angles, from a joint on."""
    for i in range(first, pose.angles.shape[0]):
        _place_one(i, limb, pose)


@kernel
def _place_one(i: int, limb: Limb, pose: Pose) -> None:
    """Make place and rotation of one joint whose parent has them."""
    before = matrix(limb.base_rotation, 0) if i == 0 else matrix(pose.world, i - 1)
    origin = vector(limb.base_position, 0) if i == 0 else vector(pose.places, i - 1)
    store_vector(add(origin, rotate(before, vector(limb.offsets, i))), pose.places, i)
    parent = multiply(before, matrix(limb.frozen, i))
    store_matrix(parent, pose.parents, i)
    store_matrix(multiply(parent, hpb_to_matrix(vector(pose.angles, i))), pose.world, i)


@kernel
def _backward(goal: tuple[float, float, float], limb: Limb, pose: Pose) -> None:
    """Pull the places to the goal, the end first, each bone keeping its length."""
    at = goal
    for i in range(pose.angles.shape[0] - 1, 0, -1):
        store_vector(at, pose.pulled, i)
        way = unit(subtract(vector(pose.places, i - 1), at))
        at = add(at, scale(way, norm(vector(limb.offsets, i))))


@kernel
def _forward(limb: Limb, pose: Pose) -> None:
    """Turn each joint toward where its bone's far end was pulled, the base first."""
    last = pose.angles.shape[0] - 1
    for i in range(last):
        _place_one(i, limb, pose)
        operating = unit(vector(limb.offsets, i + 1))
        way = unit(subtract(vector(pose.pulled, i + 1), vector(pose.places, i)))
        if has_direction(operating) and has_direction(way):
            _turn(i, operating, way, limb, pose)
            _place_one(i, limb, pose)
    _place_one(last, limb, pose)


@kernel
def _turns(goal: tuple[float, float, float], limb: Limb, pose: Pose) -> None:
    """Turn each joint so that the end points at the goal, the end's side first."""
    last = pose.angles.shape[0] - 1
    for i in range(last - 1, -1, -1):
        here = vector(pose.places, i)
        operating = unit(
            rotate_back(matrix(pose.world, i), subtract(vector(pose.places, last), here))
        )
        way = unit(subtract(goal, here))
        if has_direction(operating) and has_direction(way):
            _turn(i, operating, way, limb, pose)
            _place(i, limb, pose)


@kernel
def _turn(
    i: int,
    operating: tuple[float, float, float],
    way: tuple[float, float, float],
    limb: Limb,
    pose: Pose,
) -> None:
    """Bring a vector of joint i's frame as near to a world direction as its limits let."""
    aim = rotate_back(matrix(pose.parents, i), way)
    low, high = vector(limb.low, i), vector(limb.high, i)
    angles, _ = re_aim(vector(pose.angles, i), low, high, operating, aim)
    store_vector(angles, pose.angles, i)


@kernel
def _set_start(number: int, near: Array, limb: Limb, pose: Pose) -> None:
    """Take the pose to stay near, or a point of a sequence that spreads over the ranges."""
    for i in range(near.shape[0]):
        for axis in range(3):
            low, high = limb.low[i, axis], limb.high[i, axis]
            angle = near[i, axis]
            if number > 0:
                place = 3 * i + axis
                index, value, share = number + place // len(PRIMES), 0.0, 1.0
                prime = PRIMES[place % len(PRIMES)]
                while index > 0:
                    share /= prime
                    value += share * (index % prime)
                    index //= prime
                first, last = (low, high) if high < inf else (-pi / 2.0, pi / 2.0)
                angle = first + (last - first) * value
            pose.angles[i, axis] = clamp(angle, low, high)


@kernel
def _error(goal: tuple[float, float, float], pose: Pose) -> float:
    """Return the distance of the end from the goal [length]."""
    return norm(subtract(vector(pose.places, pose.places.shape[0] - 1), goal))


@kernel
def _run(
    goal: tuple[float, float, float], tolerance: float, most: int, limb: Limb, pose: Pose
) -> int:
    """Repeat rounds until the goal is reached or a round gains too little; return the rounds."""
    before = _error(goal, pose)
    for used in range(most):
        if before <= tolerance:
            return used
        _backward(goal, limb, pose)
        _forward(limb, pose)
        if _error(goal, pose) > tolerance:
            _turns(goal, limb, pose)
        error = _error(goal, pose)
        if error > before * (1.0 - GAIN):
            return used + 1
        before = error
    return most


@entry
def solve_goals(
    limb: Limb,
    goals: Array,
    tolerance: float,
    most: int,
    chained: bool,
    near: Array,
    angles: Array,
    numbers: Array,
) -> None:
    """Solve many goals.

    Args:
        limb: The chain, n joints.
        goals: World positions, (m, 3) [length].
        tolerance: Distance that counts as reached [length].
        most: Rounds at most from each starting pose.
        chained: Whether each goal starts from the pose of the one before.
        near: Pose to start from, HPB, (n, 3) [rad]; changed if chained.
        angles: OUT: HPB, (m, n, 3) [rad], within the limits.
        numbers: OUT: status and rounds, (m, 2).
    """
    n = limb.offsets.shape[0]
    pose = Pose(
        np.zeros((n, 3)),
        np.zeros((n, 3)),
        np.zeros((n, 3, 3)),
        np.zeros((n, 3, 3)),
        np.zeros((n, 3)),
    )
    whole = 0.0
    for i in range(1, n):
        whole += norm(vector(limb.offsets, i))
    for row in range(goals.shape[0]):
        goal = vector(goals, row)
        least, rounds, state = inf, 0, STOPPED
        for number in range(STARTS):
            _set_start(number, near, limb, pose)
            _place(0, limb, pose)
            if number == 0 and norm(subtract(goal, vector(pose.places, 0))) > whole + tolerance:
                state = OUT_OF_REACH
            rounds += _run(goal, tolerance, most, limb, pose)
            error = _error(goal, pose)
            if error < least:
                least = error
                angles[row] = pose.angles
            if least <= tolerance or state == OUT_OF_REACH:
                break
        if chained:
            near[:] = angles[row]
        numbers[row, 0] = REACHED if least <= tolerance else state
        numbers[row, 1] = rounds
