"""The 2D solver: all stages of a solve, and many solves, in one compiled call (000 §7.5)."""

from math import atan2, cos, hypot, sin

import numpy as np

from limbik.core.jit import entry, kernel
from limbik.core.kernels.finish import BLOCKED, OUT_OF_REACH, REACHED, STOPPED
from limbik.core.kernels.frames import (
    base_rotation,
    distance_to,
    new_pose,
    place_from,
    set_angles,
)
from limbik.core.kernels.layout import Body, Options, Plugs, Pose
from limbik.core.kernels.memory import ANGLES as KEPT_ANGLES
from limbik.core.kernels.memory import FLAGS, HAS_POSE, angles_before
from limbik.core.kernels.planar_aim import (
    aim_end,
    any_offset,
    apply_offsets,
    face_pole,
    put_initial_pose,
)
from limbik.core.kernels.planar_bend import bend_planar, find_planar_joints
from limbik.core.kernels.planar_ccd import find_bounds, planar_round
from limbik.core.kernels.planar_layout import Planar, PlanarPose
from limbik.core.kernels.plane import find_plane
from limbik.core.kernels.reach import least_reach
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    add,
    column,
    copy_rows,
    matrix,
    matrix_to_hpb,
    multiply,
    nearest_form,
    rotate_back,
    scale,
    store_vector,
    subtract,
    transposed,
    vector,
)
from limbik.core.kernels.soft import soft_distance
from limbik.core.kernels.solve3d import (
    BEND,
    BEND_ANGLE,
    DISTANCE,
    FAILED,
    ITERATIONS,
    STATUS,
    write_pose,
)
from limbik.core.rotation import Array

# Columns of a solve's numbers after those of the 3D solver.
SOURCE, FRAME, ANGLES = 7, 8, 17


@entry
def solve_plane_goals(
    body: Body,
    options: Options,
    planar: Planar,
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
        planar: Of the solve.
        plugs: Of the solve.
        goals: Goal and pole, (m, 6) [length], world.
        fk: FK offsets, HPB, (n, 3) [rad].
        memory: Continuity, (n + 4, 3). Ends as the one after the last goal.
        chained: Whether each goal continues from the one before; else each starts from `memory`.
        angles: OUT: HPB, (m, n, 3) [rad].
        positions: OUT: (m, n, 3) [length], world.
        rotations: OUT: (m, n, 3, 3), world.
        numbers: OUT: (m, 17 + n): iterations, distance, status, bend vector, bend angle, where the
            plane comes from, its axes (3, 3), planar angles.
        trace: OUT: angles of the last goal's stages, (t, n, 3) [rad]; t = 0 for none.

    Returns:
        How many stages the trace holds.
    """
    n = body.offsets.shape[0]
    pose = new_pose(n)
    flat = new_planar_pose(n)
    kept = memory.copy()
    stages = 0
    for row in range(goals.shape[0]):
        if not chained:
            copy_rows(kept, memory)
        goal = (goals[row, 0], goals[row, 1], goals[row, 2])
        pole = (goals[row, 3], goals[row, 4], goals[row, 5])
        stages = _solve(
            goal, pole, body, options, planar, plugs, fk, memory, pose, flat, numbers[row], trace
        )
        write_pose(pose, angles[row], positions[row], rotations[row])
    return stages


@entry
def new_planar_pose(n: int) -> PlanarPose:
    """Allocate the planar joints of n joints."""
    return PlanarPose(
        np.zeros((n, 3)),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n),
        np.zeros(n, np.int64),
    )


@kernel
def _solve(
    goal: Vector,
    pole: Vector,
    body: Body,
    options: Options,
    planar: Planar,
    plugs: Plugs,
    fk: Array,
    memory: Array,
    pose: Pose,
    flat: PlanarPose,
    numbers: Array,
    trace: Array,
) -> int:
    """Take one goal through all stages; return the number of stages traced."""
    frame, distance, source = find_plane(goal, pole, body, planar, memory)
    iterations, failed = -2, 0
    copy_rows(body.rest, pose.angles)
    stages = _keep(0, pose, trace)
    put_initial_pose(frame, body, planar, pose)
    if not options.full_fk:
        iterations = -1
        stages = _aim(frame, body, options, planar, fk, memory, pose, flat, trace, stages)
    find_planar_joints(pose, flat)
    if options.max_iterations > -1 and not options.full_fk:
        near = soft_distance(distance, options.root_to_end, options.soft_zone)
        if bend_planar(near, body, options, planar, plugs, fk, pose, flat):
            stages = _record(stages, frame, body, memory, pose, flat, trace)
            iterations, stages = _rounds(
                near, frame, body, options, planar, memory, pose, flat, trace, stages
            )
        else:
            failed = FAILED
    _finish_pose(frame, body, options, fk, memory, pose, flat)
    _write_numbers(
        goal, frame, distance, source, iterations, failed, options, planar, pose, flat, numbers
    )
    return stages


@kernel
def _aim(
    frame: Matrix,
    body: Body,
    options: Options,
    planar: Planar,
    fk: Array,
    memory: Array,
    pose: Pose,
    flat: PlanarPose,
    trace: Array,
    stages: int,
) -> int:
    """Turn the chain to goal and pole, apply FK offsets, turn it again (000 §6.2(8)(B))."""
    for joint in range(flat.after.shape[0]):
        flat.before[joint] = 0.0
        flat.after[joint] = 0.0
        flat.violations[joint] = 0
    aim_end(body, planar, pose)
    stages = _record(stages, frame, body, memory, pose, flat, trace)
    face_pole(body, options, planar, pose)
    stages = _record(stages, frame, body, memory, pose, flat, trace)
    offset = any_offset(fk)
    if offset:
        apply_offsets(body, options, fk, pose)
    stages = _record(stages, frame, body, memory, pose, flat, trace)
    if offset:
        aim_end(body, planar, pose)
    return _record(stages, frame, body, memory, pose, flat, trace)


@kernel
def _rounds(
    distance: float,
    frame: Matrix,
    body: Body,
    options: Options,
    planar: Planar,
    memory: Array,
    pose: Pose,
    flat: PlanarPose,
    trace: Array,
    stages: int,
) -> tuple[int, int]:
    """Run CCD rounds until the end is on the goal, nothing moves, or they run out.

    Round k has strength min(k x smoothing, 1), k from 1 (2D 29).

    Returns:
        Rounds run, stages traced.
    """
    end = flat.after.shape[0] - 1
    lowest = find_bounds(planar, flat)
    done = 0
    while done < options.max_iterations and planar.support >= 0:
        if hypot(flat.places[end, 0] - distance, flat.places[end, 1]) < options.tolerance:
            break
        done += 1
        strength = min(done * options.smoothing, 1.0)
        moved = planar_round(strength, distance, lowest, options, planar, flat)
        stages = _record(stages, frame, body, memory, pose, flat, trace)
        if not moved and strength >= 1.0:
            break
    return done, stages


@kernel
def _read_angles(frame: Matrix, body: Body, memory: Array, pose: Pose, flat: PlanarPose) -> None:
    """Give the joints the angles of their planar turns, nearest to those before (D-10).

    A planar joint turned by a in the IK plane turns its joint by a about the plane's normal.
    """
    parent = base_rotation(body)
    for joint in range(flat.after.shape[0]):
        turn = flat.after[joint] - flat.before[joint]
        c, s = cos(turn), sin(turn)
        x, y, z = matrix(pose.world, joint)
        local = (subtract(scale(x, c), scale(y, s)), add(scale(x, s), scale(y, c)), z)
        world = multiply(frame, local)
        relative = multiply(
            transposed(matrix(body.frozen, joint)), multiply(transposed(parent), world)
        )
        reference = angles_before(joint, body, memory)
        angles = nearest_form(matrix_to_hpb(relative, reference[2]), reference)
        store_vector(angles, pose.angles, joint)
        parent = world


@kernel
def _record(
    stages: int,
    frame: Matrix,
    body: Body,
    memory: Array,
    pose: Pose,
    flat: PlanarPose,
    trace: Array,
) -> int:
    """Keep the pose's angles in the trace while it has room; return the stages so far."""
    if stages >= trace.shape[0]:
        return stages
    _read_angles(frame, body, memory, pose, flat)
    return _keep(stages, pose, trace)


@kernel
def _keep(stages: int, pose: Pose, trace: Array) -> int:
    if stages >= trace.shape[0]:
        return stages
    copy_rows(pose.angles, trace[stages])
    return stages + 1


@kernel
def _finish_pose(
    frame: Matrix,
    body: Body,
    options: Options,
    fk: Array,
    memory: Array,
    pose: Pose,
    flat: PlanarPose,
) -> None:
    """Map the planar joints back, mix in FK, place the joints in the world, keep the pose."""
    mix = 1.0 if options.full_fk else options.fk_mix
    _read_angles(frame, body, memory, pose, flat)
    for joint in range(flat.after.shape[0]):
        angles = vector(pose.angles, joint)
        posed = add(vector(body.rest, joint), vector(fk, joint))
        if mix >= 1.0:
            angles = posed
        elif mix > 0.0:
            posed = nearest_form(posed, angles)
            angles = add(scale(angles, 1.0 - mix), scale(posed, mix))
        set_angles(joint, angles, pose)
        store_vector(angles, memory, KEPT_ANGLES + joint)
    place_from(0, body, pose)
    memory[FLAGS, HAS_POSE] = 1.0


@kernel
def _write_numbers(
    goal: Vector,
    frame: Matrix,
    distance: float,
    source: int,
    iterations: int,
    failed: int,
    options: Options,
    planar: Planar,
    pose: Pose,
    flat: PlanarPose,
    numbers: Array,
) -> None:
    """Write what a solve reports besides its pose into numbers (17 + n,)."""
    end = flat.after.shape[0] - 1
    left = distance_to(goal, pose)
    numbers[ITERATIONS] = iterations
    numbers[DISTANCE] = left
    numbers[STATUS] = failed
    if failed == 0:
        numbers[STATUS] = STOPPED
        if left < options.tolerance:
            numbers[STATUS] = REACHED
        elif _is_out_of_reach(distance, options, flat):
            numbers[STATUS] = OUT_OF_REACH
        elif planar.support < 0:
            numbers[STATUS] = BLOCKED
    bend = column(frame, 1)
    numbers[BEND], numbers[BEND + 1], numbers[BEND + 2] = bend
    local = rotate_back(matrix(pose.world, 0), bend)
    numbers[BEND_ANGLE] = atan2(local[0], local[1])
    numbers[SOURCE] = source
    for row in range(3):
        for axis in range(3):
            numbers[FRAME + 3 * row + axis] = frame[row][axis]
    for joint in range(end + 1):
        numbers[ANGLES + joint] = flat.relative[joint]


@kernel
def _is_out_of_reach(distance: float, options: Options, flat: PlanarPose) -> bool:
    """Return whether no pose of the planar bones gets to the goal, limits or not.

    The bones reach from their sum down to what the longest leaves when all others fold back.
    """
    longest = 0.0
    for joint in range(flat.lengths.shape[0]):
        longest = max(longest, flat.lengths[joint])
    total = flat.along[flat.along.shape[0] - 1]
    nearest = least_reach(total, longest)
    too_far = distance - total >= options.tolerance
    return bool(too_far or nearest - distance >= options.tolerance)
