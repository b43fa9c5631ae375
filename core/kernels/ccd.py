"""CCD rounds with limits, from the end side to the base side (000 §6.1(8)-(10), §6.3(10))."""

from limbik.core.jit import kernel
from limbik.core.kernels.frames import place_from
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.own import COMPLIANCE
from limbik.core.kernels.rotation import (
    Vector,
    add,
    has_direction,
    matrix,
    rotate,
    rotate_back,
    subtract,
    unit,
    vector,
)
from limbik.core.kernels.turn import turn_joint


@kernel
def ccd_round(
    strength: float, goal: Vector, body: Body, options: Options, plugs: Plugs, pose: Pose
) -> bool:
    """Turn every joint once so that the end moves toward the goal.

    A joint turns about the axis across joint→end and joint→goal. Joints held from base or end
    and those past the allowed violations in a row are left out.

    Args:
        strength: Share of each turn that is made, 0..1.
        goal: World [length].
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        pose: Changed in place; world frames are renewed at the end of the round.

    Returns:
        Whether any joint moved.
    """
    n, first = body.offsets.shape[0], options.held_base
    end = vector(pose.positions, n - 1)
    moved = False
    for joint in range(n - 2 - options.held_end, first - 1, -1):
        if not pose.moves[joint] or 0 < options.max_violations < pose.violations[joint]:
            continue
        origin, parent = vector(pose.positions, joint), matrix(pose.parent, joint)
        local = rotate_back(
            matrix(pose.relative, joint), rotate_back(parent, subtract(end, origin))
        )
        operating = unit(local)
        target = unit(rotate_back(parent, subtract(goal, origin)))
        if not has_direction(operating) or not has_direction(target):
            continue
        share = strength * pose.own[joint, COMPLIANCE]
        if turn_joint(joint, operating, target, share, True, pose, options, plugs):
            moved = True
            end = add(origin, rotate(parent, rotate(matrix(pose.relative, joint), local)))
    if moved:
        place_from(first, body, pose)
    return moved
