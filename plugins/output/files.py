"""Write a file whole or not at all."""

import os
import tempfile
from pathlib import Path

from limbik.core.errors import EnvironmentProblem, Fault, InputError

UNFINISHED = ".limbik-"
"""What the name of a file begins with as long as it is being written."""


def write_whole(path: Path, content: str | bytes, *, durable: bool = False) -> None:
    """Write a file so that nobody ever sees half of it: a new file takes its place at once.

    Args:
        path: The file; it is replaced if it exists.
        content: Text, written as UTF-8, or bytes.
        durable: Whether it is on the disk, and not only on its way, before it gets its name.

    Raises:
        EnvironmentProblem: The folder is missing, full or not writable.
    """
    payload = content.encode() if isinstance(content, str) else content
    beside = None
    try:
        with tempfile.NamedTemporaryFile(dir=path.parent, prefix=UNFINISHED, delete=False) as part:
            beside = Path(part.name)
            part.write(payload)
            if durable:
                part.flush()
                os.fsync(part.fileno())
        beside.chmod(0o666 & ~_mask())
        beside.replace(path)
    except OSError as error:
        raise EnvironmentProblem(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        if beside is not None:
            beside.unlink(missing_ok=True)


def write_new(path: Path, content: str | bytes) -> None:
    """Write a file that must not exist yet; as `write_whole`.

    Raises:
        InputError: The file exists; it is left as it is.
        EnvironmentProblem: The folder is missing, full or not writable.
    """
    if path.exists():
        message = "the file exists already and stays as it is"
        raise InputError(Fault("exists", message, file=str(path), hint="choose another name"))
    write_whole(path, content)


def _mask() -> int:
    """The user's file mask; it can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
