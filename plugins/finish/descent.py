"""A damped Newton descent of the end's distance to the goal, inside the limits.

The step of smallest norm that removes the error to first order (Levenberg-Marquardt on the 3 x 3
side of the problem), axes at a limit left out while the step would push them further.
"""

from limbik.core.jit import kernel
from limbik.core.kernels.rotation import (
    Vector,
    add,
    clamp,
    dot,
    hpb_to_matrix,
    matrix_to_hpb,
    multiply,
    norm,
    rotation_vector,
    scale,
    subtract,
    transposed,
    unit,
)
from limbik.core.rotation import Array
from limbik.plugins.finish.linkage import (
    ACTIVE,
    ANGLES,
    HEADING,
    TRIAL,
    Linkage,
    axis_of,
    copy_columns,
    end_at,
    motion,
    pulled,
    read,
    turned_by,
    write,
)

LONGEST_STEP = 0.7  # [rad]; a longer step leaves the range where the first order says something
PROBE = 1e-6  # [rad]; the part of a step that shows whether a limit of its own bars it
PUSHED = 1e-3  # share of the probe; a joint pulled back by more is at its limit
LEAST_GAIN = 1e-9  # share of the error; a step that removes less ends the descent


@kernel
def descend(goal: Vector, tolerance: float, steps: int, chain: Linkage, scratch: Array) -> float:
    """Move the angles of the scratch so that the end comes nearer to the goal.

    Args:
        goal: World [length].
        tolerance: Distance at which to stop [length].
        steps: Most steps tried.
        chain: The chain.
        scratch: (n, WIDTH); its ANGLES are changed, inside the limits.

    Returns:
        The distance left [length]; never more than before.
    """
    end = end_at(ANGLES, chain, scratch)
    error = subtract(goal, end)
    distance = norm(error)
    damping = 1e-3
    for _ in range(steps):
        if distance <= tolerance:
            break
        _mark_active(chain, scratch)
        for _ in range(3 * chain.offsets.shape[0]):
            weights = _weights(error, end, damping, chain, scratch)
            blocked = _leave_out_blocked(weights, end, chain, scratch)
            if not _bar_ways_out(weights, end, chain, scratch) and not blocked:
                break
        if not _try_step(weights, end, chain, scratch):
            break
        tried = end_at(TRIAL, chain, scratch)
        left = norm(subtract(goal, tried))
        if left < distance:
            small = distance - left < LEAST_GAIN * distance
            copy_columns(TRIAL, ANGLES, scratch)
            end, error, distance = tried, subtract(goal, tried), left
            damping = max(damping * 0.1, 1e-12)
            if small:
                break
        else:
            if damping > 1e6:
                break
            damping *= 8.0
            end = end_at(ANGLES, chain, scratch)
    return distance


@kernel
def _mark_active(chain: Linkage, scratch: Array) -> None:
    """Let every axis that has a range take part."""
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            turns = chain.high[joint, axis] - chain.low[joint, axis] > 1e-9
            scratch[joint, ACTIVE + axis] = 1.0 if turns else 0.0


@kernel
def _weights(error: Vector, end: Vector, damping: float, chain: Linkage, scratch: Array) -> Vector:
    """Return w of (J Jᵀ + damping) w = error over the active axes."""
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            if scratch[joint, ACTIVE + axis] == 0.0:
                continue
            m = motion(joint, axis, end, scratch)
            xx += m[0] * m[0]
            xy += m[0] * m[1]
            xz += m[0] * m[2]
            yy += m[1] * m[1]
            yz += m[1] * m[2]
            zz += m[2] * m[2]
    size = (xx + yy + zz) / 3.0
    extra = damping * size + 1e-300
    return _solve(xx + extra, xy, xz, yy + extra, yz, zz + extra, error)


@kernel
def _solve(
    xx: float, xy: float, xz: float, yy: float, yz: float, zz: float, right: Vector
) -> Vector:
    """Solve a symmetric positive 3 x 3 system by Cholesky's method."""
    a = xx**0.5
    b, c = xy / a, xz / a
    d = max(yy - b * b, 1e-300) ** 0.5
    e = (yz - b * c) / d
    f = max(zz - c * c - e * e, 1e-300) ** 0.5
    u = right[0] / a
    v = (right[1] - b * u) / d
    w = (right[2] - c * u - e * v) / f
    z = w / f
    y = (v - e * z) / d
    return (u - b * y - c * z) / a, y, z


@kernel
def _leave_out_blocked(weights: Vector, end: Vector, chain: Linkage, scratch: Array) -> bool:
    """Take out the axes at a limit that the step would push further; return whether any was."""
    found = False
    for joint in range(chain.offsets.shape[0]):
        if chain.limits[joint] != 0:
            continue
        for axis in range(3):
            if scratch[joint, ACTIVE + axis] == 0.0:
                continue
            turn = dot(motion(joint, axis, end, scratch), weights)
            angle = scratch[joint, ANGLES + axis]
            if (turn < 0.0 and angle <= chain.low[joint, axis]) or (
                turn > 0.0 and angle >= chain.high[joint, axis]
            ):
                scratch[joint, ACTIVE + axis] = 0.0
                found = True
    return found


@kernel
def _bar_ways_out(weights: Vector, end: Vector, chain: Linkage, scratch: Array) -> bool:
    """Take the way out of their own limits from joints that the step would push there.

    A tiny part of the step shows whether it is pulled back. If so, the joint's axes lose their part
    along the limit's gradient, so that it still slides along the limit.

    Returns:
        Whether any joint was at its limit.
    """
    found = False
    for joint in range(chain.offsets.shape[0]):
        if chain.limits[joint] == 0 or scratch[joint, ACTIVE] == 0.0:
            continue
        step = unit(_turn_of(joint, weights, end, scratch))
        pull = _pull(step, joint, chain, scratch)
        if norm(pull) > PUSHED:
            _find_gradient(unit(pull), joint, chain, scratch)
            _flatten_axes(unit(read(scratch, joint, TRIAL)), joint, scratch)
            found = True
    return found


@kernel
def _pull(way: Vector, joint: int, chain: Linkage, scratch: Array) -> Vector:
    """Return the turn by which a limit pulls back a tiny turn, over the size of that turn."""
    probed = turned_by(scale(way, PROBE), joint, scratch)
    angles = matrix_to_hpb(probed, scratch[joint, ANGLES + 2])
    back = hpb_to_matrix(pulled(joint, angles, chain, scratch))
    return scale(rotation_vector(multiply(back, transposed(probed))), 1.0 / PROBE)


@kernel
def _find_gradient(way: Vector, joint: int, chain: Linkage, scratch: Array) -> None:
    """Find how far a turn about each axis leads out of the limit that pulls along a direction.

    A limit may pull aslant to its surface; this is its gradient, to which sliding is square. It
    is left in the joint's TRIAL columns.
    """
    write((0.0, 0.0, 0.0), scratch, joint, TRIAL)
    for number in range(6):
        axis, sign = number % 3, 1.0 if number < 3 else -1.0
        turn = (
            sign if axis == 0 else 0.0,
            sign if axis == 1 else 0.0,
            sign if axis == 2 else 0.0,
        )
        out = dot(_pull(turn, joint, chain, scratch), way)
        if abs(out) > PUSHED and scratch[joint, TRIAL + axis] == 0.0:
            scratch[joint, TRIAL + axis] = sign * out


@kernel
def _flatten_axes(way: Vector, joint: int, scratch: Array) -> None:
    """Take the part along a direction, given in the axes, out of a joint's axes."""
    along = (0.0, 0.0, 0.0)
    for axis in range(3):
        along = add(along, scale(axis_of(joint, axis, scratch), way[axis]))
    for axis in range(3):
        left = subtract(axis_of(joint, axis, scratch), scale(along, way[axis]))
        write(left, scratch, joint, HEADING + 3 * axis)


@kernel
def _turn_of(joint: int, weights: Vector, end: Vector, scratch: Array) -> Vector:
    """Return the step of a joint's three axes [rad]."""
    return (
        dot(motion(joint, 0, end, scratch), weights),
        dot(motion(joint, 1, end, scratch), weights),
        dot(motion(joint, 2, end, scratch), weights),
    )


@kernel
def _try_step(weights: Vector, end: Vector, chain: Linkage, scratch: Array) -> bool:
    """Write the trial angles of a step, pulled into the limits; False if nothing moves."""
    longest = 0.0
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            if scratch[joint, ACTIVE + axis] != 0.0:
                step = abs(dot(motion(joint, axis, end, scratch), weights))
                longest = max(longest, step)
    if not longest > 1e-15:
        return False
    share = min(1.0, LONGEST_STEP / longest)
    for joint in range(chain.offsets.shape[0]):
        if chain.limits[joint] != 0 and scratch[joint, ACTIVE] != 0.0:
            turn = scale(_turn_of(joint, weights, end, scratch), share)
            found = matrix_to_hpb(turned_by(turn, joint, scratch), scratch[joint, ANGLES + 2])
            write(pulled(joint, found, chain, scratch), scratch, joint, TRIAL)
            continue
        for axis in range(3):
            angle = scratch[joint, ANGLES + axis]
            if scratch[joint, ACTIVE + axis] != 0.0:
                step = dot(motion(joint, axis, end, scratch), weights) * share
                angle = clamp(angle + step, chain.low[joint, axis], chain.high[joint, axis])
            scratch[joint, TRIAL + axis] = angle
    return True
