"""Look a strategy over before it is taken: its name, its parameters, its kernel.

The kernel runs in the interpreter, on the samples of its slot. No compiler is needed.
"""

import contextlib
import inspect
import re
import sys
from types import FunctionType
from typing import Any

import numpy as np

from limbik.core.errors import InputError, clipped
from limbik.core.params import sample
from limbik.core.slots import Slot
from limbik.core.strategy import API, Strategy, flatten, layout, unflatten

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def examine(slot: Slot, strategy: Any) -> None:
    """Check that a strategy fits a slot.

    Args:
        slot: The slot it was offered for.
        strategy: What the plug-in returned.

    Raises:
        TypeError: It is no strategy, its parameters or the arguments of its kernel are wrong.
        ValueError: Its name, its agreement number, its defaults or its results are wrong.
        Exception: Whatever its kernel raised.
    """
    if not isinstance(strategy, Strategy):
        raise TypeError(f"{slot.hook} must return strategies, not {_short(strategy)}")
    if not isinstance(strategy.name, str) or not _NAME.fullmatch(strategy.name):
        raise ValueError(f"name {strategy.name!r} must be lower-case words joined by hyphens")
    if strategy.api != API:
        raise ValueError(f"it needs strategy agreement {strategy.api}, this limbik has {API}")
    layout(strategy.params)
    _check_arguments(slot, strategy)
    try:
        values = sample(strategy)
    except InputError as error:
        raise ValueError(f"its defaults are refused: {error}") from None
    if values is not None:
        for arguments in slot.samples():
            _try(slot, strategy, unflatten(strategy.params, flatten(values)), arguments)


def _check_arguments(slot: Slot, strategy: Strategy) -> None:
    """Compare the kernel's argument names with the slot's."""
    if not isinstance(strategy.function(), FunctionType):
        raise TypeError(f"its kernel must be a plain function, not {_short(strategy.kernel)}")
    found = inspect.signature(strategy.function()).parameters.values()
    names = tuple(parameter.name for parameter in found)
    plain = all(p.kind is inspect.Parameter.POSITIONAL_OR_KEYWORD for p in found)
    if names != slot.names or not plain:
        takes = ", ".join(map(str, found))
        raise TypeError(f"its kernel takes ({takes}), the slot passes ({', '.join(slot.names)})")


def _try(slot: Slot, strategy: Strategy, values: Any, arguments: tuple[Any, ...]) -> None:
    """Run a kernel twice on one sample and look at what it wrote."""
    results = []
    for _ in range(2):
        given = [values if a is None else _copy(a) for a in arguments]
        with np.errstate(all="ignore"), contextlib.redirect_stdout(sys.stderr):
            returned = strategy.function()(*given)
        if returned is not None:
            raise ValueError(f"its kernel returned {_short(returned)}; it must write its result")
        _check_written(slot, arguments, given)
        results.append(given)
    for argument, first, second in zip(slot.arguments, *results, strict=True):
        if argument.written and not np.array_equal(first, second):
            raise ValueError(f"its kernel writes another '{argument.name}' each time it is called")


def _check_written(slot: Slot, before: tuple[Any, ...], after: list[Any]) -> None:
    """Check that results are numbers and that the other arrays are untouched."""
    for argument, old, new in zip(slot.arguments, before, after, strict=True):
        if not isinstance(old, np.ndarray):
            continue
        if not argument.written:
            if not np.array_equal(old, new):
                raise ValueError(f"its kernel writes into '{argument.name}'")
        elif np.isnan(new).any() or not (argument.infinite or np.isfinite(new).all()):
            raise ValueError(f"its kernel writes {new.tolist()} into '{argument.name}'")


def _copy(argument: Any) -> Any:
    return argument.copy() if isinstance(argument, np.ndarray) else argument


def _short(value: Any) -> str:
    return clipped(repr(value), 60)
