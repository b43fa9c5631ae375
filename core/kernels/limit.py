"""Joints' own limits: what a strategy of the slot `limit` allows (M-08).

A joint with one has no ranges of heading, pitch and bank; wherever it is turned, what it is turned
to is pulled inside. All work on such joints is behind one address, so that a solve without them
does not wait for it to be compiled: see `limbik.core.kernels.limit_tasks`.
"""

from math import isnan

from limbik.core.jit import kernel, late
from limbik.core.kernels.ease import eased
from limbik.core.kernels.layout import Counts, Plugs, Pose
from limbik.core.kernels.rotation import (
    Matrix,
    Vector,
    hpb_to_matrix,
    store_matrix,
    store_vector,
    vector,
)
from limbik.core.rotation import Array

# Tasks: pull inside; turn on by a step; bar a step that leads out; find the way; aim.
PULL, TURN_ON, BAR, WAY, AIM = 0, 1, 2, 3, 4

# First numbers of what a task works in; finishes need no more than WORK of them.
ANGLES, MARGIN, STEP, OTHER = 0, 3, 4, 7
WORK = 10
OPERATING, TARGET, ZONE, RELATIVE, WANTED = 10, 13, 16, 17, 26

call_limit_task = late("limbik.core.callers", "call_limit_task")


@kernel
def put(value: Vector, work: Array, first: int) -> None:
    """Write three numbers of what a task works in."""
    work[first], work[first + 1], work[first + 2] = value


@kernel
def taken(work: Array, first: int) -> Vector:
    """Read three numbers of what a task works in."""
    return work[first], work[first + 1], work[first + 2]


@kernel
def do_task(task: int, joint: int, limits: Counts, limit_params: Array, work: Array) -> None:
    """Carry out a task on a joint with a limit of its own; for finishes too.

    * PULL: ANGLES are pulled inside; MARGIN is the angle that was left.
    * TURN_ON: ANGLES are turned on by the rotation vector STEP and pulled inside.
    * BAR: STEP becomes the limit's unit gradient if it leads out of it, else zeros.
    * WAY: STEP becomes the rotation vector from ANGLES to OTHER.
    * AIM: ANGLES are turned toward WANTED, see `turn_inside`.

    Rotation vectors are in the axes of the joint's zero pose [rad].

    Args:
        task: One of the above.
        joint: Index.
        limits: As in `Plugs`, (n + 1,).
        limit_params: (n, 16)
        work: IN/OUT: at least (10,), for AIM (36,); the angles are HPB from the zero pose [rad].
    """
    call_limit_task(limits[limits.shape[0] - 1], task, limits[joint], limit_params[joint], work)


@kernel
def pulled_inside(
    joint: int, angles: Vector, limits: Counts, limit_params: Array, work: Array
) -> Vector:
    """Return angles pulled into a joint's own limit, those given where they are allowed."""
    put(angles, work, ANGLES)
    do_task(PULL, joint, limits, limit_params, work)
    return taken(work, ANGLES)


@kernel
def slowed(
    joint: int,
    before: Vector,
    after: Vector,
    low: Vector,
    high: Vector,
    zone: float,
    limits: Counts,
    limit_params: Array,
    work: Array,
) -> Vector:
    """Return the angles of a turn with the limit ease, pulled into a joint's own limit if any."""
    angles = eased(before, after, low, high, zone)
    if limits[joint] != 0:
        angles = pulled_inside(joint, angles, limits, limit_params, work)
    return angles


@kernel
def load_limits(plugs: Plugs, pose: Pose) -> None:
    """Give a working pose the limits of the solve's joints."""
    for number in range(plugs.limits.shape[0]):
        pose.limits[number] = plugs.limits[number]
    for joint in range(plugs.limit_params.shape[0]):
        for number in range(plugs.limit_params.shape[1]):
            pose.limit_params[joint, number] = plugs.limit_params[joint, number]


@kernel
def limits_failed(angles: Array, limits: Counts) -> bool:
    """Return whether a joint with a limit of its own has angles that are no numbers."""
    failed = False
    for joint in range(angles.shape[0]):
        if limits[joint] != 0 and isnan(angles[joint, 0] + angles[joint, 1] + angles[joint, 2]):
            failed = True
    return failed


@kernel
def turn_inside(
    joint: int,
    operating: Vector,
    target: Vector,
    wanted: Matrix,
    zone: float,
    angles: Array,
    relative: Array,
    limits: Counts,
    limit_params: Array,
    work: Array,
) -> bool:
    """Turn a joint as far toward a wanted rotation as its own limit lets it.

    Args:
        joint: Index.
        operating: Unit vector in the joint's frame.
        target: Unit vector in the joint's parent frame, to which the operating vector is to go.
        wanted: Rotation that would bring it nearer.
        zone: Of the limit ease [rad]; 0 = off.
        angles: Of the pose, changed in place.
        relative: Of the pose, changed in place.
        limits: As in `Plugs`.
        limit_params: As in `Plugs`.
        work: To work in, (36,).

    Returns:
        Whether the joint came nearer to the target.
    """
    put(vector(angles, joint), work, ANGLES)
    put(operating, work, OPERATING)
    put(target, work, TARGET)
    work[ZONE] = zone
    for row in range(3):
        put(
            (relative[joint, row, 0], relative[joint, row, 1], relative[joint, row, 2]),
            work,
            RELATIVE + 3 * row,
        )
        put(wanted[row], work, WANTED + 3 * row)
    do_task(AIM, joint, limits, limit_params, work)
    if work[STEP] != 0.0:
        found = taken(work, ANGLES)
        store_vector(found, angles, joint)
        store_matrix(hpb_to_matrix(found), relative, joint)
    return bool(work[STEP] > 1.0)


@kernel
def margin(joint: int, angles: Vector, pose: Pose) -> float:
    """Return the angle a joint has left to the end of its own limit [rad]."""
    work = pose.finish_rows[0]
    pulled_inside(joint, angles, pose.limits, pose.limit_params, work)
    return float(work[MARGIN])
