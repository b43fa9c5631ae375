"""Joints' own limits: what a strategy of the slot `limit` allows (M-08).

A joint with one has no ranges of heading, pitch and bank; wherever it is turned, what it is turned
to is pulled inside. All work on such joints is behind one address, so that a solve without them
does not wait for it to be compiled: see `limbik.core.kernels.limit_tasks`.
"""

from math import isnan

from limbik.core.jit import kernel, late
from limbik.core.kernels.ease import eased
from limbik.core.kernels.own import (
    ANGLES,
    LIMIT,
    MARGIN,
    OPERATING,
    RELATIVE,
    STEP,
    TARGET,
    TASKS,
    WANTED,
    ZONE,
)
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

PROBE = 1e-6  # [rad]; the part of a step that shows whether a limit bars it
PUSHED = 1e-3  # share of the probe; a joint pulled back by more is at its limit

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
def do_task(task: int, row: Array) -> None:
    """Carry out a task on a joint with a limit of its own; for finishes too.

    * PULL: ANGLES are pulled inside; MARGIN is the angle that was left.
    * TURN_ON: ANGLES are turned on by the rotation vector STEP and pulled inside.
    * BAR: STEP becomes the limit's unit gradient if it leads out of it, else zeros.
    * WAY: STEP becomes the rotation vector from ANGLES to OTHER.
    * AIM: ANGLES are turned toward WANTED, see `turn_inside`.

    Rotation vectors are in the axes of the joint's zero pose, angles HPB from there [rad].

    Args:
        task: One of the above.
        row: IN/OUT: columns as in `limbik.core.kernels.own`; OTHER is worked in.
    """
    call_limit_task(int(row[TASKS]), task, row)


@kernel
def pulled_inside(angles: Vector, row: Array) -> Vector:
    """Return angles pulled into a joint's own limit, those given where they are allowed."""
    put(angles, row, ANGLES)
    do_task(PULL, row)
    return taken(row, ANGLES)


@kernel
def slowed(
    before: Vector, after: Vector, low: Vector, high: Vector, zone: float, row: Array
) -> Vector:
    """Return the angles of a turn with the limit ease, pulled into a joint's own limit if any."""
    angles = eased(before, after, low, high, zone)
    if row[LIMIT] != 0.0:
        angles = pulled_inside(angles, row)
    return angles


@kernel
def limits_failed(angles: Array, own: Array) -> bool:
    """Return whether a joint with a limit of its own has angles that are no numbers."""
    failed = False
    for joint in range(angles.shape[0]):
        total = angles[joint, 0] + angles[joint, 1] + angles[joint, 2]
        if own[joint, LIMIT] != 0.0 and isnan(total):
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
    row: Array,
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
        row: What is the joint's own.

    Returns:
        Whether the joint came nearer to the target.
    """
    put(vector(angles, joint), row, ANGLES)
    put(operating, row, OPERATING)
    put(target, row, TARGET)
    row[ZONE] = zone
    for axis in range(3):
        for place in range(3):
            row[RELATIVE + 3 * axis + place] = relative[joint, axis, place]
        put(wanted[axis], row, WANTED + 3 * axis)
    do_task(AIM, row)
    if row[STEP] != 0.0:
        found = taken(row, ANGLES)
        store_vector(found, angles, joint)
        store_matrix(hpb_to_matrix(found), relative, joint)
    return bool(row[STEP] > 1.0)


@kernel
def margin(angles: Vector, row: Array) -> float:
    """Return the angle a joint has left to the end of its own limit [rad]."""
    pulled_inside(angles, row)
    return float(row[MARGIN])
