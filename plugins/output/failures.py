"""Turn whatever ends a command into a message and an exit status.

| status | means |
|-------:|-------|
| 0   | done; every goal reached |
| 1   | it ran, and some goals were not reached |
| 2   | the input is wrong |
| 3   | something is missing on this machine |
| 4   | a plug-in failed |
| 70  | a bug in limbik |
| 130 | interrupted |
"""

import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from limbik.core.errors import Fault, InputError, LimbikError

BUG = 70
INTERRUPTED = 130
_STATUS = {
    2: "bad-input",
    3: "environment",
    4: "plugin-error",
    BUG: "internal",
    INTERRUPTED: "interrupted",
}


@contextmanager
def reported(as_json: bool = False) -> Iterator[None]:
    """Run a command; report what it raises and leave with the right exit status.

    Args:
        as_json: Write failures as one JSON object on stdout, too.

    Raises:
        SystemExit: The command failed, or asked for a status itself.
    """
    try:
        yield
        sys.stdout.flush()
    except SystemExit:
        raise
    except BrokenPipeError:
        _close_quietly()
    except BaseException as error:
        code = _exit_code(error)
        _tell(error, code)
        if as_json:
            _tell_json(error, code)
        raise SystemExit(code) from None


def _exit_code(error: BaseException) -> int:
    if isinstance(error, LimbikError):
        return error.exit_code
    return INTERRUPTED if isinstance(error, KeyboardInterrupt) else BUG


def _tell(error: BaseException, code: int) -> None:
    if os.environ.get("LIMBIK_DEBUG") == "1":
        traceback.print_exception(error)
    for line in _lines(error, code):
        print(line, file=sys.stderr)


def _lines(error: BaseException, code: int) -> list[str]:
    if isinstance(error, InputError):
        return [line for fault in error.faults for line in (str(fault), *excerpt(fault))]
    if isinstance(error, LimbikError):
        return [f"limbik: {error}"]
    if code == INTERRUPTED:
        return ["limbik: interrupted"]
    return [
        f"limbik: a bug in limbik: {type(error).__name__}: {error}",
        "Please report it, with the scene that shows it; LIMBIK_DEBUG=1 shows where it happened.",
    ]


def _tell_json(error: BaseException, code: int) -> None:
    from limbik.plugins.output.encoding import to_json
    from limbik.plugins.output.records import failure_record

    print(to_json(failure_record(error, _STATUS[code])))


def excerpt(fault: Fault) -> list[str]:
    """Show the line of a fault with a mark under its column; nothing if it cannot be read."""
    if not (fault.file and fault.line and fault.column):
        return []
    try:
        with Path(fault.file).open(encoding="utf-8-sig") as stream:
            line = next((text for n, text in enumerate(stream, 1) if n == fault.line), "")
    except (OSError, ValueError):
        return []
    shown = line.rstrip().replace("\t", " ")
    if not shown.isprintable() or len(shown) > 120:
        return []
    return [f"    {shown}", f"    {' ' * (fault.column - 1)}^"] if shown else []


def _close_quietly() -> None:
    """Point stdout at nothing: its reader has gone, and the flush at exit must not complain."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())
    os.close(nothing)
