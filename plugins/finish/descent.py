"""A damped Newton descent of the end's distance to the goal, inside the limits.

The step of smallest norm that removes the error to first order (Levenberg-Marquardt on the 3 x 3
side of the problem).
"""

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import Vector, norm, subtract
from limbik.core.rotation import Array
from limbik.plugins.finish.bars import accept, forget
from limbik.plugins.finish.linkage import (
    ANGLES,
    TRIAL,
    WAY,
    Linkage,
    end_at,
    find_motions,
    write,
)
from limbik.plugins.finish.steps import find_step, take_step

LONGEST_STEP = 0.7  # [rad]; a longer step leaves the range where the first order says something
NO_STEP = 1e-15  # [rad]; a shorter step changes no angle
# Damping of `find_step`: less after each step that led nearer, more after one that did not.
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 1e-3, 1e-12, 1e6
RELAX, TIGHTEN = 0.1, 8.0


@kernel
def descend(
    goal: Vector,
    tolerance: float,
    steps: int,
    least_gain: float,
    chain: Linkage,
    scratch: Array,
) -> float:
    """Move the angles of the scratch so that the end comes nearer to the goal.

    Args:
        goal: World [length].
        tolerance: Distance at which to stop [length].
        steps: Most steps tried.
        least_gain: A step that removes a smaller share of the distance, or of a tenth of the
            length if that is less, ends the descent.
        chain: The chain.
        scratch: (n, WIDTH); its ANGLES are changed, inside the limits.

    Returns:
        The distance left [length]; never more than before.
    """
    forget(scratch)
    for joint in range(chain.offsets.shape[0]):
        write((0.0, 0.0, 0.0), scratch, joint, WAY)
    error = subtract(goal, end_at(ANGLES, chain, scratch))
    distance = norm(error)
    damping = FIRST_DAMPING
    for _ in range(steps):
        if distance <= tolerance:
            break
        find_motions(subtract(goal, error), chain, scratch)
        find_step(error, damping, chain, scratch)
        if not take_step(LONGEST_STEP, chain, scratch) > NO_STEP:
            break
        tried = subtract(goal, end_at(TRIAL, chain, scratch))
        left = norm(tried)
        if left < distance:
            small = distance - left < least_gain * min(distance, 0.1 * chain.length)
            accept(scratch)
            error, distance = tried, left
            damping = max(damping * RELAX, LEAST_DAMPING)
            if small:
                break
        else:
            if damping > MOST_DAMPING:
                break
            damping *= TIGHTEN
            end_at(ANGLES, chain, scratch)
    return distance
