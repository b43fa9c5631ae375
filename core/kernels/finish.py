"""The stage after CCD: a finish ends the solve at its goal or says that it cannot (M-01)."""

from math import isfinite, isnan

from limbik.core.jit import kernel
from limbik.core.kernels.frames import place_from, renew_angles, set_angles
from limbik.core.kernels.layout import IN_VAIN, LEAST_FOUND, Body, Options, Plugs, Pose
from limbik.core.kernels.reach import least_reach
from limbik.core.kernels.rotation import Vector, clamp, norm, store_vector, subtract, vector
from limbik.core.slots import call_finish

# Numbers of `limbik.core.solution.Status`.
REACHED, STOPPED, OUT_OF_REACH, BLOCKED = 0, 1, 2, 3


@kernel
def status_of(goal: Vector, distance: float, options: Options, pose: Pose) -> int:
    """Return how a solve ended whose end is at a distance from its goal [length]."""
    if distance < options.tolerance:
        return REACHED
    if not spans(goal, options.tolerance, pose):
        return OUT_OF_REACH
    return BLOCKED if pose.verdict[IN_VAIN] == 1.0 else STOPPED


@kernel
def end_solve(goal: Vector, body: Body, options: Options, plugs: Plugs, pose: Pose) -> bool:
    """Let the finish move the pose; keep what it gave inside the limits.

    Args:
        goal: World [length].
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        pose: After CCD; changed in place.

    Returns:
        False where the finish gave something that is not finite.
    """
    n = body.offsets.shape[0]
    for joint in range(n):
        renew_angles(joint, pose)
    _hold(options, pose)
    reachable = spans(goal, options.tolerance, pose)
    store_vector(goal, pose.scratch, 0)
    call_finish(
        plugs.finish,
        pose.scratch[0],
        options.tolerance,
        body.along[n - 1],
        body.offsets,
        body.frozen,
        body.base_position,
        body.base_rotation,
        pose.low,
        pose.high,
        pose.own,
        int(reachable),
        plugs.params[4],
        pose.angles,
        pose.finish_rows,
        pose.verdict,
    )
    total = 0.0  # not finite if any angle is not
    for joint in range(n):
        for axis in range(3):
            total += pose.angles[joint, axis]
            pose.angles[joint, axis] = clamp(
                pose.angles[joint, axis], pose.low[joint, axis], pose.high[joint, axis]
            )
        set_angles(joint, vector(pose.angles, joint), pose)
    place_from(0, body, pose)
    told = isfinite(pose.verdict[IN_VAIN]) and not isnan(pose.verdict[LEAST_FOUND])
    return isfinite(total) and told


@kernel
def _hold(options: Options, pose: Pose) -> None:
    """Close the limits of joints that CCD holds, and of banks that are locked."""
    n = pose.angles.shape[0]
    for joint in range(n):
        held = joint < options.held_base or n - 2 - options.held_end < joint < n - 1
        for axis in range(3):
            if held or (axis == 2 and options.bank_lock and joint > options.root):
                pose.low[joint, axis] = pose.angles[joint, axis]
                pose.high[joint, axis] = pose.angles[joint, axis]


@kernel
def spans(goal: Vector, tolerance: float, pose: Pose) -> bool:
    """Return whether the bones, were they free to fold, could bring the end to a goal.

    Joints without a moving axis join their bones into one. The goal must lie in the shell between
    the folded and the straight chain around the first joint that moves.
    """
    n = pose.positions.shape[0]
    first, last = -1, -1
    total, longest = 0.0, 0.0
    for joint in range(n):
        if not pose.moves[joint] and joint < n - 1:
            continue
        if first < 0:
            first = joint
        else:
            bone = norm(subtract(vector(pose.positions, joint), vector(pose.positions, last)))
            total += bone
            longest = max(longest, bone)
        last = joint
    distance = norm(subtract(goal, vector(pose.positions, max(first, 0))))
    inner = least_reach(total, longest)
    return inner - tolerance < distance < total + tolerance
