"""What `bake` and `inspect` need besides core: the format by a file's ending, and progress."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from typing import Final, TypeVar

from limbik.core.errors import Fault, InputError
from limbik.core.formats import BodyBake, Inspection, Output, SceneInput
from limbik.core.registry import Registry

LONG: Final = 2000  # frames from which progress is shown
F = TypeVar("F", Output, SceneInput)


def output_for(path: Path, registry: Registry) -> Output:
    """Find the output a file's ending chooses.

    Raises:
        InputError: No output writes such files.
    """
    return _by_ending(path, list(registry.outputs().values()), "written")


def body_writer(found: Output, path: Path) -> Callable[[BodyBake], str | bytes]:
    """Return what writes scenes of several chains.

    Raises:
        InputError: The output writes single chains only.
    """
    if found.write_body is None:
        message = f"files ending in '{path.suffix}' hold one chain, this scene has several"
        raise InputError(Fault("ending", message, file=str(path)))
    return found.write_body


def inspect_file(path: Path, registry: Registry) -> Inspection:
    """Say what a robot's or a clip's file holds.

    Raises:
        InputError: No scene input reads such files, or the file is at fault.
    """
    return _by_ending(path, list(registry.scene_inputs().values()), "inspected").inspect(path)


def _by_ending(path: Path, formats: Sequence[F], verb: str) -> F:
    for found in formats:
        if any(path.name.lower().endswith(suffix) for suffix in found.suffixes):
            return found
    known = ", ".join(sorted(suffix for found in formats for suffix in found.suffixes))
    message = f"files ending in '{path.suffix}' cannot be {verb}; known: {known}"
    raise InputError(Fault("ending", message, file=str(path)))


@contextmanager
def progress(total: int) -> Iterator[Callable[[int], None] | None]:
    """Show on stderr how many of the frames are solved: a bar on a terminal, else lines.

    Args:
        total: Number of frames; below `LONG` nothing is shown.
    """
    if total < LONG:
        yield None
    elif sys.stderr.isatty():
        from rich.console import Console
        from rich.progress import Progress

        with Progress(console=Console(stderr=True), transient=True) as bar:
            task = bar.add_task("solving", total=total)
            yield lambda done: bar.update(task, completed=done)
    else:
        yield _Lines(total).show


class _Lines:
    """Writes a line for every tenth of the work."""

    def __init__(self, total: int) -> None:
        self._total, self._tenth = total, 0
        self._first: tuple[int, float] | None = None

    def show(self, done: int) -> None:
        """Write a line if another tenth is done, with the time left from the second on."""
        now = monotonic()
        self._first = self._first or (done, now)
        before, then = self._first
        left = ""
        if before < done < self._total:
            left = f", {(now - then) * (self._total - done) / (done - before):.0f} s left"
        tenth = 10 * done // self._total
        if tenth > self._tenth:
            self._tenth = tenth
            print(f"{10 * tenth} % {done}/{self._total}{left}", file=sys.stderr)
