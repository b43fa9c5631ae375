"""Joints' own limits: strategies of the slot `limit` in place of ranges (M-08)."""

from collections.abc import Sequence

import numpy as np

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.errors import ChainError, InputError
from limbik.core.kernels.layout import Counts
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.settings import Settings, narrowing
from limbik.core.slots import LIMIT, LIMIT_TASK, MAX_PARAMS
from limbik.core.strategy import NoParams, Strategy, flatten, unflatten

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


def flat_limits(chain: Chain, limits: Limits) -> tuple[Counts, Array]:
    """Return what `Plugs` has as limits, (n + 1,), and parameters, (n, 16); compiles."""
    addresses = np.zeros(len(chain) + 1, np.int64)
    params = np.zeros((len(chain), MAX_PARAMS))
    for number, bound in enumerate(limits):
        if bound is not None:
            mirrored = chain.joints[number].mirrored
            addresses[number] = -bound.address if mirrored else bound.address
            params[number] = bound.values
    if any(limits):
        from limbik.core import compiler
        from limbik.core.kernels.limit_tasks import limit_task

        tasks = Strategy(LIMIT_TASK.name, limit_task, NoParams, "Tasks of limits.")
        addresses[-1] = compiler.native(LIMIT_TASK.name, tasks)
    return addresses, params


def margin_of(bound: Bound, mirrored: bool, angles: Sequence[float]) -> float:
    """Return the angle a joint has left to the end of its own limit, in the interpreter [rad].

    Args:
        bound: The limit.
        mirrored: Whether it is meant for the mirror image.
        angles: HPB [rad].
    """
    turn, margin = np.array(angles, np.float64), np.zeros(1)
    if mirrored:
        turn *= (-1.0, 1.0, -1.0)
    params = unflatten(bound.strategy.params, flatten(bound.params))
    bound.strategy.function()(turn, params, margin)
    return float(margin[0])
