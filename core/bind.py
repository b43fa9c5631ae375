"""Bind a 2D solver to a chain's rest pose without moving it (M-04).

A chain at rest seldom has the shape the initial bend would give it, nor does its bend face the
pole. Binding finds three things once: the turn of the IK plane from the pole to the side the chain
is bent to, the twist of the base in that plane, and the bend angles to take off again, so that a
solve whose goal is on the resting end gives the rest pose, and every other one departs from it.
"""

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.errors import InputError
from limbik.core.flatten2d import Planar
from limbik.core.rotation import Array
from limbik.core.solution2d import PlanarSolution, PlaneFrom

if TYPE_CHECKING:
    from limbik.core.solver2d import Solver2D

STRAIGHT: Final = 1e-6  # share of the length by which a chain at rest is bent
STAYS: Final = 1e-8  # share of the length a joint may move, where the bind has failed


def bound(solver: "Solver2D", goal: ArrayLike | None = None) -> "Solver2D":
    """Return a solver that leaves the rest pose where it is when the goal is on its end.

    Args:
        solver: What to bind; its twist is replaced.
        goal: Where the goal is, (3,) [length]; the resting end if left out.

    Returns:
        A new solver with `settings.twist` as found.

    Raises:
        InputError: The goal is not on the resting end, the end rests on the base, or the rest pose
            is outside the planar limits.
    """
    chain = solver.chain
    positions, rotations = chain.rest_pose
    end = positions[-1] if goal is None else np.asarray(goal, np.float64)
    gap = float(np.linalg.norm(end - positions[-1]))
    if not gap <= solver.settings.tolerance:
        raise InputError(
            f"bind: the goal is {gap:.3g} from the chain's resting end, which must be on it; "
            "leave the goal out to put it there"
        )
    if np.linalg.norm(positions[-1] - positions[0]) <= STRAIGHT * chain.length:
        raise InputError("bind: the end rests on the base, so base and goal give no line")
    end = positions[-1]
    # Fresh, so that binding a bound solver again is binding it once.
    planar = solver._planar._replace(keeps_shape=True, bound=np.zeros(len(chain)), pole_turn=0.0)
    free = _without_limits(planar)
    aimed = _stage(solver, free, -1, end)
    if aimed.plane_from == PlaneFrom.POLE:
        turn = _pole_turn(aimed.plane, positions, chain.length)
        planar, free = planar._replace(pole_turn=turn), free._replace(pole_turn=turn)
        aimed = _stage(solver, free, -1, end)
    twist = 0.0
    if not planar.axis_free:
        left = aimed.plane.T @ rotations[0] @ aimed.rotations[0].T @ aimed.plane
        twist = float(np.degrees(np.arctan2(left[1, 2], left[1, 1])))
    aimed = _stage(solver, free, -1, end, twist)
    bent = _stage(solver, free, 0, end, twist)
    angles = np.cumsum(bent.planar_angles - aimed.planar_angles)
    angles[-1] = 0.0
    found = solver.variant(planar._replace(bound=np.ascontiguousarray(angles)), twist=twist)
    _check_stays(found, end, positions)
    return found


def _without_limits(planar: Planar) -> Planar:
    """Return the same chain without planar limits, its bend starting at the same joint."""
    free = np.full_like(planar.low, np.inf)
    return planar._replace(low=-free, high=free, limited=False)


def _stage(
    solver: "Solver2D", planar: Planar, stage: int, goal: Array, twist: float = 0.0
) -> PlanarSolution:
    """Solve up to the aim (-1) or bend pose (0), without FK."""
    changed = solver.variant(planar, twist=twist, max_iterations=stage, ik=True, fk_mix=0.0)
    return changed.solve(goal)


def _pole_turn(plane: Array, positions: Array, length: float) -> float:
    """Return the turn about the line base→end from the pole to the side the rest is bent to [rad].

    0 where the rest pose is straight.
    """
    sides = (positions[1:-1] - positions[0]) @ plane[:, 1:]
    bent = sides.sum(axis=0) if len(sides) else np.zeros(2)
    if np.hypot(*bent) <= STRAIGHT * length:
        return 0.0
    return float(-np.arctan2(bent[1], bent[0]))


def _check_stays(solver: "Solver2D", goal: Array, positions: Array) -> None:
    """Refuse a bind whose rest pose the limits do not let stay."""
    if not solver.settings.ik or solver.settings.max_iterations < 0:
        return
    moved = solver.solve(goal)
    if np.abs(moved.positions - positions).max() <= STAYS * solver.chain.length:
        return
    touched = ", ".join(moved.limits_touched()) or "a fixed joint"
    raise InputError(
        f"bind: the rest pose is outside the planar limits ({touched}); move it inside, or widen "
        "the range"
    )
