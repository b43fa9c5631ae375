"""Steps of a joint with a limit of its own: by rotation vectors, and along the limit.

A rotation vector is given in the axes of the joint's zero pose.
"""

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import (
    Vector,
    add,
    dot,
    hpb_to_matrix,
    matrix_to_hpb,
    multiply,
    norm,
    rotation_vector,
    scale,
    subtract,
    transposed,
    turn_by,
    unit,
)
from limbik.core.rotation import Array
from limbik.plugins.finish.linkage import (
    ACTIVE,
    ANGLES,
    AXES,
    TRIAL,
    TURN,
    WAY,
    motion,
    pulled_row,
    read,
    write,
)

PROBE = 1e-6  # [rad]; the part of a step that shows whether a limit of its own bars it
PUSHED = 1e-3  # share of the probe; a joint pulled back by more is at its limit


@kernel
def turn_between(first: int, second: int, joint: int, scratch: Array) -> Vector:
    """Return the rotation vector from the angles of one column to those of another [rad]."""
    before = hpb_to_matrix(read(scratch, joint, first))
    after = hpb_to_matrix(read(scratch, joint, second))
    return rotation_vector(multiply(after, transposed(before)))


@kernel
def turn_on(share: float, joint: int, scratch: Array) -> None:
    """Turn a share of the step in TRIAL into the angles it leads to."""
    if scratch[joint, ACTIVE] == 0.0:
        write(read(scratch, joint, ANGLES), scratch, joint, TRIAL)
        return
    step = scale(read(scratch, joint, TRIAL), share)
    write(_turned_by(step, joint, scratch), scratch, joint, TRIAL)


@kernel
def bar_way_out(joint: int, limit: int, params: Array, scratch: Array) -> bool:
    """Take the way out of its limit from a joint that the step in TRIAL would push there.

    A tiny part of the step shows whether it is pulled back. If so, motions and WAY lose their part
    along the limit's gradient, so that the joint still slides along the limit.

    Args:
        joint: Index.
        limit: The joint's own limit.
        params: Of the limit, (16,).
        scratch: (n, WIDTH), its motions found.

    Returns:
        Whether the joint was at its limit.
    """
    step = unit(read(scratch, joint, TRIAL))
    pull = _pull(step, joint, limit, params, scratch)
    if norm(pull) <= PUSHED:
        return False
    way = unit(_gradient(unit(pull), joint, limit, params, scratch))
    along = (0.0, 0.0, 0.0)
    for axis in range(3):
        along = add(along, scale(motion(joint, axis, scratch), way[axis]))
    for axis in range(3):
        left = subtract(motion(joint, axis, scratch), scale(along, way[axis]))
        write(left, scratch, joint, AXES + 3 * axis)
    wanted = read(scratch, joint, WAY)
    write(subtract(wanted, scale(way, dot(wanted, way))), scratch, joint, WAY)
    return True


@kernel
def _turned_by(step: Vector, joint: int, scratch: Array) -> Vector:
    """Return a joint's angles turned on by a rotation vector [rad]."""
    turned = multiply(turn_by(step), hpb_to_matrix(read(scratch, joint, ANGLES)))
    return matrix_to_hpb(turned, scratch[joint, ANGLES + 2])


@kernel
def _pull(way: Vector, joint: int, limit: int, params: Array, scratch: Array) -> Vector:
    """Return the turn by which a limit pulls back a tiny turn, over the size of that turn."""
    probed = _turned_by(scale(way, PROBE), joint, scratch)
    write(probed, scratch, joint, TURN)
    pulled_row(TURN, joint, limit, params, scratch)
    back = hpb_to_matrix(read(scratch, joint, TURN))
    return scale(rotation_vector(multiply(back, transposed(hpb_to_matrix(probed)))), 1.0 / PROBE)


@kernel
def _gradient(way: Vector, joint: int, limit: int, params: Array, scratch: Array) -> Vector:
    """Return how far a turn about each axis leads out of the limit that pulls along a direction.

    A limit may pull aslant to its surface; this is its gradient, to which sliding is square.
    """
    found = (0.0, 0.0, 0.0)
    for number in range(6):
        axis, sign = number % 3, 1.0 if number < 3 else -1.0
        turn = (
            sign if axis == 0 else 0.0,
            sign if axis == 1 else 0.0,
            sign if axis == 2 else 0.0,
        )
        out = dot(_pull(turn, joint, limit, params, scratch), way)
        if abs(out) > PUSHED and found[axis] == 0.0:
            found = add(found, scale(turn, out))
    return found
