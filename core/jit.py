"""Marks of compiled code: `kernel` and `entry`.

A kernel is a plain Python function and stays one: in tests and in the debugger it is called and
stepped through as it stands. An entry compiles itself, with all kernels it reaches, when Python
first calls it; until then the compiler is not even imported. With `NUMBA_DISABLE_JIT=1` an entry
runs in the interpreter.
"""

import os
from collections.abc import Callable
from functools import update_wrapper
from importlib import import_module
from typing import Any, TypeVar, cast

from limbik.core import cache

F = TypeVar("F", bound=Callable[..., Any])

COMPILES = os.environ.get("NUMBA_DISABLE_JIT", "0") in ("", "0")
"""False when `NUMBA_DISABLE_JIT` is set."""


def kernel(function: F) -> F:
    """Mark a function that compiled code calls.

    It is compiled without numba's memory runtime: it cannot allocate, and views of arrays cost no
    reference counting (which took four fifths of a solve).
    """
    return function


class Entry:
    """A function that Python calls and that runs compiled; see `entry`."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.compiled: Any = None
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Run the function, compiled if anything is."""
        if self.compiled is None:
            self.compile()
        return self.compiled(*arguments)

    def direct(self, *arguments: Any) -> Callable[..., Any]:
        """Return the function for arguments of exactly the types of these.

        It skips the look at the types on every call, which takes longer than a short solve. The
        caller answers for the types: other ones are misread.
        """
        from limbik.core import compiler

        return cast(Callable[..., Any], compiler.direct(self.compile(), arguments))

    def compile(self) -> Any:
        """Return the function to call, made on first use."""
        if self.compiled is None:
            from limbik.core import compiler

            self.compiled = compiler.compiled_entry(self)
        return self.compiled


def entry(function: F) -> F:
    """Compile a function that Python calls, on first use; its machine code is kept for later runs.

    Unlike a kernel it may allocate.
    """
    return cast(F, Entry(function) if COMPILES else function)


class Late:
    """A function that is made only when it is called or compiled; see `late`."""

    def __init__(self, module: str, name: str) -> None:
        self.module, self.name = module, name

    def target(self) -> Callable[..., Any]:
        """Import the function."""
        return cast(Callable[..., Any], getattr(import_module(self.module), self.name))

    def __call__(self, *arguments: Any) -> Any:
        """Call the function, in the interpreter."""
        return self.target()(*arguments)


def late(module: str, name: str) -> Any:
    """Stand for a function whose module needs the compiler, so that importing a kernel does not."""
    return Late(module, name)


def is_compiled_before() -> bool:
    """Whether nothing is left to compile: an earlier run has left machine code, or none is used."""
    return not COMPILES or cache.is_compiled_before()
