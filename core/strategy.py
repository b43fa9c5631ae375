"""What a strategy is: a name, a numeric function and one class of parameters.

A strategy is written in plain Python. The host checks its parameters, compiles its function and
calls it inside the solve; which arguments the function gets is documented in `limbik.core.slots`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from functools import cache
from math import radians
from types import FunctionType
from typing import Annotated, Any, NamedTuple, cast, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

MAX_PARAMS = 16
"""Numbers a strategy's parameters may take together, a tuple counting one for each item."""

API = 1
"""Number of the slots' present agreement; it grows when a slot passes more arguments."""


class Degrees:
    """Marks a parameter given in degrees; it reaches the kernel in radians.

    Example:
        `angle: Annotated[float, Field(ge=0, le=2, description="[deg]"), Degrees] = 0.0`
    """


class Sided:
    """Marks a parameter that changes its sign in the mirror image; of three numbers the first (x).

    Example:
        `angle: Annotated[float, Field(description="to the left [deg]"), Degrees, Sided] = 0.0`
    """


class NoParams(NamedTuple):
    """The parameters of a strategy that has none."""


@dataclass(frozen=True, slots=True)
class Strategy:
    """A way to do one step of the solve, offered by a plug-in under a name.

    Attributes:
        name: Lower-case name scenes use, words joined by hyphens, such as `nth-root`.
        kernel: Plain Python function with the arguments of its slot. It writes its result into
            the arrays marked OUT, returns nothing, raises nothing and keeps no state.
        params: NamedTuple class; each field is a float, int, bool, IntEnum or a tuple of floats or
            ints of fixed length, with its range in `Annotated[..., Field(...)]`.
        description: One sentence for lists.
        check: Looks at the parameters together and raises ValueError if they do not fit.
        api: Number of the agreement the kernel was written for.
    """

    name: str
    kernel: Callable[..., Any]
    params: type[Any] = NoParams
    description: str = ""
    check: Callable[[Any], None] | None = None
    api: int = API

    def function(self) -> FunctionType:
        """The kernel as a plain function, also if its author compiled it with numba."""
        return cast(FunctionType, getattr(self.kernel, "py_func", self.kernel))


@dataclass(frozen=True, slots=True)
class Parameter:
    """One field of a params class, as it lies in the flat array.

    Attributes:
        name: The field's name.
        kind: Type of each number: float, int, bool or an IntEnum class.
        size: How many numbers; 0 for a single one that is not a tuple.
        degrees: Whether the value is given in degrees.
        default: The default, or `...` if the field must be given.
        constraints: Metadata of the annotation (pydantic's Field and the like).
        sided: Whether it changes its sign in the mirror image.
    """

    name: str
    kind: type[Any]
    size: int
    degrees: bool
    default: Any
    constraints: tuple[Any, ...]
    sided: bool = False

    @property
    def count(self) -> int:
        """Places the field takes in the flat array."""
        return self.size or 1


def layout(params: type[Any]) -> tuple[Parameter, ...]:
    """Read the fields of a params class.

    Args:
        params: A NamedTuple class.

    Returns:
        One parameter a field, in order.

    Raises:
        TypeError: `params` is no NamedTuple class, a field has a type no kernel can take, or the
            fields take more than `MAX_PARAMS` numbers.
    """
    anything: Any = params  # mypy holds type[Any] for unhashable
    return _read(anything)


@cache
def _read(params: Any) -> tuple[Parameter, ...]:
    if not (isinstance(params, type) and issubclass(params, tuple) and hasattr(params, "_fields")):
        raise TypeError(f"params must be a NamedTuple class, not {params!r}")
    hints = get_type_hints(params, include_extras=True)
    defaults = getattr(params, "_field_defaults", {})
    fields = []
    for name in params._fields:
        plain, *constraints = _annotation(hints[name])
        kind, size = _kind(name, plain)
        degrees, sided = (
            any(c is mark or isinstance(c, mark) for c in constraints) for mark in (Degrees, Sided)
        )
        default = defaults.get(name, ...)
        fields.append(Parameter(name, kind, size, degrees, default, tuple(constraints), sided))
    if (total := sum(field.count for field in fields)) > MAX_PARAMS:
        raise TypeError(f"{params.__name__} takes {total} numbers, at most {MAX_PARAMS} fit")
    return tuple(fields)


def _annotation(hint: Any) -> tuple[Any, ...]:
    """Split `Annotated[float, Field(...)]` into its parts."""
    if get_origin(hint) is Annotated:
        plain, *constraints = get_args(hint)
        return (plain, *constraints)
    return (hint,)


def _kind(name: str, plain: Any) -> tuple[type[Any], int]:
    """Tell the type of a field's numbers and how many there are."""
    items = get_args(plain) if get_origin(plain) is tuple else ()
    kind = items[0] if items else plain
    fits = isinstance(kind, type) and (kind in (float, int, bool) or issubclass(kind, IntEnum))
    if items and (kind not in (float, int) or any(item is not kind for item in items)):
        fits = False
    if not fits:
        raise TypeError(
            f"parameter '{name}' is a {plain}; it must be float, int, bool, an IntEnum "
            "or a tuple of floats or ints of fixed length"
        )
    return kind, len(items)


def flatten(values: Any) -> NDArray[np.float64]:
    """Lay parameters out as the numbers a kernel's wrapper reads.

    Args:
        values: Instance of a params class, angles in degrees as given.

    Returns:
        Array (MAX_PARAMS,), angles in radians, unused places 0.
    """
    flat = np.zeros(MAX_PARAMS)
    place = 0
    for field, value in zip(layout(type(values)), values, strict=True):
        for number in value if field.size else (value,):
            flat[place] = radians(number) if field.degrees else float(number)
            place += 1
    return flat


def unflatten(params: type[Any], flat: NDArray[np.float64]) -> Any:
    """Build the parameters a kernel gets from their numbers: `flatten` backwards, in radians.

    Args:
        params: The params class.
        flat: Array (MAX_PARAMS,) made by `flatten`.

    Returns:
        Instance of `params` with angles in radians.
    """
    values: list[Any] = []
    place = 0
    for field in layout(params):
        numbers = [_number(field.kind, flat[place + i]) for i in range(field.count)]
        values.append(tuple(numbers) if field.size else numbers[0])
        place += field.count
    return params(*values)


def mirrored(values: Any) -> dict[str, Any]:
    """Return the parameters of the mirror image by name.

    Args:
        values: Instance of a params class.
    """
    image: dict[str, Any] = values._asdict()
    for field in layout(type(values)):
        if field.sided:
            value = image[field.name]
            image[field.name] = (-value[0], *value[1:]) if field.size else -value
    return image


def _number(kind: type[Any], value: float) -> Any:
    return float(value) if kind is float else kind(int(value))
