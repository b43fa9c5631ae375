"""How native code enters a strategy: one wrapper a slot, of fixed signature.

These are templates. Before one is compiled, its two global names are bound to a strategy's kernel
and to a function that makes the strategy's parameters from their flat array.
"""
# ruff: noqa: F821 (the two names get their values in the copies that are compiled)

from collections.abc import Callable
from typing import Any

from limbik.core.rotation import Array

kernel: Callable[..., None]
rebuild: Callable[[Array], Any]


def initial_bend(
    lengths: Array, reach_ratio: float, weights: Array, params: Array, angles: Array
) -> None:
    """Enter an initial-bend method."""
    kernel(lengths, reach_ratio, weights, rebuild(params), angles)


def bend_vector(
    frame: Array,
    aim: Array,
    end_offset: Array,
    to_world: Array,
    bank: float,
    previous: Array,
    params: Array,
    out: Array,
) -> None:
    """Enter a bend-vector mode."""
    kernel(frame, aim, end_offset, to_world, bank, previous, rebuild(params), out)


def root_control(
    root: int, has_previous: int, previous: Array, params: Array, low: Array, high: Array
) -> None:
    """Enter a root control."""
    kernel(root, has_previous, previous, rebuild(params), low, high)


def bank_suppression(
    target: Array, current: Array, pitch: float, in_ccd: int, params: Array, delta: Array
) -> None:
    """Enter a bank suppression."""
    kernel(target, current, pitch, in_ccd, rebuild(params), delta)


def finish(
    goal: Array,
    tolerance: float,
    length: float,
    offsets: Array,
    frozen: Array,
    base_position: Array,
    base_rotation: Array,
    low: Array,
    high: Array,
    own: Array,
    reachable: int,
    params: Array,
    angles: Array,
    scratch: Array,
    verdict: Array,
) -> None:
    """Enter a finish."""
    kernel(
        goal,
        tolerance,
        length,
        offsets,
        frozen,
        base_position,
        base_rotation,
        low,
        high,
        own,
        reachable,
        rebuild(params),
        angles,
        scratch,
        verdict,
    )


def limit(angles: Array, params: Array, margin: Array) -> None:
    """Enter a joint's limit."""
    kernel(angles, rebuild(params), margin)


def limit_task(task: int, params: Array, row: Array) -> None:
    """Enter the tasks of joints with limits of their own."""
    kernel(task, rebuild(params), row)


TEMPLATES: dict[str, Any] = {
    template.__name__: template
    for template in (
        initial_bend,
        bend_vector,
        root_control,
        bank_suppression,
        finish,
        limit,
        limit_task,
    )
}
