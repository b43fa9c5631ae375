"""The compiler: limbik's kernels, and strategies as native code.

The only module that imports numba. With `NUMBA_DISABLE_JIT=1` everything here works in the
interpreter: `kernel` and `entry` give the function back, and the address of a strategy is a key
into a table of Python functions.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from types import FunctionType
from typing import Any, cast

import numba
import numba.core.cgutils
import numba.extending

from limbik.core import cache, sources
from limbik.core.errors import PluginError
from limbik.core.jit import COMPILES, Entry, Late
from limbik.core.slots import CALLED, Slot
from limbik.core.strategy import Parameter, Strategy, layout, unflatten
from limbik.core.wrappers import TEMPLATES

# numba annotates a part of itself only, and not the same part in each version.
_njit: Any = numba.njit
_types: Any = numba.types
_typeof: Any = numba.typeof
_config: Any = numba.config
_cgutils: Any = numba.core.cgutils
_intrinsic: Any = numba.extending.intrinsic
_errors: Any = numba.core.errors

# No fastmath: NaN must stay visible. numpy's error model: a division by zero gives inf or NaN.
_OPTIONS = {"nogil": True, "error_model": "numpy"}
# LLVM's first level: the code is as fast as that of the third, and compiled a seventh sooner.
_QUICK = type(_config.OPT)(1)
_STYLE = re.compile(r"\x1b\[[0-9;]*m")
_KERNELS = f"{__package__}.kernels."
_LOCK = RLock()
_COMPILED: dict[int, tuple[Any, Any]] = {}
_NATIVE: dict[tuple[str, Strategy], tuple[int, Any]] = {}
_INTERPRETED: dict[int, Callable[..., None]] = {}


def compiled_entry(entry: Entry) -> Any:
    """Compile an entry with all kernels it reaches; its machine code is kept for later runs."""
    function = cast(FunctionType, entry.function)
    with _LOCK:
        copy, fill = sources.rebuilt(function, "entry", _compiled)
        dispatcher = _cached(copy, cache.folder(cache.fingerprint()))
        fill()
    return dispatcher


def direct(dispatcher: Any, arguments: tuple[Any, ...]) -> Any:
    """Return the entrance of a compiled function for arguments of the types of these."""
    types = tuple(_typeof(argument) for argument in arguments)
    with _setting("OPT", _QUICK):
        dispatcher.compile(types)
    return dispatcher.overloads[types].entry_point


def _cached(function: Callable[..., Any], place: Path | None) -> Any:
    """Make a dispatcher whose machine code is kept in a folder, or nowhere if None."""
    if place is None:
        return _njit(**_OPTIONS)(function)
    with _setting("CACHE_DIR", str(place)):  # read once, when a function is decorated
        try:
            return _njit(cache=True, **_OPTIONS)(function)
        except RuntimeError:  # "no locator available": numba could not write there after all
            return _njit(**_OPTIONS)(function)


@contextmanager
def _setting(name: str, value: Any) -> Iterator[None]:
    """Change a setting of numba for a while: it is everybody's."""
    with _LOCK:
        before = getattr(_config, name)
        setattr(_config, name, value)
        try:
            yield
        finally:
            setattr(_config, name, before)


def native(slot: str, strategy: Strategy) -> int:
    """Compile a strategy and give the address of its native code.

    Args:
        slot: Name of the slot it fills.
        strategy: The strategy.

    Returns:
        What the `call_` functions of `limbik.core.slots` take as `address`. The code lives as long
        as the interpreter.

    Raises:
        PluginError: numba cannot compile the strategy's kernel.
    """
    with _LOCK:
        key = (slot, strategy)
        if key not in _NATIVE:
            _NATIVE[key] = (_compile if COMPILES else _interpret)(CALLED[slot], strategy)
        return _NATIVE[key][0]


def _interpret(slot: Slot, strategy: Strategy) -> tuple[int, Any]:
    """Enter a strategy into the table of Python functions."""
    place = slot.names.index("params")
    function, params = strategy.function(), strategy.params

    def run(*arguments: Any) -> None:
        rebuilt = unflatten(params, arguments[place])
        function(*arguments[:place], rebuilt, *arguments[place + 1 :])

    address = len(_INTERPRETED) + 1
    _INTERPRETED[address] = run
    return address, run


def _compile(slot: Slot, strategy: Strategy) -> tuple[int, Any]:
    """Compile a strategy behind a wrapper of the slot's fixed signature."""
    fields = [(f.name, f.kind.__name__, f.size, f.degrees) for f in layout(strategy.params)]
    label = f"{slot.name} {strategy.name} {fields}"
    mark = sources.fingerprint(strategy.function(), label)
    unique = mark or cache.digest(label, str(id(strategy.function())))
    built_in = sources.is_own(strategy.function())
    place = cache.folder(cache.fingerprint() if built_in else mark) if mark else None
    dispatcher = _cached(_wrapper(slot, strategy, unique), place)
    signature = _types.none(*_signature(slot))
    try:
        with _setting("OPT", _QUICK):
            dispatcher.compile(signature)
        compiled = dispatcher.get_compile_result(signature)
    except Exception as error:  # the compiler fails in more ways than by its own errors
        message = f"its kernel does not compile: {_reason(error)}"
        raise PluginError(message, "", strategy.name, slot.name) from error
    address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_func_name)
    return int(address), (dispatcher, compiled)


def _reason(error: Exception) -> str:
    """Pick what the author can use out of the compiler's report: the complaint and its place."""
    kept: list[str] = []
    plain = _STYLE.sub("", str(error))  # numba writes in bold where colorama is installed
    for line in filter(None, map(str.strip, plain.splitlines())):
        if line.startswith('File "'):
            return f"{' '.join(kept)} ({line.rstrip(':')})"
        if line.startswith("During:") and kept:
            break
        if not line.startswith("Failed in nopython mode"):
            kept.append(line)
    return " ".join(kept) or type(error).__name__


def _wrapper(slot: Slot, strategy: Strategy, unique: str) -> FunctionType:
    """Bind the slot's template to a strategy's kernel and parameters.

    The qualified name is unique, since numba looks its cache up by name and code, not by what the
    global names stand for.
    """
    template = TEMPLATES[slot.name]
    space = {"kernel": _compiled(strategy.function()), "rebuild": _rebuild(strategy)}
    wrapper = FunctionType(template.__code__, space, template.__name__)
    wrapper.__module__ = template.__module__
    wrapper.__qualname__ = f"{slot.name}_{unique}"
    return wrapper


def _compiled(function: Any) -> Any:
    """Compile a plain function or an entry, and all plain functions it calls, once.

    limbik's kernels do without numba's memory runtime. None gets wrappers for calls from outside,
    which took a third of the time to compile. One that takes a record of arrays becomes part of
    its caller: a call would copy every field of every array, which took a third of a solve.
    """
    if isinstance(function, Late):
        function = function.target()
    plain = cast(FunctionType, function.function if isinstance(function, Entry) else function)
    if id(plain) not in _COMPILED:
        copy, fill = sources.rebuilt(plain, "kernel", _compiled)
        own = sources.is_own(plain)
        inner = _njit(
            _nrt=isinstance(function, Entry) or not own,
            forceinline=_takes_record(plain),
            no_cpython_wrapper=True,
            no_cfunc_wrapper=True,
            **_OPTIONS,
        )
        _COMPILED[id(plain)] = (plain, _of_plain_types(inner(copy)))
        fill()
    return _COMPILED[id(plain)][1]


def _of_plain_types(dispatcher: Any) -> Any:
    """Let calls that differ in a constant alone share one version, which is then compiled once.

    The constant is put in when the call is inlined.
    """
    template = dispatcher.get_call_template

    def get_call_template(arguments: Any, keywords: Any) -> Any:
        return template(tuple(map(_types.unliteral, arguments)), keywords)

    dispatcher.get_call_template = get_call_template
    return dispatcher


def _takes_record(function: FunctionType) -> bool:
    """Whether one of the solve's own kernels has a NamedTuple among its arguments, by annotation.

    In strategies, whose larger kernels are called from many places, it only costs time to compile.
    """
    if not function.__module__.startswith(_KERNELS):
        return False
    hints = (hint for name, hint in function.__annotations__.items() if name != "return")
    return any(hasattr(hint, "_fields") for hint in hints)


def _number_type(field: Parameter) -> Any:
    """The compiler's type of one number of a parameter."""
    plain = {float: _types.float64, int: _types.int64, bool: _types.boolean}
    return plain.get(field.kind) or _types.IntEnumMember(field.kind, _types.int64)


def _rebuild(strategy: Strategy) -> Any:
    """Make the function that fills a strategy's NamedTuple from the flat array of its numbers."""
    fields = layout(strategy.params)
    numbers = [_number_type(field) for field in fields]
    items = [
        _types.UniTuple(number, field.size) if field.size else number
        for field, number in zip(fields, numbers, strict=True)
    ]
    record = _types.BaseTuple.from_types(tuple(items), strategy.params)

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        flat = context.make_array(signature.args[0])(context, builder, arguments[0])
        place = 0
        filled = []
        for field, number, item in zip(fields, numbers, items, strict=True):
            loaded = []
            for _ in range(field.count):
                raw = builder.load(_cgutils.gep_inbounds(builder, flat.data, place))
                plain = _types.int64 if isinstance(number, _types.IntEnumMember) else number
                loaded.append(context.cast(builder, raw, _types.float64, plain))
                place += 1
            filled.append(context.make_tuple(builder, item, loaded) if field.size else loaded[0])
        return context.make_tuple(builder, record, filled)

    def rebuild(typing: Any, flat: Any) -> Any:
        return record(flat), codegen

    return _intrinsic(rebuild)


def _type(kind: str) -> Any:
    """The compiler's type of a slot's argument."""
    vector = _types.Array(_types.float64, 1, "C")
    matrix = _types.Array(_types.float64, 2, "C")
    matrices = _types.Array(_types.float64, 3, "C")
    simple = {"count": _types.int64, "number": _types.float64, "matrix": matrix}
    return (simple | {"matrices": matrices}).get(kind, vector)


def _signature(slot: Slot) -> tuple[Any, ...]:
    """The types of a slot's arguments in native code; the parameters are a flat array."""
    return tuple(_type(argument.kind) for argument in slot.arguments)


def _accepts(expected: Any, given: Any) -> bool:
    """Whether an argument can be passed on: numbers are converted, arrays must have the layout."""
    if isinstance(expected, _types.Array):
        return isinstance(given, _types.Array) and (given.dtype, given.ndim, given.layout) == (
            expected.dtype,
            expected.ndim,
            expected.layout,
        )
    return isinstance(given, _types.Number | _types.Boolean)


def invoker(slot: Slot) -> Callable[[int, tuple[Any, ...]], bool]:
    """Make the function that calls native code of a slot by its address.

    Args:
        slot: The slot.

    Returns:
        `invoke(address, arguments)`: True if the strategy returned, False if it raised. In
        compiled code it is a plain call without a way through Python.
    """
    if not COMPILES:
        return _invoke_interpreted
    expected = _signature(slot)

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        address, packed = arguments
        given = signature.args[1].types
        values = [
            value
            if isinstance(target, _types.Array)
            else context.cast(builder, value, source, target)
            for value, source, target in zip(
                _cgutils.unpack_tuple(builder, packed), given, expected, strict=True
            )
        ]
        convention = context.call_conv
        native_type = convention.get_function_type(_types.none, expected)
        function = builder.inttoptr(address, native_type.as_pointer())
        status, _ = convention.call_function(builder, function, _types.none, expected, values)
        return status.is_ok

    def invoke(typing: Any, address: Any, arguments: Any) -> Any:
        if len(arguments) != len(expected) or not all(map(_accepts, expected, arguments.types)):
            raise _errors.TypingError(
                f"{slot.name} takes {slot.names} as {expected}, not {arguments}"
            )
        return _types.boolean(_types.int64, arguments), codegen

    compiled: Callable[[int, tuple[Any, ...]], bool] = _intrinsic(invoke)
    return compiled


def _invoke_interpreted(address: int, arguments: Sequence[Any]) -> bool:
    """Call a strategy of the table of Python functions."""
    try:
        _INTERPRETED[address](*arguments)
    except Exception:
        return False
    return True
