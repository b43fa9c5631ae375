"""The choice among a goal's solutions: nearest to a pose, or farthest from limits (F-01).

Our own design, beyond the source. Once a solve has reached its goal, the finish starts again from
other poses in a fixed order: the reference pose, the middles of the ranges, the solution swivelled
about the line from root to goal (other bend sides), mirrored in the ranges as a whole and joint by
joint (other folds), then spread evenly over the ranges. What reaches the goal and is better stays.
Last the best is pulled toward the reference or the middles and finished again, which a limb with
joints to spare follows until nothing improves.
"""

from math import inf, pi

from limbik.core.jit import kernel
from limbik.core.kernels.finish import end_solve
from limbik.core.kernels.frames import clamp_angles, distance_to, place_from, set_angles
from limbik.core.kernels.layout import IN_VAIN, LEAST_FOUND, Body, Choice, Options, Plugs, Pose
from limbik.core.kernels.limit import margin, put, taken
from limbik.core.kernels.memory import angles_before
from limbik.core.kernels.own import KEPT, LIMIT
from limbik.core.kernels.rotation import (
    Vector,
    add,
    dot,
    has_direction,
    hpb_to_matrix,
    matrix,
    matrix_to_hpb,
    multiply,
    near,
    nearest_form,
    rotate_back,
    rotation_vector,
    scale,
    subtract,
    transposed,
    turn_about,
    unit,
    vector,
)
from limbik.core.kernels.spread import first_state, next_state, spread_angle
from limbik.core.kernels.trace import record
from limbik.core.rotation import Array

NEAREST, MARGIN = 1, 2  # `Choice.by`; 0 = off
BETTER = 1e-9  # by how much a later candidate must be better to count
SWIVELS = 8  # bend sides around the line from root to goal
PULLS = 12  # most times the best is pulled on
LEAST_PULL = 1e-3

# Columns of `Pose.own` with what is set aside.
FOUND, BEST, WANTED = KEPT, KEPT + 3, KEPT + 6


@kernel
def end_and_choose(
    goal: Vector,
    body: Body,
    options: Options,
    choice: Choice,
    plugs: Plugs,
    memory: Array,
    pose: Pose,
    trace: Array,
    stages: int,
) -> tuple[bool, int]:
    """Finish the pose CCD ended with; then, if asked to, put the best solution in its place.

    Where the goal is not reached there is nothing to choose among.

    Args:
        goal: World [length].
        body: The chain.
        options: Of the solve.
        choice: Of the solve.
        plugs: Of the solve.
        memory: Continuity, (n + 4, 3).
        pose: After CCD; changed in place.
        trace: OUT: a stage for the finish and one for the choice.
        stages: Traced so far.

    Returns:
        Whether the finish gave finite numbers only, and the stages traced.
    """
    best, share = inf, 0.5
    in_vain, nearest = 0.0, inf
    candidates = choice.candidates + PULLS if choice.by != 0 else 0
    for number in range(-1, candidates):
        pulls = number >= choice.candidates
        if pulls:
            _pull(share, choice, pose)
        elif number >= 0:
            _start(number, goal, body, options, choice, memory, pose)
        if not end_solve(goal, body, options, plugs, pose):
            return False, stages
        reached = distance_to(goal, pose) < options.tolerance
        if number < 0:
            stages = record(stages, pose, trace)
            in_vain, nearest = pose.verdict[IN_VAIN], pose.verdict[LEAST_FOUND]
            if choice.by == 0 or not reached:
                return True, stages
            _keep(FOUND, pose)
            _set_wanted(body, choice, memory, pose)
        score = _score(choice, pose)
        if reached and score < best - BETTER:
            best = score
            _keep(BEST, pose)
        elif pulls:
            share *= 0.5
            if share < LEAST_PULL:
                break
    pose.verdict[IN_VAIN], pose.verdict[LEAST_FOUND] = in_vain, nearest
    for joint in range(body.offsets.shape[0]):
        set_angles(joint, taken(pose.own[joint], BEST), pose)
    place_from(0, body, pose)
    return True, record(stages, pose, trace)


@kernel
def _keep(first: int, pose: Pose) -> None:
    """Set the angles of a pose aside."""
    for joint in range(pose.angles.shape[0]):
        put(vector(pose.angles, joint), pose.own[joint], first)


@kernel
def _set_wanted(body: Body, choice: Choice, memory: Array, pose: Pose) -> None:
    """Set the pose aside to which the choice leans: the reference, or the middles of the ranges."""
    for joint in range(body.offsets.shape[0]):
        wanted = reference(joint, body, choice, memory)
        if choice.by == MARGIN:
            wanted = _middle(joint, pose)
        put(wanted, pose.own[joint], WANTED)


@kernel
def reference(joint: int, body: Body, choice: Choice, memory: Array) -> Vector:
    """Return a joint's angles in the reference pose: given, else the pose before, else at rest."""
    if choice.pose_given:
        return vector(choice.pose, joint)
    return angles_before(joint, body, memory)


@kernel
def _middle(joint: int, pose: Pose) -> Vector:
    """Return a joint's angles in the middles of its ranges, those of free axes as found."""
    found = taken(pose.own[joint], FOUND)
    if pose.own[joint, LIMIT] != 0.0:
        return 0.0, 0.0, 0.0
    low, high = vector(pose.low, joint), vector(pose.high, joint)
    return (
        0.5 * (low[0] + high[0]) if high[0] < inf else found[0],
        0.5 * (low[1] + high[1]) if high[1] < inf else found[1],
        0.5 * (low[2] + high[2]) if high[2] < inf else found[2],
    )


@kernel
def _score(choice: Choice, pose: Pose) -> float:
    """Return how bad a pose is.

    Nearest: the joints' turns away from the reference, squared, weighted and summed [rad²].
    Margin: the least angle that an axis has left to a limit, over its joint's weight, negative
    [rad]; axes without limits and fixed ones do not count, nor do joints of weight 0.
    """
    total, least = 0.0, inf
    for joint in range(pose.angles.shape[0]):
        weight = choice.weights[joint]
        if choice.by == NEAREST:
            wanted = hpb_to_matrix(taken(pose.own[joint], WANTED))
            apart = rotation_vector(multiply(transposed(wanted), matrix(pose.relative, joint)))
            total += weight * dot(apart, apart)
            continue
        if weight > 0.0 and pose.own[joint, LIMIT] != 0.0:
            least = min(least, margin(vector(pose.angles, joint), pose.own[joint]) / weight)
        for axis in range(3):
            low, high = pose.low[joint, axis], pose.high[joint, axis]
            if weight > 0.0 and high < inf and high > low:
                angle = pose.angles[joint, axis]
                least = min(least, min(angle - low, high - angle) / weight)
    if choice.by == NEAREST:
        return total
    return -least if least < inf else 0.0


@kernel
def _start(
    number: int,
    goal: Vector,
    body: Body,
    options: Options,
    choice: Choice,
    memory: Array,
    pose: Pose,
) -> None:
    """Put the chain into the pose a candidate starts from."""
    n = body.offsets.shape[0]
    state = first_state(number)
    for joint in range(n):
        angles = taken(pose.own[joint], FOUND)
        if number == 0:
            angles = nearest_form(reference(joint, body, choice, memory), angles)
        elif number == 1:
            angles = _middle(joint, pose)
        elif number == SWIVELS + 1 or number == SWIVELS + 2 + joint:
            angles = _mirrored(joint, angles, pose)
        elif number > SWIVELS + 1 + n:
            low, high = vector(pose.low, joint), vector(pose.high, joint)
            heading = next_state(state)
            pitch = next_state(heading)
            state = next_state(pitch)
            angles = (
                spread_angle(heading, low[0], high[0]),
                spread_angle(pitch, low[1], high[1]),
                spread_angle(state, low[2], high[2]),
            )
        set_angles(joint, clamp_angles(joint, angles, pose), pose)
    if 1 < number <= SWIVELS:
        _swivel(2.0 * pi * (number - 1) / SWIVELS, goal, body, options, pose)


@kernel
def _mirrored(joint: int, angles: Vector, pose: Pose) -> Vector:
    """Return a joint's angles mirrored in their ranges, those of free axes at zero."""
    low, high = vector(pose.low, joint), vector(pose.high, joint)
    return (
        low[0] + high[0] - angles[0] if high[0] < inf else -angles[0],
        low[1] + high[1] - angles[1] if high[1] < inf else -angles[1],
        low[2] + high[2] - angles[2] if high[2] < inf else -angles[2],
    )


@kernel
def _swivel(angle: float, goal: Vector, body: Body, options: Options, pose: Pose) -> None:
    """Turn the bend root about the line from it to the goal, within its limits."""
    root = options.root
    place_from(0, body, pose)
    parent = matrix(pose.parent, root)
    line = unit(rotate_back(parent, subtract(goal, vector(pose.positions, root))))
    if not has_direction(line):
        return
    old = vector(pose.angles, root)
    turn = multiply(turn_about(line, angle), matrix(pose.relative, root))
    found = nearest_form(matrix_to_hpb(turn, old[2]), old)
    set_angles(root, clamp_angles(root, found, pose), pose)


@kernel
def _pull(share: float, choice: Choice, pose: Pose) -> None:
    """Put the best pose a share of the way nearer to the wanted one, heavy joints before light."""
    heaviest = 0.0
    for joint in range(pose.angles.shape[0]):
        heaviest = max(heaviest, choice.weights[joint])
    for joint in range(pose.angles.shape[0]):
        best, wanted = taken(pose.own[joint], BEST), taken(pose.own[joint], WANTED)
        if pose.free[joint]:
            wanted = nearest_form(wanted, best)
        elif choice.by == NEAREST:
            wanted = near(wanted, best)
        part = share * choice.weights[joint] / max(heaviest, 1e-300)
        angles = add(best, scale(subtract(wanted, best), part))
        set_angles(joint, clamp_angles(joint, angles, pose), pose)
