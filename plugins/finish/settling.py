"""Of all poses whose end is in one place, the one next to the pose in HOME."""

from math import inf

from limbik.core.jit import kernel
from limbik.core.kernels.limit import WAY as TASK_WAY
from limbik.core.kernels.rotation import Vector, subtract, wrap_angle
from limbik.core.rotation import Array
from limbik.plugins.finish.bars import accept, forget
from limbik.plugins.finish.linkage import (
    ANGLES,
    HOME,
    OWN_STEP,
    WAY,
    Linkage,
    end_at,
    find_motions,
    has_limit,
    own_task,
    read,
    write,
)
from limbik.plugins.finish.steps import find_step, take_step

LONGEST_STEP = 0.35  # [rad]; the end strays with its square
STEPS = 8
STILL = 1e-3  # [rad]; a shorter step ends it
DAMPING = 1e-6  # keeps a stretched limb solvable


@kernel
def settle(place: Vector, chain: Linkage, scratch: Array) -> None:
    """Move the angles toward HOME as far as limits and the end's place allow.

    Every step is the shortest way to HOME that keeps the end in its place to first order. So what
    is left of the detours of a search are the turns that the place asks for, and places near
    each other get poses near each other.

    Args:
        place: Where the end is to stay, world [length]; it strays a little.
        chain: The chain.
        scratch: (n, WIDTH); its ANGLES are changed, inside the limits.
    """
    forget(scratch)
    for _ in range(STEPS):
        end = end_at(ANGLES, chain, scratch)
        find_motions(end, chain, scratch)
        _find_way(chain, scratch)
        find_step(subtract(place, end), DAMPING, chain, scratch)
        most = take_step(LONGEST_STEP, chain, scratch)
        accept(scratch)
        if most < STILL:
            break


@kernel
def _find_way(chain: Linkage, scratch: Array) -> None:
    """Write the way from the angles to HOME, the short one round where an axis is free."""
    for joint in range(chain.offsets.shape[0]):
        if has_limit(joint, scratch):
            own_task(TASK_WAY, joint, ANGLES, WAY, scratch)
            write(read(scratch, joint, OWN_STEP), scratch, joint, WAY)
            continue
        for axis in range(3):
            way = scratch[joint, HOME + axis] - scratch[joint, ANGLES + axis]
            scratch[joint, WAY + axis] = way if chain.high[joint, axis] < inf else wrap_angle(way)
