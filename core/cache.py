"""Where compiled code is kept between runs.

Machine code depends on every source it was made of, which numba does not see across files
(numba/numba#1833). So each folder of the cache is named by a fingerprint of those sources: an
edit leads to another folder, never to old code. Nothing here imports numba.
"""

import contextlib
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

PREFIX = "native-"
UNUSED_DAYS = 30
MOST_FOLDERS = 64
_PACKAGE = Path(__file__).resolve().parent.parent
_PACKAGE_CACHE = _PACKAGE / "core" / "__pycache__"


def stamp(files: Iterable[Path]) -> str:
    """Describe the state of some files: path, size and time of the last change."""
    lines = []
    for file in sorted(set(files)):
        try:
            state = file.stat()
            lines.append(f"{file}|{state.st_size}|{state.st_mtime_ns}")
        except OSError:
            lines.append(f"{file}|gone")
    return "\n".join(lines)


def digest(*texts: str) -> str:
    """Shorten texts to 16 hexadecimal digits."""
    return sha256("\0".join(texts).encode()).hexdigest()[:16]


@cache
def fingerprint() -> str:
    """Name everything limbik's own machine code depends on.

    That is the versions of Python and numba and all sources of `limbik.core` and `limbik.plugins`
    (in a checkout the package is the whole repository, so not simply all of it).
    """
    files = [file for room in ("core", "plugins") for file in (_PACKAGE / room).rglob("*.py")]
    return digest(sys.version, version("numba"), version("llvmlite"), stamp(files))


def candidates() -> Iterator[Path]:
    """Places for the cache, best first: `$LIMBIK_CACHE`, beside the package, the user's cache."""
    if chosen := os.environ.get("LIMBIK_CACHE"):
        yield Path(chosen).expanduser().absolute()
    yield _PACKAGE_CACHE
    from platformdirs import user_cache_path

    yield user_cache_path("limbik")


@cache
def root() -> Path | None:
    """The first place for the cache that can be written to; None if there is none."""
    for place in candidates():
        try:
            place.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=place):
                pass
        except OSError:
            continue
        remove_unused(place)
        return place
    return None


def folder(name: str) -> Path | None:
    """Make the folder for one fingerprint, marked as used today; None if nothing is writable."""
    if (place := root()) is None:
        return None
    path = place / f"{PREFIX}{name}"
    try:
        path.mkdir(exist_ok=True)
        os.utime(path)
    except OSError:
        return None
    return path


def remove_unused(place: Path, now: float | None = None) -> None:
    """Remove folders of the cache that no run has used for `UNUSED_DAYS` days.

    Of the others the `MOST_FOLDERS` used last stay: each edit of limbik's sources makes one more.
    """
    oldest = (time.time() if now is None else now) - UNUSED_DAYS * 86_400
    used = []
    for path in place.glob(f"{PREFIX}*"):
        with contextlib.suppress(OSError):  # another process may have been faster
            used.append((path.stat().st_mtime, path))
    for rank, (last_use, path) in enumerate(sorted(used, reverse=True)):
        if last_use < oldest or rank >= MOST_FOLDERS:
            shutil.rmtree(path, ignore_errors=True)


def is_compiled_before() -> bool:
    """Whether an earlier run has left machine code for the present sources."""
    place = root()
    return place is not None and any((place / f"{PREFIX}{fingerprint()}").rglob("*.nbi"))
