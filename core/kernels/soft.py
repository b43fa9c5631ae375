"""The soft zone: goals near full extension are pulled in smoothly (M-03).

Near full extension the bend angle is the root of what is left of the reach, so a limb snaps
straight. In the zone the goal's distance is replaced by one that approaches the reach and never
gets there; what the stages pursue is then never where the limb has to be straight.
"""

from math import exp

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Options, Pose
from limbik.core.kernels.rotation import Vector, add, scale, subtract, vector


@kernel
def soft_distance(distance: float, reach: float, zone: float) -> float:
    """Return the distance to pursue instead of a wanted one [length].

    Up to the zone's start a = (1 - zone) reach it is the same; from there on
    a + w (1 - exp(-(distance - a) / w)) where w is the zone's width: slope 1 at a, then falling.

    Args:
        distance: Root to goal [length].
        reach: Root to end of the straight limb [length].
        zone: Share of the reach, 0 = off.
    """
    width = zone * reach
    past = distance - (reach - width)
    if not width > 0.0 or not past > 0.0:
        return distance
    return reach - width * exp(-past / width)


@kernel
def soft_goal(goal: Vector, distance: float, options: Options, pose: Pose) -> Vector:
    """Return the point the stages pursue: on the line root to goal, the root as it is aimed.

    Args:
        goal: World [length].
        distance: Bend root to goal [length].
        options: Of the solve.
        pose: In the aim pose.
    """
    near = soft_distance(distance, options.root_to_end, options.soft_zone)
    if near == distance:
        return goal
    origin = vector(pose.positions, options.root)
    return add(origin, scale(subtract(goal, origin), near / distance))
