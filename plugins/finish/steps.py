"""A step of the angles that brings the end to a place to first order, inside the limits.

Of all such steps the one that differs least from a way the angles are to go (nothing, or toward
another pose). Axes at a limit are left out while the step would push them further.
"""

from limbik.core.jit import kernel
from limbik.core.kernels.limit import TURN_ON
from limbik.core.kernels.rotation import (
    Vector,
    add,
    clamp,
    dot,
    scale,
    subtract,
)
from limbik.core.rotation import Array
from limbik.plugins.finish.bars import bar_ways_out, unbar
from limbik.plugins.finish.linkage import (
    ACTIVE,
    ANGLES,
    OWN_ANGLES,
    TRIAL,
    WAY,
    Linkage,
    has_limit,
    motion,
    own_task,
    read,
    turns,
    write,
)


@kernel
def find_step(error: Vector, damping: float, chain: Linkage, scratch: Array) -> None:
    """Write a step into TRIAL [rad]: WAY + Jᵀw with J (WAY + Jᵀw) = error, damped.

    Args:
        error: Where the end is to go from where it is [length].
        damping: Share of the mean square motion that keeps w small (Levenberg-Marquardt).
        chain: The chain.
        scratch: (n, WIDTH), its motions found.
    """
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            scratch[joint, ACTIVE + axis] = 1.0 if turns(joint, axis, chain) else 0.0
        if has_limit(joint, scratch):
            unbar(joint, scratch)
    # Each pass takes an axis or a direction out, so there are no more passes than axes.
    for _ in range(3 * chain.offsets.shape[0]):
        weights = _weights(error, damping, chain, scratch)
        blocked = _write_step(weights, chain, scratch)
        if not bar_ways_out(scratch) and not blocked:
            break


@kernel
def take_step(longest: float, chain: Linkage, scratch: Array) -> float:
    """Turn the step in TRIAL into the angles it leads to, shortened and pulled into the limits.

    Args:
        longest: Most that an axis may turn [rad].
        chain: The chain.
        scratch: (n, WIDTH).

    Returns:
        How far the axis turns that turns most [rad].
    """
    most = 0.0
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            most = max(most, abs(scratch[joint, TRIAL + axis]))
    share = longest / most if most > longest else 1.0
    for joint in range(chain.offsets.shape[0]):
        if has_limit(joint, scratch):
            step = scale(read(scratch, joint, TRIAL), share)
            write(step, scratch, joint, TRIAL)
            if scratch[joint, ACTIVE] != 0.0:
                own_task(TURN_ON, joint, ANGLES, TRIAL, scratch)
                write(read(scratch, joint, OWN_ANGLES), scratch, joint, TRIAL)
            else:
                write(read(scratch, joint, ANGLES), scratch, joint, TRIAL)
            continue
        for axis in range(3):
            angle = scratch[joint, ANGLES + axis]
            if scratch[joint, ACTIVE + axis] != 0.0:
                turned = angle + share * scratch[joint, TRIAL + axis]
                angle = clamp(turned, chain.low[joint, axis], chain.high[joint, axis])
            scratch[joint, TRIAL + axis] = angle
    return most * share


@kernel
def _weights(error: Vector, damping: float, chain: Linkage, scratch: Array) -> Vector:
    """Return w of (J Jᵀ + damping) w = error - J WAY over the active axes."""
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    strays = (0.0, 0.0, 0.0)
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            if scratch[joint, ACTIVE + axis] == 0.0:
                continue
            m = motion(joint, axis, scratch)
            strays = add(strays, scale(m, scratch[joint, WAY + axis]))
            xx += m[0] * m[0]
            xy += m[0] * m[1]
            xz += m[0] * m[2]
            yy += m[1] * m[1]
            yz += m[1] * m[2]
            zz += m[2] * m[2]
    extra = damping * (xx + yy + zz) / 3.0 + 1e-300
    return _solve(xx + extra, xy, xz, yy + extra, yz, zz + extra, subtract(error, strays))


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
def _write_step(weights: Vector, chain: Linkage, scratch: Array) -> bool:
    """Write the step; take out the axes at a limit it pushes further, return whether any was."""
    found = False
    for joint in range(chain.offsets.shape[0]):
        for axis in range(3):
            step = 0.0
            if scratch[joint, ACTIVE + axis] != 0.0:
                step = scratch[joint, WAY + axis] + dot(motion(joint, axis, scratch), weights)
                angle = scratch[joint, ANGLES + axis]
                if (step < 0.0 and angle <= chain.low[joint, axis]) or (
                    step > 0.0 and angle >= chain.high[joint, axis]
                ):
                    scratch[joint, ACTIVE + axis] = 0.0
                    found = True
            scratch[joint, TRIAL + axis] = step
    return found
