"""The work on a joint with a limit of its own, behind one address: see `do_task`."""

from math import inf, isnan
from typing import NamedTuple

from limbik.core.jit import kernel, late
from limbik.core.kernels.ease import eased_gap
from limbik.core.kernels.limit import AIM, BAR, PROBE, PUSHED, TURN_ON, WAY, put, taken
from limbik.core.kernels.own import (
    ANGLES,
    LIMIT,
    MARGIN,
    OPERATING,
    OTHER,
    PARAMS,
    RELATIVE,
    STEP,
    TARGET,
    TASK_WIDTH,
    WANTED,
    ZONE,
)
from limbik.core.kernels.rotation import (
    ZERO_TURN,
    Matrix,
    Vector,
    angle_between,
    dot,
    hpb_to_matrix,
    matrix_to_hpb,
    multiply,
    norm,
    rotate,
    rotation_vector,
    scale,
    transposed,
    turn_by,
    unit,
)
from limbik.core.rotation import Array

TRIES = 4  # sizes of a turn that are tried before a joint is left alone

call_limit = late("limbik.core.callers", "call_limit")


class Nothing(NamedTuple):
    """The parameters of all tasks: none."""


def limit_task(task: int, params: Nothing, work: Array) -> None:
    """Carry out a task; see `do_task`."""
    if task == AIM:
        _aim(work)
    elif task == WAY:
        after, before = hpb_to_matrix(taken(work, OTHER)), hpb_to_matrix(taken(work, ANGLES))
        put(rotation_vector(multiply(after, transposed(before))), work, STEP)
    elif task == BAR:
        put(_bar(work), work, STEP)
    else:
        angles = taken(work, ANGLES)
        if task == TURN_ON:
            angles = _turned(taken(work, STEP), angles)
        put(_pulled(angles, work), work, ANGLES)


@kernel
def _pulled(angles: Vector, work: Array) -> Vector:
    """Return angles pulled inside, and write the margin; ANGLES stay as they are."""
    sign = 1.0 if work[LIMIT] > 0.0 else -1.0
    put((sign * angles[0], angles[1], sign * angles[2]), work, OTHER)
    turn, params = work[OTHER : OTHER + 3], work[PARAMS:TASK_WIDTH]
    call_limit(int(abs(work[LIMIT])), turn, params, work[MARGIN : MARGIN + 1])
    h, p, b = taken(work, OTHER)
    return sign * h, p, sign * b


@kernel
def _turned(step: Vector, angles: Vector) -> Vector:
    """Return angles turned on by a rotation vector [rad]."""
    return matrix_to_hpb(multiply(turn_by(step), hpb_to_matrix(angles)), angles[2])


@kernel
def _bar(work: Array) -> Vector:
    """Return the unit gradient of a limit that a step leads out of, else zeros.

    A tiny part of the step shows whether it is pulled back. A limit may pull aslant to its
    surface; the gradient is how far a turn about each axis leads out, to which sliding is square.
    """
    turn, bank = hpb_to_matrix(taken(work, ANGLES)), work[ANGLES + 2]
    pull = _pull(unit(taken(work, STEP)), turn, bank, work)
    if not norm(pull) > PUSHED:
        return 0.0, 0.0, 0.0
    back = unit(pull)
    found = (
        _out((1.0, 0.0, 0.0), back[0], back, turn, bank, work),
        _out((0.0, 1.0, 0.0), back[1], back, turn, bank, work),
        _out((0.0, 0.0, 1.0), back[2], back, turn, bank, work),
    )
    return unit(found)


@kernel
def _out(
    axis: Vector, back_along: float, back: Vector, turn: Matrix, bank: float, work: Array
) -> float:
    """Return how far a turn about an axis leads out: the way first that is hardly pulled along."""
    sign = -1.0 if back_along > 0.0 else 1.0
    for way in (sign, -sign):
        out = dot(_pull(scale(axis, way), turn, bank, work), back)
        if out > PUSHED:
            return way * out
    return 0.0


@kernel
def _pull(way: Vector, turn: Matrix, bank: float, work: Array) -> Vector:
    """Return the turn by which a limit pulls back a tiny turn, over the size of that turn."""
    probed = multiply(turn_by(scale(way, PROBE)), turn)
    angles = matrix_to_hpb(probed, bank)
    pulled = _pulled(angles, work)
    if pulled == angles:
        return 0.0, 0.0, 0.0
    back = multiply(hpb_to_matrix(pulled), transposed(probed))
    return scale(rotation_vector(back), 1.0 / PROBE)


@kernel
def _aim(work: Array) -> None:
    """Turn toward a wanted rotation as far as the limit lets it.

    A turn that, pulled inside, leads away from the target is halved a few times, then left out.
    The first number of STEP tells: 0 left out, 1 hardly moved, 2 nearer to the target.
    """
    relative, wanted = _rows(work, RELATIVE), _rows(work, WANTED)
    operating, target = taken(work, OPERATING), taken(work, TARGET)
    bank, zone = work[ANGLES + 2], work[ZONE]
    before = angle_between(rotate(relative, operating), target)
    way = rotation_vector(multiply(wanted, transposed(relative)))
    if zone > 0.0:
        gap = _margin(relative, bank, work)
        step = gap - _margin(wanted, bank, work)
        if gap < inf and 0.0 < step < inf:
            way = scale(way, (gap - eased_gap(max(gap, 0.0), step, zone)) / step)
    work[STEP] = 0.0
    for _ in range(TRIES):
        turned = multiply(turn_by(way), relative)
        angles = _pulled(matrix_to_hpb(turned, bank), work)
        after = angle_between(rotate(hpb_to_matrix(angles), operating), target)
        if after < before or isnan(after):  # what is no number is kept, to be found and told
            put(angles, work, ANGLES)
            work[STEP] = 2.0 if before - after > ZERO_TURN else 1.0
            break
        way = scale(way, 0.5)


@kernel
def _rows(work: Array, first: int) -> Matrix:
    """Read a matrix."""
    return taken(work, first), taken(work, first + 3), taken(work, first + 6)


@kernel
def _margin(turn: Matrix, bank: float, work: Array) -> float:
    """Return the angle that a turn leaves to the end of the limit [rad]."""
    _pulled(matrix_to_hpb(turn, bank), work)
    return float(work[MARGIN])
