"""The 3D solver: all stages of a solve, and many solves, in one compiled call (000 §7.6)."""

from math import atan2, inf, isnan
from typing import NamedTuple

from limbik.core.jit import entry, kernel
from limbik.core.kernels.bend_pose import bend_pose, find_bend_angles, turn_reference_axis
from limbik.core.kernels.bend_vector import find_bend_vector, usable
from limbik.core.kernels.ccd import ccd_round
from limbik.core.kernels.finish import end_solve, status_of
from limbik.core.kernels.frames import (
    base_rotation,
    clamp_angles,
    distance_to,
    mark_limits,
    new_pose,
    place,
    place_from,
    renew_angles,
    set_angles,
)
from limbik.core.kernels.layout import IN_VAIN, LEAST_FOUND, Bend, Body, Options, Plugs, Pose
from limbik.core.kernels.limit import limits_failed
from limbik.core.kernels.memory import AIM_BASE, AIM_ROOT, FLAGS, HAS_POSE, angles_before, has_pose
from limbik.core.kernels.memory import ANGLES as KEPT_ANGLES
from limbik.core.kernels.memory import BEND as KEPT_BEND
from limbik.core.kernels.mix import mixed, wrap_free
from limbik.core.kernels.rotation import (
    Vector,
    add,
    clamp,
    copy_rows,
    has_direction,
    matrix,
    matrix_to_hpb,
    nearest_form,
    norm,
    rotate,
    rotate_back,
    scale,
    store_vector,
    subtract,
    unit,
    vector,
)
from limbik.core.kernels.soft import soft_distance, soft_goal
from limbik.core.kernels.trace import record
from limbik.core.kernels.turn import turn_joint
from limbik.core.rotation import Array
from limbik.core.slots import call_root_control

# From this status number on, a strategy failed: one a slot in the order of Plugs.
FAILED = 10

# Columns of a solve's numbers; the bend vector takes three.
ITERATIONS, DISTANCE, STATUS, BEND, BEND_ANGLE, NEAREST = 0, 1, 2, 3, 6, 7

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
    """Solve many goals one after the other, each by the first solution found.

    What few solves ask for is in `limbik.core.kernels.solve_fully`, so that no other waits for it
    to be compiled.

    Args:
        body: The chain, n joints.
        options: Of the solve.
        plugs: Of the solve.
        goals: (m, 3) [length], world; further columns are passed over.
        fk: FK offsets, HPB, (n, 3) [rad].
        memory: Continuity, (n + 4, 3): see `limbik.core.solution.Continuity`. Ends as the one
            after the last goal.
        chained: Whether each goal continues from the one before; else each starts from `memory`.
        angles: OUT: HPB, (m, n, 3) [rad].
        positions: OUT: (m, n, 3) [length], world.
        rotations: OUT: (m, n, 3, 3), world.
        numbers: OUT: (m, 8): iterations, distance, status, bend vector, bend angle, nearest.
        trace: OUT: angles of the last goal's stages, (t, n, 3) [rad]; t = 0 for none.

    Returns:
        How many stages the trace holds.
    """
    pose = new_pose(body.offsets.shape[0])
    copy_rows(plugs.own, pose.own)
    kept = memory.copy()
    stages = 0
    for row in range(goals.shape[0]):
        if not chained:
            copy_rows(kept, memory)
        goal = vector(goals, row)
        led = lead(goal, body, options, plugs, fk, memory, pose, trace)
        failed, stages = led.failed, led.stages
        if led.onward and plugs.finish != 0:
            if not end_solve(led.pursued, body, options, plugs, pose):
                failed = FAILED + 4
            pose.verdict[LEAST_FOUND] += norm(subtract(goal, led.pursued))
            stages = record(stages, pose, trace)
        settle_pose(body, options, fk, memory, pose)
        write_numbers(goal, led, failed, options, pose, numbers[row])
        write_pose(pose, angles[row], positions[row], rotations[row])
    return stages


@kernel
def write_pose(pose: Pose, angles: Array, positions: Array, rotations: Array) -> None:
    """Write the angles (n, 3), positions (n, 3) and world rotations (n, 3, 3) of a solved pose."""
    copy_rows(pose.angles, angles)
    copy_rows(pose.positions, positions)
    for joint in range(pose.world.shape[0]):
        copy_rows(pose.world[joint], rotations[joint])


class Led(NamedTuple):
    """Where CCD has led a goal's solve."""

    pursued: Vector
    """What the next stages pursue: the goal, pulled in where there is a soft zone [length]."""
    bend: Vector
    """Bend vector, world."""
    iterations: int
    """Rounds run, or the stage that was asked for."""
    failed: int
    """0, or the status of the strategy that failed."""
    stages: int
    """Traced so far."""
    onward: bool
    """Whether a finish may follow: no strategy failed, and CCD was asked for."""


@kernel
def lead(
    goal: Vector,
    body: Body,
    options: Options,
    plugs: Plugs,
    fk: Array,
    memory: Array,
    pose: Pose,
    trace: Array,
) -> Led:
    """Take one goal through all stages up to the last round of CCD.

    Args:
        goal: World [length].
        body: The chain.
        options: Of the solve.
        plugs: Of the solve.
        fk: FK offsets, HPB, (n, 3) [rad].
        memory: Continuity, (n + 4, 3); keeps the aim pose and the bend vector.
        pose: OUT: how CCD leaves it.
        trace: OUT: the stages, as far as it has room.
    """
    bend_world, pursued = (0.0, 0.0, 0.0), goal
    pose.verdict[IN_VAIN], pose.verdict[LEAST_FOUND] = 0.0, inf
    iterations, failed, stages = -2, 0, 0
    if not _initial_pose(body, options, plugs, memory, pose):
        failed = FAILED + 2
    stages = record(stages, pose, trace)
    onward = failed == 0 and options.max_iterations > 0 and not options.full_fk
    if failed == 0 and options.max_iterations > -2 and not options.full_fk:
        iterations = -1
        aim, distance = _aim_pose(goal, body, options, plugs, memory, pose)
        found = find_bend_vector(aim, goal, body, options, plugs, memory, pose)
        if isnan(found[0]):
            failed = FAILED + 1
        else:
            bend_world = rotate(base_rotation(body), found)
            store_vector(bend_world, memory, KEPT_BEND)
            bend = Bend(aim, usable(found, aim, body, options, pose))
            if options.max_iterations == -1:
                _twist_aim(bend, body, options, fk, pose)
            stages = record(stages, pose, trace)
            pursued = soft_goal(goal, distance, options, pose)
            if options.max_iterations > -1:
                nearer = soft_distance(distance, options.root_to_end, options.soft_zone)
                if find_bend_angles(nearer, body, options, plugs, pose):
                    bend_pose(bend, body, options, plugs, fk, pose)
                    if options.from_current and options.max_iterations > 0:
                        _continue_pose(body, memory, pose)
                    stages = record(stages, pose, trace)
                    iterations, stages = _rounds(pursued, body, options, plugs, pose, trace, stages)
                else:
                    failed = FAILED
    return Led(pursued, bend_world, iterations, failed, stages, onward and failed == 0)


@kernel
def _initial_pose(body: Body, options: Options, plugs: Plugs, memory: Array, pose: Pose) -> bool:
    """Set limits and angles of the initial pose; False where root control gave no number."""
    n, known = body.offsets.shape[0], has_pose(memory)
    copy_rows(body.low, pose.low)
    copy_rows(body.high, pose.high)
    copy_rows(body.rest, pose.angles)
    if plugs.root_control != 0:
        last = pose.directions
        for joint in range(n):
            store_vector(angles_before(joint, body, memory), last, joint)
        call_root_control(
            plugs.root_control,
            options.root,
            int(known),
            last,
            plugs.params[2],
            pose.low,
            pose.high,
        )
        if not _limits_hold(body, pose):
            return False
    mark_limits(pose)
    if options.from_previous and options.max_iterations > -2 and known:
        store_vector(vector(memory, AIM_BASE), pose.angles, 0)
        store_vector(vector(memory, AIM_ROOT), pose.angles, options.root)
    for joint in range(n):
        set_angles(joint, clamp_angles(joint, vector(pose.angles, joint), pose), pose)
        pose.violations[joint] = 0
    place_from(0, body, pose)
    return True


@kernel
def _limits_hold(body: Body, pose: Pose) -> bool:
    """Pull a root control's limits into the joints' own; False where they are none."""
    for joint in range(body.offsets.shape[0]):
        for axis in range(3):
            low, high = pose.low[joint, axis], pose.high[joint, axis]
            if isnan(low) or isnan(high) or low > high:
                return False
            pose.low[joint, axis] = clamp(low, body.low[joint, axis], body.high[joint, axis])
            pose.high[joint, axis] = clamp(high, body.low[joint, axis], body.high[joint, axis])
    return True


@kernel
def _aim_pose(
    goal: Vector, body: Body, options: Options, plugs: Plugs, memory: Array, pose: Pose
) -> tuple[Vector, float]:
    """Turn every joint's operating vector toward the goal (000 §6.3(8)(B)).

    Returns:
        Unit vector root to goal, IK space, and the distance root to goal [length].
    """
    n, root = body.offsets.shape[0], options.root
    base = vector(pose.positions, 0)
    away = unit(subtract(goal, base))
    if has_direction(away):
        point = add(base, scale(away, body.along[n - 1]))
        for joint in range(root):
            _aim_joint(joint, point, body, options, plugs, pose)
    place(root, body, pose)
    origin = vector(pose.positions, root)
    distance = norm(subtract(goal, origin))
    away = unit(subtract(goal, origin))
    if has_direction(away):
        point = add(origin, scale(away, options.root_to_end))
        for joint in range(root, n - 1):
            _aim_joint(joint, point, body, options, plugs, pose)
    else:
        # The goal is on the root: no direction to aim along, the root's own stands for it.
        away = rotate(matrix(pose.world, root), vector(body.operating, root))
    place_from(root, body, pose)
    renew_angles(0, pose)
    renew_angles(root, pose)
    store_vector(vector(pose.angles, 0), memory, AIM_BASE)
    store_vector(vector(pose.angles, root), memory, AIM_ROOT)
    if options.off_axis:
        end = vector(pose.positions, n - 1)
        for joint in range(n - 1):
            direction = unit(subtract(end, vector(pose.positions, joint)))
            store_vector(direction if has_direction(direction) else away, pose.directions, joint)
    return rotate_back(base_rotation(body), away), distance


@kernel
def _aim_joint(
    joint: int, point: Vector, body: Body, options: Options, plugs: Plugs, pose: Pose
) -> None:
    """Turn a joint's operating vector toward a world point, within limits."""
    place(joint, body, pose)
    away = subtract(point, vector(pose.positions, joint))
    target = unit(rotate_back(matrix(pose.parent, joint), away))
    operating = vector(body.operating, joint)
    if has_direction(target) and has_direction(operating):
        turn_joint(joint, operating, target, 1.0, False, pose, options, plugs)
        place(joint, body, pose)


@kernel
def _twist_aim(bend: Bend, body: Body, options: Options, fk: Array, pose: Pose) -> None:
    """Twist the root in an aim pose that is the answer (000 §6.3(11)(M))."""
    if options.aim_twist:
        turn_reference_axis(bend, body, options, fk, pose)
        place_from(options.root + 1, body, pose)


@kernel
def _continue_pose(body: Body, memory: Array, pose: Pose) -> None:
    """Put the pose of the solve before, if there was one, in place of the bend pose (F-02).

    It is pulled into this solve's limits, which a root control may have changed.
    """
    if not has_pose(memory):
        return
    for joint in range(body.offsets.shape[0]):
        set_angles(joint, clamp_angles(joint, vector(memory, KEPT_ANGLES + joint), pose), pose)
    place_from(0, body, pose)


@kernel
def _rounds(
    goal: Vector,
    body: Body,
    options: Options,
    plugs: Plugs,
    pose: Pose,
    trace: Array,
    stages: int,
) -> tuple[int, int]:
    """Run CCD rounds until the end is on the goal, nothing moves, or they run out.

    Round k has strength min(k x smoothing, 1), k from 1 (3D A-12). A full-strength round that
    changes nothing ends the loop (3D A-36).

    Returns:
        Rounds run, stages traced.
    """
    done = 0
    while done < options.max_iterations and distance_to(goal, pose) >= options.tolerance:
        done += 1
        strength = min(done * options.smoothing, 1.0)
        moved = ccd_round(strength, goal, body, options, plugs, pose)
        if done % RENEW_EVERY == 0:
            for joint in range(body.offsets.shape[0]):
                renew_angles(joint, pose)
        stages = record(stages, pose, trace)
        if not moved and strength >= 1.0:
            break
    return done, stages


@kernel
def settle_pose(body: Body, options: Options, fk: Array, memory: Array, pose: Pose) -> None:
    """Choose the angles' forms, mix in FK, renew the frames from the angles, keep the pose."""
    mix = 1.0 if options.full_fk else options.fk_mix
    for joint in range(body.offsets.shape[0]):
        angles = vector(pose.angles, joint)
        if pose.free[joint]:
            reference = angles_before(joint, body, memory)
            found = matrix_to_hpb(matrix(pose.relative, joint), reference[2])
            angles = nearest_form(found, reference)
        if mix > 0.0:
            angles = mixed(joint, angles, mix, body, fk, pose)
        angles = wrap_free(angles, vector(body.high, joint))
        set_angles(joint, angles, pose)
        store_vector(vector(pose.angles, joint), memory, KEPT_ANGLES + joint)
    place_from(0, body, pose)
    memory[FLAGS, HAS_POSE] = 1.0


@kernel
def write_numbers(
    goal: Vector, led: Led, failed: int, options: Options, pose: Pose, numbers: Array
) -> None:
    """Write what a solve says beside its pose into numbers (8,)."""
    distance = distance_to(goal, pose)
    numbers[ITERATIONS] = led.iterations
    numbers[DISTANCE] = distance
    if limits_failed(pose.angles, pose.own):
        numbers[STATUS] = FAILED + 5
    elif failed != 0:
        numbers[STATUS] = failed
    else:
        numbers[STATUS] = status_of(goal, distance, options, pose)
    numbers[BEND], numbers[BEND + 1], numbers[BEND + 2] = led.bend
    local = rotate_back(matrix(pose.world, options.root), led.bend)
    numbers[BEND_ANGLE] = atan2(local[0], local[1])
    numbers[NEAREST] = min(distance, pose.verdict[LEAST_FOUND])
