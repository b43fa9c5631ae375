"""IK↔FK match: change between the two, and between bend-vector modes, without a jump (M-06).

From an FK pose: the goal, bend vector and twist with which the solver makes that pose, as nearly as
its initial bend allows. From an IK pose: the FK offsets that make it.
"""

from dataclasses import dataclass, replace
from math import atan2, cos, degrees, radians, sin
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import Chain
from limbik.core.errors import InputError
from limbik.core.flatten import facing_axis
from limbik.core.motion import turn_between
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array, wrap
from limbik.core.solution import Continuity, Solution
from limbik.core.solver import Solver

Mode = Literal["manual", "global"]

CORRECTIONS = 4  # solves that correct the twist by what is left
EXACT = 1e-9  # a difference that is rounding [rad]
BENT = 1e-6  # a limb whose joints are nearer to its line is straight [limb lengths]


@dataclass(frozen=True)
class Match:
    """What makes the solver take an FK pose.

    Attributes:
        goal: World position of the end, (3,) [length].
        bend_vector: Unit vector in the world toward which the limb bends, (3,).
        solver: The solver with bend vector and twist set for the pose.
        solution: What that solver makes of the goal.
        difference: Largest turn between the pose and the solution, of a joint before the end [rad].
    """

    goal: Array
    bend_vector: Array
    solver: Solver
    solution: Solution
    difference: float


def match_ik(solver: Solver, angles: ArrayLike, mode: Mode = "manual") -> Match:
    """Find goal, bend vector and twist that reproduce an FK pose.

    A pose of two bones, and any pose the solver itself could have made, comes back exactly; of
    other poses the end, the bend side and the root's bank do. A straight limb keeps the bend side
    its reference axis faces.

    Args:
        solver: How the limb is solved; its own bend vector and twist are replaced.
        angles: The pose, HPB, (n, 3) [rad].
        mode: How the bend vector is expressed.

    Raises:
        ValueError: The angles have another shape.
        InputError: The angles are not finite.
    """
    positions, rotations = forward_kinematics(solver.chain, angles)
    if not np.isfinite(positions).all():
        raise InputError("angles: every number must be finite")
    root = solver.settings.bend_reference - 1
    goal, side = positions[-1], _bend_side(solver, positions, rotations)
    level = _expressed(solver.altered(twist=0.0), goal, side, mode, None)
    # Without limits the bend pose shows the bank the root takes by itself: a hinge turned the wrong
    # way would make CCD move everything.
    loose = Solver(_without_limits(solver.chain), level.settings, solver.registry)
    untwisted = loose.altered(max_iterations=0).solve(goal)
    twist = _bank_between(untwisted.rotations[root], rotations[root])
    best = None
    for _ in range(CORRECTIONS):
        matched = level.altered(twist=degrees(float(wrap(twist))))
        solution = matched.solve(goal)
        apart = float(turn_between(solution.rotations[:-1], rotations[:-1]).max())
        if best is None or apart < best.difference:
            best = Match(goal, side, matched, solution, apart)
        twist += _bank_between(solution.rotations[root], rotations[root])
        if apart < EXACT:
            break
    assert best is not None
    return best


def match_fk(chain: Chain, angles: ArrayLike) -> Array:
    """Return the FK offsets that make an IK pose.

    With them `ik: false`, or `fk_mix: 1`, gives the pose. While the two are mixed set
    `fk_strength: 0`, or the offsets bend the IK pose as well.

    Args:
        chain: The chain.
        angles: The pose, HPB, (n, 3) [rad].
    """
    return np.asarray(angles, np.float64) - np.clip(chain.rest, chain.low, chain.high)


def convert_bend_vector(
    solver: Solver, goal: ArrayLike, mode: Mode, continuity: Continuity | None = None
) -> Solver:
    """Return a solver that gives a goal the same bend vector in another mode.

    Args:
        solver: With its own mode.
        goal: Where the change happens, world, (3,) [length].
        mode: `manual` or `global`.
        continuity: What the next solve will be given.
    """
    point = np.asarray(goal, np.float64)
    side = solver.altered(max_iterations=-1).solve(point, continuity=continuity).bend_vector
    return _expressed(solver, point, np.asarray(side), mode, continuity)


def _without_limits(chain: Chain) -> Chain:
    """The same chain with all axes free, resting in the same pose."""
    rest = np.clip(chain.rest, chain.low, chain.high).tolist()
    joints = [
        replace(joint, rest=tuple(pose), heading=None, pitch=None, bank=None, limit=None)
        for joint, pose in zip(chain.joints, rest, strict=True)
    ]
    return Chain(joints, chain.base_position, chain.base_turn)


def _bend_side(solver: Solver, positions: Array, rotations: Array) -> Array:
    """Return the unit vector across root→end to the side where the joints between lie."""
    settings, root = solver.settings, solver.settings.bend_reference - 1
    line = _unit(positions[-1] - positions[root], rotations[root, :, 2])
    off = (positions[root + 1 : -1] - positions[root]).sum(axis=0)
    off = off - (off @ line) * line
    if np.linalg.norm(off) > BENT * solver.chain.length:
        return _unit(off, off)
    facing = rotations[root + 1] @ facing_axis(settings)
    facing = facing - (facing @ line) * line
    spare = rotations[root, :, 1] - (rotations[root, :, 1] @ line) * line
    return _unit(facing, spare)


def _unit(vector: Array, spare: Array) -> Array:
    length = float(np.linalg.norm(vector))
    if length > 1e-9:
        return np.asarray(vector / length)
    return np.asarray(spare / max(float(np.linalg.norm(spare)), 1e-9))


def _expressed(
    solver: Solver, goal: Array, side: Array, mode: Mode, continuity: Continuity | None
) -> Solver:
    """Return the solver with a bend vector given in a mode."""
    if mode == "global":
        return solver.altered(bend_vector={"use": "global", "direction": tuple(side.tolist())})
    choice = solver.settings.bend_vector
    excluded = isinstance(choice, dict) and bool(choice.get("exclude_bank", False))
    aiming = solver.altered(
        bend_vector="manual", max_iterations=-1, aim_twist=False, fk_mix=0.0, ik=True
    )
    aimed = aiming.solve(goal, continuity=continuity)
    angle = _manual_angle(solver, aimed, goal, side)
    if excluded and aimed.continuity is not None:
        root = solver.settings.bend_reference - 1
        angle += float(aimed.continuity.aim_root[2] - solver.chain.rest[root, 2])
    shown = degrees(float(wrap(angle)))
    vector = {"use": "manual", "angle": shown, "exclude_bank": excluded}
    return solver.altered(bend_vector=vector)


def _manual_angle(solver: Solver, aimed: Solution, goal: Array, side: Array) -> float:
    """Return the angle about the aimed root's Z at which its Y axis, across the aim, is the side.

    The axes lean against the aim where limits hold the root, so they are compared across it.
    """
    root = solver.settings.bend_reference - 1
    frame = aimed.rotations[root]
    aim = _unit(goal - aimed.positions[root], frame[:, 2])

    def turned(axis: int) -> float:
        return float(np.cross(frame[:, axis], side) @ aim)

    angle = atan2(-turned(1), turned(0))
    facing = sin(angle) * frame[:, 0] + cos(angle) * frame[:, 1]
    return angle if facing @ side > 0.0 else angle + radians(180.0)


def _bank_between(first: Array, second: Array) -> float:
    """Return the angle about Z that brings one frame nearest to another [rad]."""
    turn = first.T @ second
    return float(atan2(turn[0, 1] - turn[1, 0], turn[0, 0] + turn[1, 1]))
