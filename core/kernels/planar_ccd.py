"""CCD of planar joints about the IK plane's normal (000 §6.2(9), §7.5)."""

from math import cos, hypot, inf, pi, sin

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Options
from limbik.core.kernels.planar_bend import place_planar, signed_angle
from limbik.core.kernels.planar_layout import Planar, PlanarPose
from limbik.core.kernels.rotation import ZERO_LENGTH, ZERO_TURN, clamp


@kernel
def find_bounds(planar: Planar, flat: PlanarPose) -> float:
    """Find what keeps the chain on the pole's side through the CCD rounds.

    A chain that leaves the base and comes to the goal on the pole's side, and whose joints between
    all turn back from the pole, lies there as a whole: going along it, the distance from the line
    base to goal first grows and then falls. Rounds keep it so, as far as the initial bend was.

    Args:
        planar: Of the solve.
        flat: In the initial bend pose; its floors and ceilings are set.

    Returns:
        Least angle of the last bone [rad].
    """
    toward = planar.side > 0.0
    for joint in range(flat.after.shape[0]):
        flat.floor[joint] = -inf
        flat.ceiling[joint] = max(flat.relative[joint], 0.0) if toward else inf
    if not toward:
        return -inf
    flat.floor[0] = min(flat.relative[0], 0.0)
    flat.ceiling[0] = max(flat.relative[0], pi)
    last: float = flat.after[flat.after.shape[0] - 1]
    return min(last, -pi)


@kernel
def planar_round(
    strength: float,
    distance: float,
    lowest: float,
    options: Options,
    planar: Planar,
    flat: PlanarPose,
) -> bool:
    """Turn every planar joint once, from the end side to the base, toward the goal on the X axis.

    Joints held from base or end and those past the allowed violations in a row are left out.

    Args:
        strength: Share of each turn that is made, 0..1.
        distance: Base to goal [length].
        lowest: Least angle of the last bone [rad], of `find_bounds`.
        options: Of the solve.
        planar: Of the solve.
        flat: Changed in place.

    Returns:
        Whether any joint moved.
    """
    end = flat.after.shape[0] - 1
    tip = (flat.places[end, 0], flat.places[end, 1])
    moved = False
    last = flat.after[end]
    for joint in range(end - 1 - options.held_end, options.held_base - 1, -1):
        if 0 < options.max_violations < flat.violations[joint]:
            continue
        x, y = flat.places[joint, 0], flat.places[joint, 1]
        to_end, to_goal = (tip[0] - x, tip[1] - y), (distance - x, -y)
        if hypot(to_end[0], to_end[1]) < ZERO_LENGTH or hypot(to_goal[0], to_goal[1]) < ZERO_LENGTH:
            continue
        wanted = flat.relative[joint] + signed_angle(to_end, to_goal) * strength
        kept = clamp(wanted, planar.low[joint], planar.high[joint])
        turn = clamp(kept, flat.floor[joint], flat.ceiling[joint]) - flat.relative[joint]
        turn = max(turn, min(lowest - last, 0.0))
        last += turn
        flat.violations[joint] = flat.violations[joint] + 1 if abs(wanted - kept) > ZERO_TURN else 0
        flat.relative[joint] += turn
        if abs(turn) > ZERO_TURN:
            moved = True
        c, s = cos(turn), sin(turn)
        tip = (x + c * to_end[0] - s * to_end[1], y + s * to_end[0] + c * to_end[1])
    place_planar(0, flat)
    return moved
