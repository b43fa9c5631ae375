"""Follow a kernel to the functions it calls and to the files it comes from."""

import sys
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from enum import Enum
from pathlib import Path
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from limbik.core import cache
from limbik.core.jit import Entry, Late

# The compiler has its own versions of these packages' functions.
_KNOWN_TO_COMPILER = {"numpy", "numba", "math", "builtins"}
_PACKAGE = __name__.partition(".")[0]


def is_foreign(value: Any) -> bool:
    """Whether a value is a plain Python function or an entry the compiler does not know yet."""
    if isinstance(value, Entry | Late):
        return True
    return isinstance(value, FunctionType) and _top(value) not in _KNOWN_TO_COMPILER


def is_own(function: FunctionType) -> bool:
    """Whether a function is part of limbik, whose sources one fingerprint covers."""
    return _top(function) == _PACKAGE


def _top(function: FunctionType) -> str:
    """The top-level package or module a function was defined in."""
    return (function.__module__ or "").partition(".")[0]


def names_in(code: CodeType) -> set[str]:
    """All names a function's code, with the functions inside it, may look up."""
    inner = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*(names_in(constant) for constant in inner))


def references(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The global and enclosing names a function uses, with their present values."""
    space = function.__globals__
    for name in sorted(names_in(function.__code__) & space.keys()):
        yield name, space[name]
    for name, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
        yield name, cell.cell_contents


def rebuilt(
    function: FunctionType, suffix: str, compiled: Callable[[FunctionType], Any]
) -> tuple[FunctionType, Callable[[], None]]:
    """Copy a function so that what it calls can be replaced by compiled versions.

    Args:
        function: Plain function.
        suffix: Appended to the qualified name, which names the machine code.
        compiled: Gives the compiled version of a function.

    Returns:
        The copy, and a function that fills in the compiled versions. They are apart because
        functions may call each other in a circle.
    """
    space = dict(function.__globals__)
    cells = tuple(CellType(cell.cell_contents) for cell in function.__closure__ or ())
    copy = FunctionType(
        function.__code__, space, function.__name__, function.__defaults__, cells or None
    )
    copy.__module__, copy.__kwdefaults__ = function.__module__, function.__kwdefaults__
    copy.__qualname__ = f"{function.__qualname__}_{suffix}"

    def fill() -> None:
        for name in names_in(function.__code__) & space.keys():
            if is_foreign(space[name]):
                space[name] = compiled(space[name])
        for cell in cells:
            if is_foreign(cell.cell_contents):
                cell.cell_contents = compiled(cell.cell_contents)

    return copy, fill


def reached(function: FunctionType) -> list[FunctionType]:
    """The function and all plain or compiled ones it calls, directly or not."""
    found: dict[int, FunctionType] = {}
    waiting = [function]
    while waiting:
        here = waiting.pop()
        if id(here) in found:
            continue
        found[id(here)] = here
        for _, value in references(here):
            found_late = value.target() if isinstance(value, Late) else value
            plain: Any = found_late.function if isinstance(found_late, Entry) else found_late
            plain = getattr(plain, "py_func", plain)
            if is_foreign(plain):
                waiting.append(plain)
    return list(found.values())


def fingerprint(function: FunctionType, *texts: str) -> str | None:
    """Name everything the machine code of a function depends on.

    Covered are limbik's own sources, all sources of the package (or the module) of each function
    reached, their code, and the values of the constants they use.

    Args:
        function: The kernel.
        texts: What else counts.

    Returns:
        16 hexadecimal digits; None if a source is no file, so that an edit could not be noticed.
    """
    files: set[Path] = set()
    parts = [cache.fingerprint(), *texts]
    for part in sorted(reached(function), key=lambda f: (f.__module__ or "", f.__qualname__)):
        source = Path(part.__code__.co_filename)
        if not source.is_file():
            return None
        parts += [f"{part.__module__}.{part.__qualname__}", _code(part.__code__)]
        parts += [f"{name}={_constant(value)}" for name, value in references(part)]
        if not is_own(part):
            files |= {source, *_package_files(_top(part))}
    return cache.digest(*parts, cache.stamp(files))


def _code(code: CodeType) -> str:
    constants = [c if not isinstance(c, CodeType) else _code(c) for c in code.co_consts]
    return f"{code.co_code.hex()} {constants}"


def _constant(value: Any) -> str:
    """Write down a value that is baked into machine code."""
    if isinstance(value, np.ndarray):
        return f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    if isinstance(value, type | ModuleType | FunctionType) or hasattr(value, "py_func"):
        return getattr(value, "__qualname__", getattr(value, "__name__", "?"))
    if isinstance(value, bool | int | float | complex | str | tuple | Enum) or is_dataclass(value):
        return repr(value)
    return type(value).__qualname__


def _package_files(module: str) -> Iterator[Path]:
    """The sources of a top-level package, hidden folders left out."""
    for place in getattr(sys.modules.get(module), "__path__", ()):
        top = Path(place)
        for file in top.rglob("*.py"):
            if not any(part.startswith(".") for part in file.relative_to(top).parts):
                yield file
