"""CCD rounds with limits, from the end side to the base side (000 §6.1(8)-(10), §6.3(10))."""

from limbik.core.jit import kernel
from limbik.core.kernels.frames import place_from
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.rotation import copy_vector, normalize, rotate, rotate_back
from limbik.core.kernels.turn import turn_joint
from limbik.core.rotation import Array


@kernel
def ccd_round(
    strength: float, body: Body, options: Options, plugs: Plugs, goal: Array, pose: Pose
) -> bool:
    """Turn every joint once so that the end moves toward the goal.

    A joint turns about the axis across joint→end and joint→goal. Joints held from base or end
    and those past the allowed violations in a row are left out.

    Args:
        strength: Share of each turn that is made, 0..1.
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        goal: (3,) [length], world.
        pose: Changed in place; world frames are renewed at the end of the round.

    Returns:
        Whether any joint moved.
    """
    n = body.offsets.shape[0]
    end = pose.vectors[12]
    copy_vector(pose.positions[n - 1], end)
    first = options.held_base
    moved = False
    for joint in range(n - 2 - options.held_end, first - 1, -1):
        if not pose.moves[joint]:
            continue
        if 0 < options.max_violations < pose.violations[joint]:
            continue
        if _turn_end(joint, strength, body, options, plugs, goal, end, pose):
            moved = True
    if moved:
        place_from(first, body, pose)
    return moved


@kernel
def _turn_end(
    joint: int,
    strength: float,
    body: Body,
    options: Options,
    plugs: Plugs,
    goal: Array,
    end: Array,
    pose: Pose,
) -> bool:
    """Turn one joint and carry the end's position (3,) with it."""
    reach, local = pose.vectors[13], pose.vectors[14]
    operating, target = pose.vectors[15], pose.vectors[16]
    for i in range(3):
        reach[i] = end[i] - pose.positions[joint, i]
    rotate_back(pose.parent[joint], reach, operating)
    rotate_back(pose.relative[joint], operating, local)
    copy_vector(local, operating)
    for i in range(3):
        reach[i] = goal[i] - pose.positions[joint, i]
    rotate_back(pose.parent[joint], reach, target)
    if not normalize(operating) or not normalize(target):
        return False
    if not turn_joint(joint, operating, target, strength, True, pose, options, plugs):
        return False
    rotate(pose.relative[joint], local, reach)
    rotate(pose.parent[joint], reach, target)
    for i in range(3):
        end[i] = pose.positions[joint, i] + target[i]
    return True
