"""`--set a.b=1,2`: change values of an experiment file from the command line."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from limbik.core.errors import Fault, InputError, key_text
from limbik.core.yamlfile import Document, KeyPath
from limbik.core.yamlscalars import Scalar, ScalarFault, plain_scalar

SWEEP = "sweep"


@dataclass(frozen=True, slots=True)
class Override:
    """One value set on the command line.

    Attributes:
        text: The option as it was given.
        path: Where it goes.
        value: A scalar, or a list of them.
    """

    text: str
    path: KeyPath
    value: Scalar | list[Scalar]


def read_override(text: str) -> Override:
    """Read `key=value`; keys are joined by dots, values of a list by commas.

    Behind `sweep` the rest is one key, because options have dots of their own.

    Raises:
        InputError: It is not of that form.
    """
    key, sign, given = text.partition("=")
    parts = key.strip().split(".")
    if not sign or not all(parts):
        message = f"must be KEY=VALUE such as seed=7 or sweep.smoothing=0.1,0.5, not '{text}'"
        raise InputError(Fault("override", message, "--set"))
    if SWEEP in parts:
        at = parts.index(SWEEP) + 1
        parts = [*parts[:at], ".".join(parts[at:])] if parts[at:] else parts
    path = tuple(int(part) if re.fullmatch(r"\d+", part) else part for part in parts)
    try:
        values = [plain_scalar(value.strip()) for value in given.split(",")]
    except ScalarFault as fault:
        raise InputError(Fault(fault.code, fault.message, f"--set {key}")) from None
    return Override(f"--set {text}", path, values if len(values) > 1 else values[0])


def apply(document: Document, overrides: Sequence[Override]) -> Document:
    """Return the document with some values changed.

    Raises:
        InputError: A value's place is not there.
    """
    content = document.content
    for override in overrides:
        content = _with(content, override, override.path)
    return replace(document, content=content)


def _with(content: Any, override: Override, path: KeyPath) -> Any:
    if not path:
        return override.value
    first, rest = path[0], path[1:]
    if isinstance(content, list):
        if not isinstance(first, int) or first >= len(content):
            above = key_text(override.path[: len(override.path) - len(path)])
            message = f"{above} has the entries 0 to {len(content) - 1}, no '{first}'"
            raise InputError(Fault("override", message, override.text))
        return [*content[:first], _with(content[first], override, rest), *content[first + 1 :]]
    mapping = content if isinstance(content, dict) else {}
    key = str(first)
    return {**mapping, key: _with(mapping.get(key), override, rest)}


def blame(faults: Sequence[Fault], overrides: Sequence[Override]) -> list[Fault]:
    """Point faults of values that were set on the command line there instead of at the file."""

    def blamed(fault: Fault) -> Fault:
        for override in overrides:
            key = key_text(override.path)
            if fault.key == key or fault.key.startswith((f"{key}.", f"{key}[")):
                return replace(fault, file=override.text, line=0, column=0)
        return fault

    return [blamed(fault) for fault in faults]
