"""Joints' own limits: strategies of the slot `limit` in place of ranges (M-08)."""

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import ChainError, InputError
from limbik.core.kernels.own import LIMIT as LIMIT_COLUMN
from limbik.core.kernels.own import PARAMS, TASKS, WIDTH
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.settings import Settings, narrowing
from limbik.core.slots import LIMIT, LIMIT_TASK, MAX_PARAMS
from limbik.core.strategy import Strategy, flatten, unflatten

Limits = tuple[Bound | None, ...]


def bound_limits(chain: Chain, settings: Settings, registry: Registry) -> Limits:
    """Choose the strategies of the joints' own limits, None for joints without one.

    Raises:
        ChainError: A limit there is not, its parameters are wrong, or an option narrows ranges,
            which such a joint has not.
    """
    named = [joint.name for joint in chain.joints if joint.limit is not None]
    for option in narrowing(settings) if named else ():
        message = f"{option} narrows ranges, but a joint with a limit of its own has none"
        raise ChainError(message, named[0])
    found: list[Bound | None] = []
    for joint in chain.joints:
        try:
            choice = joint.limit
            found.append(None if choice is None else registry.bind(LIMIT.name, choice))
        except InputError as error:
            raise ChainError(f"limit: {error.faults[0].message}", joint.name) from error
    return tuple(found)


def refuse_limits(chain: Chain, solver: str) -> None:
    """Refuse a chain with joints' own limits for a solver that does not know them.

    Raises:
        ChainError: There is one.
    """
    for joint in chain.joints:
        if joint.limit is not None:
            message = f"a limit of its own belongs to the 3D solver, {solver} does not know it"
            raise ChainError(message, joint.name)


def own_rows(chain: Chain, limits: Limits) -> Array:
    """Return what is each joint's own, see `limbik.core.kernels.own`; compiles limits."""
    rows = np.zeros((len(chain), WIDTH))
    for row, joint, bound in zip(rows, chain.joints, limits, strict=True):
        if bound is not None:
            row[LIMIT_COLUMN] = -bound.address if joint.mirrored else bound.address
            row[PARAMS : PARAMS + MAX_PARAMS] = bound.values
            row[TASKS] = _tasks()
    return rows


def _tasks() -> int:
    """Return the address of what works on joints with limits; compiles it on first use."""
    from limbik.core import compiler
    from limbik.core.kernels.limit_tasks import Nothing, limit_task

    tasks = Strategy(LIMIT_TASK.name, limit_task, Nothing, "Tasks of limits.")
    return compiler.native(LIMIT_TASK.name, tasks)


def margin_of(bound: Bound, mirrored: bool, angles: ArrayLike) -> float:
    """Return the angle a joint has left to the end of its own limit, in the interpreter [rad].

    Args:
        bound: The limit.
        mirrored: Whether it is meant for the mirror image.
        angles: HPB [rad].
    """
    return pulled(bound, mirrored, angles)[1]


def pulled(bound: Bound, mirrored: bool, angles: ArrayLike) -> tuple[Array, float]:
    """Return the turn a joint's own limit makes of one, (3,) [rad], and what was left to its end.

    The arguments are those of `margin_of`.
    """
    sense = np.array([-1.0, 1.0, -1.0]) if mirrored else np.ones(3)
    turn, margin = sense * np.asarray(angles, np.float64), np.zeros(1)
    params = unflatten(bound.strategy.params, flatten(bound.params))
    bound.strategy.function()(turn, params, margin)
    return sense * turn, float(margin[0])
