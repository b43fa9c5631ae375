"""The 3D solver: all stages of a solve, and many solves, in one compiled call (000 §7.6)."""

from math import atan2, inf, isnan, sqrt

from limbik.core.jit import entry, kernel
from limbik.core.kernels.bend_pose import bend_pose, find_bend_angles, turn_reference_axis
from limbik.core.kernels.bend_vector import find_bend_vector
from limbik.core.kernels.ccd import ccd_round
from limbik.core.kernels.frames import mark_limits, new_pose, place, place_from, renew_angles
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.rotation import (
    copy_matrix,
    copy_vector,
    hpb_to_matrix,
    matrix_to_hpb,
    nearest_form,
    norm,
    normalize,
    rotate,
    rotate_back,
    wrap_angle,
)
from limbik.core.kernels.turn import turn_joint
from limbik.core.rotation import Array
from limbik.core.slots import call_root_control

# Status numbers of `limbik.core.solution.Status`; from FAILED on, one a slot in the order of Plugs.
REACHED = 0
STOPPED = 1
FAILED = 10

# Columns of a solve's numbers.
ITERATIONS, DISTANCE, STATUS, BEND_X, BEND_Y, BEND_Z, BEND_ANGLE, NUMBERS = 0, 1, 2, 3, 4, 5, 6, 7

RENEW_EVERY = 32  # rounds after which free joints' matrices are made from angles again


@entry
def solve_goals(
    body: Body,
    options: Options,
    plugs: Plugs,
    goals: Array,
    fk: Array,
    memory: Array,
    chained: bool,
    angles: Array,
    positions: Array,
    rotations: Array,
    numbers: Array,
    trace: Array,
) -> int:
    """Solve many goals one after the other.

    Args:
        body: The chain, n joints.
        options: Of the solve.
        plugs: Of the solve.
        goals: (m, 3) [length], world.
        fk: FK offsets, HPB, (n, 3) [rad].
        memory: Continuity, (n + 4, 3): see `limbik.core.solution.Continuity`. Ends as the one
            after the last goal.
        chained: Whether each goal continues from the one before; else each starts from `memory`.
        angles: OUT: HPB, (m, n, 3) [rad].
        positions: OUT: (m, n, 3) [length], world.
        rotations: OUT: (m, n, 3, 3), world.
        numbers: OUT: (m, 7): iterations, distance, status, bend vector, bend angle.
        trace: OUT: angles of the last goal's stages, (t, n, 3) [rad]; t = 0 for none.

    Returns:
        How many stages the trace holds.
    """
    n = body.offsets.shape[0]
    pose = new_pose(n)
    kept = memory.copy()
    stages = 0
    for row in range(goals.shape[0]):
        if not chained:
            copy_matrix(kept, memory)
        stages = _solve(body, options, plugs, goals[row], fk, memory, pose, numbers[row], trace)
        copy_matrix(pose.angles, angles[row])
        copy_matrix(pose.positions, positions[row])
        for joint in range(n):
            copy_matrix(pose.world[joint], rotations[row, joint])
    return stages


@kernel
def _solve(
    body: Body,
    options: Options,
    plugs: Plugs,
    goal: Array,
    fk: Array,
    memory: Array,
    pose: Pose,
    numbers: Array,
    trace: Array,
) -> int:
    """Take one goal through all stages; return the number of stages traced."""
    pose.bend_world.fill(0.0)
    failed = FAILED + 2
    stages = 0
    iterations = -2
    if _initial_pose(body, options, plugs, memory, pose):
        stages = _record(stages, pose, trace)
        failed = 0
        if options.max_iterations > -2 and not options.full_fk:
            iterations = -1
            failed, distance = _aim_stage(body, options, plugs, goal, fk, memory, pose)
            stages = _record(stages, pose, trace)
        if options.max_iterations > -1 and not options.full_fk and failed == 0:
            if find_bend_angles(body, options, plugs, distance, pose):
                bend_pose(body, options, plugs, fk, pose)
                stages = _record(stages, pose, trace)
                iterations, stages = _rounds(body, options, plugs, goal, pose, trace, stages)
            else:
                failed = FAILED
    _finish_pose(body, options, fk, memory, pose)
    _write_numbers(options, goal, iterations, failed, pose, numbers)
    return stages


@kernel
def _initial_pose(body: Body, options: Options, plugs: Plugs, memory: Array, pose: Pose) -> bool:
    """Set limits and angles of the initial pose; False where root control gave no number."""
    n = body.offsets.shape[0]
    copy_matrix(body.low, pose.low)
    copy_matrix(body.high, pose.high)
    if plugs.root_control != 0:
        has_previous = int(memory[3, 0])
        last = pose.directions
        for joint in range(n):
            copy_vector(memory[4 + joint] if has_previous else body.rest[joint], last[joint])
        call_root_control(
            plugs.root_control,
            options.root,
            has_previous,
            last,
            plugs.params[2],
            pose.low,
            pose.high,
        )
    for joint in range(n):
        for i in range(3):
            low, high = pose.low[joint, i], pose.high[joint, i]
            if isnan(low) or isnan(high) or low > high:
                return False
            pose.low[joint, i] = min(max(low, body.low[joint, i]), body.high[joint, i])
            pose.high[joint, i] = min(max(high, body.low[joint, i]), body.high[joint, i])
    mark_limits(pose)
    copy_matrix(body.rest, pose.angles)
    if options.from_previous and options.max_iterations > -2 and memory[3, 0] > 0.0:
        copy_vector(memory[0], pose.angles[0])
        copy_vector(memory[1], pose.angles[options.root])
    for joint in range(n):
        for i in range(3):
            pose.angles[joint, i] = min(
                max(pose.angles[joint, i], pose.low[joint, i]), pose.high[joint, i]
            )
        hpb_to_matrix(pose.angles[joint], pose.relative[joint])
        pose.violations[joint] = 0
    place_from(0, body, pose)
    return True


@kernel
def _aim_stage(
    body: Body, options: Options, plugs: Plugs, goal: Array, fk: Array, memory: Array, pose: Pose
) -> tuple[int, float]:
    """Aim, find the bend vector, keep both; return a failure code and the distance root→goal."""
    root, n = options.root, body.offsets.shape[0]
    distance = _aim_pose(body, options, plugs, goal, pose)
    renew_angles(0, pose)
    renew_angles(root, pose)
    copy_vector(pose.angles[0], memory[0])
    copy_vector(pose.angles[root], memory[1])
    failed = 0
    if find_bend_vector(body, options, plugs, goal, memory, pose):
        copy_vector(pose.bend_world, memory[2])
    else:
        failed = FAILED + 1
    if options.off_axis:
        for joint in range(n - 1):
            for i in range(3):
                pose.directions[joint, i] = pose.positions[n - 1, i] - pose.positions[joint, i]
            if not normalize(pose.directions[joint]):
                rotate(body.base_rotation, pose.aim, pose.directions[joint])
    if options.aim_twist and options.max_iterations == -1 and failed == 0:
        turn_reference_axis(body, options, fk, pose)
        place_from(root + 1, body, pose)
    return failed, distance


@kernel
def _aim_pose(body: Body, options: Options, plugs: Plugs, goal: Array, pose: Pose) -> float:
    """Turn every joint's operating vector toward the goal; return the distance root→goal."""
    n, root = body.offsets.shape[0], options.root
    point, away = pose.vectors[20], pose.vectors[21]
    for i in range(3):
        away[i] = goal[i] - pose.positions[0, i]
    if normalize(away):
        for i in range(3):
            point[i] = pose.positions[0, i] + away[i] * body.along[n - 1]
        for joint in range(root):
            place(joint, body, pose)
            _aim_joint(joint, point, body, options, plugs, pose)
            place(joint, body, pose)
    place(root, body, pose)
    for i in range(3):
        away[i] = goal[i] - pose.positions[root, i]
    distance = norm(away)
    if normalize(away):
        for i in range(3):
            point[i] = pose.positions[root, i] + away[i] * options.root_to_end
        for joint in range(root, n - 1):
            place(joint, body, pose)
            _aim_joint(joint, point, body, options, plugs, pose)
            place(joint, body, pose)
    else:
        # The goal is on the root: no direction to aim along, the root's own stands for it.
        rotate(pose.world[root], body.operating[root], away)
    place_from(root, body, pose)
    rotate_back(body.base_rotation, away, pose.aim)
    return distance


@kernel
def _aim_joint(
    joint: int, point: Array, body: Body, options: Options, plugs: Plugs, pose: Pose
) -> None:
    """Turn a joint's operating vector toward a world point (3,), within limits."""
    reach, target, operating = pose.vectors[14], pose.vectors[15], pose.vectors[16]
    for i in range(3):
        reach[i] = point[i] - pose.positions[joint, i]
    rotate_back(pose.parent[joint], reach, target)
    copy_vector(body.operating[joint], operating)
    if normalize(target) and norm(operating) > 0.5:
        turn_joint(joint, operating, target, 1.0, False, pose, options, plugs)


@kernel
def _rounds(
    body: Body,
    options: Options,
    plugs: Plugs,
    goal: Array,
    pose: Pose,
    trace: Array,
    stages: int,
) -> tuple[int, int]:
    """Run CCD rounds until the end is on the goal, nothing moves, or they run out.

    Round k has strength min(k x smoothing, 1), k from 1 (3D A-12). A full-strength round that
    changes nothing ends the loop (3D A-36).
    """
    done = 0
    while done < options.max_iterations and distance_to(goal, pose) >= options.tolerance:
        done += 1
        strength = min(done * options.smoothing, 1.0)
        moved = ccd_round(strength, body, options, plugs, goal, pose)
        if done % RENEW_EVERY == 0:
            for joint in range(body.offsets.shape[0]):
                renew_angles(joint, pose)
        stages = _record(stages, pose, trace)
        if not moved and strength >= 1.0:
            break
    return done, stages


@kernel
def distance_to(goal: Array, pose: Pose) -> float:
    """Return the distance of the end from a goal (3,) [length]."""
    end = pose.positions.shape[0] - 1
    x = goal[0] - pose.positions[end, 0]
    y = goal[1] - pose.positions[end, 1]
    z = goal[2] - pose.positions[end, 2]
    return sqrt(x * x + y * y + z * z)


@kernel
def _record(stages: int, pose: Pose, trace: Array) -> int:
    """Keep the pose's angles in the trace while it has room; return the stages so far."""
    if stages >= trace.shape[0]:
        return stages
    for joint in range(pose.angles.shape[0]):
        renew_angles(joint, pose)
    copy_matrix(pose.angles, trace[stages])
    return stages + 1


@kernel
def _finish_pose(body: Body, options: Options, fk: Array, memory: Array, pose: Pose) -> None:
    """Choose the angles' forms, mix in FK, renew the frames from the angles, keep the pose."""
    n = body.offsets.shape[0]
    near, posed = pose.vectors[14], pose.vectors[15]
    mix = 1.0 if options.full_fk else options.fk_mix
    for joint in range(n):
        copy_vector(memory[4 + joint] if memory[3, 0] > 0.0 else body.rest[joint], near)
        if pose.free[joint]:
            matrix_to_hpb(pose.relative[joint], near[2], posed)
            nearest_form(posed, near)
            for i in range(3):
                pose.angles[joint, i] = wrap_angle(posed[i])
        if mix > 0.0:
            _mix_joint(joint, mix, body, fk, posed, pose)
        for i in range(3):
            if pose.high[joint, i] == inf:
                pose.angles[joint, i] = wrap_angle(pose.angles[joint, i])
        hpb_to_matrix(pose.angles[joint], pose.relative[joint])
    place_from(0, body, pose)
    memory[3, 0] = 1.0
    for joint in range(n):
        copy_vector(pose.angles[joint], memory[4 + joint])


@kernel
def _mix_joint(joint: int, mix: float, body: Body, fk: Array, posed: Array, pose: Pose) -> None:
    """Mix a joint's angles with those of the FK pose, nearest forms, then limits (3D A-45)."""
    for i in range(3):
        posed[i] = body.rest[joint, i] + fk[joint, i]
    if pose.free[joint]:
        nearest_form(posed, pose.angles[joint])
    for i in range(3):
        angle = pose.angles[joint, i] * (1.0 - mix) + posed[i] * mix
        pose.angles[joint, i] = min(max(angle, body.low[joint, i]), body.high[joint, i])


@kernel
def _write_numbers(
    options: Options, goal: Array, iterations: int, failed: int, pose: Pose, numbers: Array
) -> None:
    """Write iterations, distance, status and bend direction of a solve into numbers (7,)."""
    distance = distance_to(goal, pose)
    numbers[ITERATIONS] = iterations
    numbers[DISTANCE] = distance
    if failed != 0:
        numbers[STATUS] = failed
    else:
        numbers[STATUS] = REACHED if distance < options.tolerance else STOPPED
    for i in range(3):
        numbers[BEND_X + i] = pose.bend_world[i]
    local = pose.vectors[14]
    rotate_back(pose.world[options.root], pose.bend_world, local)
    numbers[BEND_ANGLE] = atan2(local[0], local[1])
