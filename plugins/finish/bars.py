"""What bars a step at joints' own limits: directions in which a joint cannot turn from where it is.

A limit says only where it pulls a turn to; which way leads out of it is found by tiny turns
(`limbik.core.kernels.limit_tasks`). That is dear, so nobody asks twice: what was found stays known
until the joint moves, and a joint with room left to its limit is not asked at all.
"""

from limbik.core.jit import kernel
from limbik.core.kernels.limit import BAR, PROBE, PUSHED
from limbik.core.kernels.rotation import (
    Vector,
    add,
    dot,
    has_direction,
    norm,
    scale,
    subtract,
    unit,
)
from limbik.core.rotation import Array
from limbik.plugins.finish.linkage import (
    ACTIVE,
    ANGLES,
    AXES,
    BARRED,
    KNOWN,
    OWN_MARGIN,
    OWN_STEP,
    ROOM,
    TRIAL,
    WAY,
    copy_columns,
    has_limit,
    motion,
    own_task,
    read,
    write,
)

NONE = (0.0, 0.0, 0.0)


@kernel
def forget(scratch: Array) -> None:
    """Forget what bars the joints: their ANGLES are new."""
    for joint in range(scratch.shape[0]):
        _know_nothing(0.0, joint, scratch)


@kernel
def accept(scratch: Array) -> None:
    """Take the angles of `take_step` over into ANGLES, with the room they left to the limits."""
    copy_columns(TRIAL, ANGLES, scratch)
    for joint in range(scratch.shape[0]):
        if has_limit(joint, scratch) and scratch[joint, ACTIVE] != 0.0:
            _know_nothing(scratch[joint, OWN_MARGIN], joint, scratch)


@kernel
def _know_nothing(room: float, joint: int, scratch: Array) -> None:
    """Forget what bars a joint that has so much room to its limit [rad]."""
    scratch[joint, ROOM] = room
    write(NONE, scratch, joint, KNOWN)
    write(NONE, scratch, joint, KNOWN + 3)


@kernel
def unbar(joint: int, scratch: Array) -> None:
    """Let a step begin in which the joint may turn all ways."""
    write(NONE, scratch, joint, BARRED)
    write(NONE, scratch, joint, BARRED + 3)


@kernel
def bar_ways_out(scratch: Array) -> bool:
    """Let joints that the step in TRIAL would push out of their own limits slide.

    Each time a joint loses a direction square to those it has lost in this step; one that has lost
    three holds still.

    Args:
        scratch: (n, WIDTH), its motions found; those and WAY lose what is barred.

    Returns:
        Whether there was any; then the step is to be found anew.
    """
    found = False
    for joint in range(scratch.shape[0]):
        if has_limit(joint, scratch) and scratch[joint, ACTIVE] != 0.0:
            out = _way_out(joint, scratch)
            if has_direction(out):
                _bar(out, joint, scratch)
                found = True
    return found


@kernel
def _way_out(joint: int, scratch: Array) -> Vector:
    """Return the gradient of the limit that the step leads out of, zeros where it leads in."""
    step = unit(read(scratch, joint, TRIAL))
    for known in (KNOWN, KNOWN + 3):
        out = read(scratch, joint, known)
        if dot(out, step) > PUSHED:
            return out
    if scratch[joint, ROOM] > PROBE or not has_direction(step):
        return NONE
    own_task(BAR, joint, ANGLES, TRIAL, scratch)
    out = read(scratch, joint, OWN_STEP)
    free = KNOWN if not has_direction(read(scratch, joint, KNOWN)) else KNOWN + 3
    write(out, scratch, joint, free)
    return out


@kernel
def _bar(out: Vector, joint: int, scratch: Array) -> None:
    """Bar a direction, or hold the joint where nothing new would be barred."""
    first, second = read(scratch, joint, BARRED), read(scratch, joint, BARRED + 3)
    new = subtract(out, add(scale(first, dot(first, out)), scale(second, dot(second, out))))
    if has_direction(second) or not norm(new) > PUSHED:
        for axis in range(3):
            scratch[joint, ACTIVE + axis] = 0.0
        return
    new = unit(new)
    write(new, scratch, joint, BARRED + 3 if has_direction(first) else BARRED)
    along = NONE
    for axis in range(3):
        along = add(along, scale(motion(joint, axis, scratch), new[axis]))
    for axis in range(3):
        left = subtract(motion(joint, axis, scratch), scale(along, new[axis]))
        write(left, scratch, joint, AXES + 3 * axis)
    wanted = read(scratch, joint, WAY)
    write(subtract(wanted, scale(new, dot(wanted, new))), scratch, joint, WAY)
