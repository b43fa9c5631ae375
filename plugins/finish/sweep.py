"""A sweep over the axes, each turned to where it brings the end nearest to the goal."""

from math import atan2

from limbik.core.jit import kernel
from limbik.core.kernels.re_aim import nearest_in_range
from limbik.core.kernels.rotation import Vector, add, cross, dot, subtract, turned, wrap_angle
from limbik.core.rotation import Array
from limbik.plugins.finish.linkage import (
    ANGLES,
    POSITION,
    Linkage,
    axis_of,
    end_at,
    has_limit,
    read,
    turns,
)

BLIND = 1e-12  # [length²]; an axis that hardly moves the end is left alone


@kernel
def sweep(goal: Vector, chain: Linkage, scratch: Array) -> None:
    """Turn axis after axis, end side first and a joint's inner axes first, inside the limits.

    In that order every axis still stands where the forward kinematics put it, so one suffices.

    Args:
        goal: World [length].
        chain: The chain.
        scratch: (n, WIDTH); its ANGLES are changed.
    """
    end = end_at(ANGLES, chain, scratch)
    for joint in range(chain.offsets.shape[0] - 1, -1, -1):
        if has_limit(joint, scratch):
            continue  # the descent turns it
        origin = read(scratch, joint, POSITION)
        reach, target = subtract(end, origin), subtract(goal, origin)
        for axis in range(2, -1, -1):
            if not turns(joint, axis, chain):
                continue
            low, high = chain.low[joint, axis], chain.high[joint, axis]
            about = axis_of(joint, axis, scratch)
            level = dot(reach, target) - dot(about, reach) * dot(about, target)
            aside = dot(about, cross(reach, target))
            if level * level + aside * aside < BLIND * BLIND:
                continue
            angle = scratch[joint, ANGLES + axis]
            wanted = wrap_angle(angle + atan2(aside, level))
            best = nearest_in_range(wanted, angle, low, high)
            scratch[joint, ANGLES + axis] = best
            reach = turned(reach, about, best - angle)
        end = add(origin, reach)
