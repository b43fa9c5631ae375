"""Read a strategy's parameters from what a scene or a program gives."""

import warnings
from collections.abc import Mapping
from enum import IntEnum
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, create_model

from limbik.core.errors import Fault, InputError
from limbik.core.settings import list_as_tuple
from limbik.core.strategy import Parameter, Strategy, layout
from limbik.core.wording import found_words, near_match, refusal

_CONFIG = ConfigDict(
    extra="forbid",
    strict=True,
    allow_inf_nan=False,
    validate_default=True,
    protected_namespaces=(),
)


def member_name(member: IntEnum) -> str:
    """The name scenes use for a member of an enumeration: lower case, with hyphens."""
    return member.name.lower().replace("_", "-")


def _name_of_member(value: Any) -> Any:
    return member_name(value) if isinstance(value, IntEnum) else value


def _annotation(field: Parameter) -> Any:
    """The type pydantic checks a field as."""
    plain: Any = field.kind
    if issubclass(field.kind, IntEnum):
        names = tuple(member_name(member) for member in field.kind)
        plain = Annotated[Literal[names], BeforeValidator(_name_of_member)]
    elif field.size:
        items: Any = tuple.__class_getitem__((field.kind,) * field.size)
        plain = Annotated[items, BeforeValidator(list_as_tuple)]
    for constraint in field.constraints:
        plain = Annotated[plain, constraint]
    return plain


@cache
def _model(params: Any) -> type[BaseModel]:
    fields: dict[str, Any] = {f.name: (_annotation(f), f.default) for f in layout(params)}
    with warnings.catch_warnings():  # a field may be called `copy` or `json`
        warnings.simplefilter("ignore", UserWarning)
        return create_model(params.__name__, __config__=_CONFIG, __doc__=params.__doc__, **fields)


def model(params: type[Any]) -> type[BaseModel]:
    """Make the pydantic model of a params class; its JSON Schema serves editors."""
    anything: Any = params  # mypy holds type[Any] for unhashable
    return _model(anything)


def read(strategy: Strategy, given: Mapping[str, Any], label: str = "") -> Any:
    """Check what is given for a strategy's parameters.

    Args:
        strategy: The strategy.
        given: Values by name, angles in degrees; enumerations by their members' names.
        label: What messages call the strategy.

    Returns:
        Instance of the params class, angles in degrees as given.

    Raises:
        InputError: With a fault for each bad value; its key is the parameter's name.
    """
    label = label or f"'{strategy.name}'"
    fields = layout(strategy.params)
    try:
        checked = model(strategy.params).model_validate(dict(given))
    except ValidationError as error:
        raise InputError(_faults(error, [f.name for f in fields], label)) from None
    values = strategy.params(*(_value(f, getattr(checked, f.name)) for f in fields))
    if strategy.check is not None:
        try:
            strategy.check(values)
        except ValueError as error:
            raise InputError(Fault("value", f"{label}: {error}")) from None
    return values


def _value(field: Parameter, checked: Any) -> Any:
    """Give a checked value the type the params class declares."""
    if issubclass(field.kind, IntEnum):
        return next(member for member in field.kind if member_name(member) == checked)
    if field.size:
        return tuple(field.kind(number) for number in checked)
    return field.kind(checked)


def _faults(error: ValidationError, known: list[str], label: str) -> list[Fault]:
    """Put pydantic's complaints in our words; unknown keys first, they explain the others."""
    takes = f"{label} takes {', '.join(known) or 'no parameters'}"
    faults: list[Fault] = []
    for complaint in error.errors(include_url=False):
        kind, found = complaint["type"], complaint["input"]
        name = str(complaint["loc"][0])
        key = name + "".join(f"[{place}]" for place in complaint["loc"][1:])
        if kind == "extra_forbidden":
            hint = near_match(name, known)
            faults.insert(0, Fault("unknown-key", f"unknown key; {takes}", name, hint=hint))
        elif kind == "missing":
            short = len(complaint["loc"]) > 1
            text = "missing; the list is too short" if short else f"missing; {takes}"
            faults.append(Fault("missing-key", text, key))
        else:
            words = refusal(kind, complaint.get("ctx", {}), complaint["msg"], found)
            text = words.message or f"must be {words.allowed}, not {found_words(found)}"
            faults.append(Fault(words.code, text, key, hint=words.hint))
    return faults


def sample(strategy: Strategy) -> Any | None:
    """Find parameters to try a strategy with: the defaults, or values in range.

    Returns:
        Instance of the params class; None if no set of values that is likely to fit does.

    Raises:
        InputError: The strategy's own defaults are refused.
    """
    required = [field for field in layout(strategy.params) if field.default is ...]
    if not required:
        return read(strategy, {})
    for number in (1.0, 0.5, 0.0, 10.0, 100.0, -1.0):
        try:
            return read(strategy, {field.name: _guess(field, number) for field in required})
        except InputError:
            continue
    return None


def _guess(field: Parameter, number: float) -> Any:
    if issubclass(field.kind, IntEnum):
        return next(iter(field.kind))
    if field.size:
        return tuple(field.kind(number) for _ in range(field.size))
    return field.kind(number)
