"""The folder of a run: a manifest that says what it is, and finished parts, which say how far.

```
runs/bends/manifest.json          the experiment with all it names, fingerprint, versions, trials
           solves/part-000000.parquet ...      a row a solve
           paths/part-000000.parquet ...       a row a goal set, with its metrics
```

A part appears under its name when it is whole, and never changes again.
"""

import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from limbik.core.errors import EnvironmentProblem, Fault, InputError
from limbik.plugins.experiments.identity import differences
from limbik.plugins.experiments.plan import PATHS, SOLVES, Batch
from limbik.plugins.experiments.table import is_whole, require_reader
from limbik.plugins.output.files import UNFINISHED, write_whole

MANIFEST: Final = "manifest.json"
_LOCK: Final = "lock"
_MOST_SHOWN = 5


@dataclass(frozen=True)
class Folder:
    """The folder of one run.

    Attributes:
        path: Where it is.
        form: What its parts are: `parquet` or `npz`.
    """

    path: Path
    form: str

    def part(self, batch: Batch) -> Path:
        """Return where a batch's part is or will be."""
        return self.path / batch.table / f"{batch.name}.{self.form}"

    def missing(self, batches: Sequence[Batch]) -> list[Batch]:
        """Return the batches without a whole part; a part that was cut short is removed."""
        missing = []
        for batch in batches:
            path = self.part(batch)
            if not is_whole(path, batch.rows):
                path.unlink(missing_ok=True)
                missing.append(batch)
        return missing

    def keep(self, batch: Batch, content: bytes) -> None:
        """Write a part: on the disk first, then under its name.

        Raises:
            EnvironmentProblem: The folder is full or not writable.
        """
        write_whole(self.part(batch), content, durable=True)

    def sweep_out(self) -> None:
        """Remove what an earlier run left half-written."""
        for table in (SOLVES, PATHS):
            for rest in (self.path / table).glob(f"{UNFINISHED}*"):
                rest.unlink(missing_ok=True)


def read_manifest(path: Path) -> dict[str, Any]:
    """Read what a run is.

    Raises:
        InputError: There is no run in this folder.
    """
    file = path / MANIFEST
    try:
        manifest: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        manifest["fingerprint"], manifest["trials"], manifest["batches"]
    except (OSError, ValueError, KeyError, TypeError):
        hint = "'limbik experiment list' shows the runs there are"
        message = f"this folder holds no run: {MANIFEST} is missing or damaged"
        raise InputError(Fault("no-run", message, file=str(path), hint=hint)) from None
    return manifest


@contextmanager
def opened(path: Path, manifest: dict[str, Any], new: bool) -> Iterator[Folder]:
    """Make a run's folder, or go on with the one that is there; other runs are kept out.

    Args:
        path: The folder.
        manifest: What the run is.
        new: Take the next free name instead of refusing a folder of another experiment.

    Raises:
        InputError: The folder holds another experiment, or something else.
        EnvironmentProblem: It cannot be made, another run is writing into it, or its parts are
            Parquet and pyarrow is not installed.
    """
    number, chosen = 1, path
    while (refusal := _refusal(chosen, manifest)) is not None:
        if not new:
            raise refusal
        number += 1
        chosen = path.with_name(f"{path.name}-{number}")
    try:
        for table in (SOLVES, PATHS):
            (chosen / table).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EnvironmentProblem(f"cannot make {chosen}: {error.strerror or error}") from error
    with locked(chosen):
        if (refusal := _refusal(chosen, manifest)) is not None:  # it came in between
            raise refusal
        file = chosen / MANIFEST
        if not file.exists():
            text = json.dumps(manifest, indent=1, ensure_ascii=False)
            write_whole(file, text, durable=True)
        form = str(read_manifest(chosen)["form"])
        require_reader(form, chosen)
        yield Folder(chosen, form)


def _refusal(path: Path, manifest: dict[str, Any]) -> InputError | None:
    """Say why a run cannot go into a folder; None if it can."""
    if (path / MANIFEST).exists():
        there = read_manifest(path)
        same = there["fingerprint"] == manifest["fingerprint"]
        return None if same else _another(path, there, manifest)
    if _has_files(path):
        message = "this folder holds other files and no run"
        return InputError(Fault("exists", message, file=str(path), hint="choose another: -o"))
    return None


def _has_files(path: Path) -> bool:
    """Whether a folder holds anything but the empty folders an interrupted start leaves."""
    ours = {SOLVES, PATHS, _LOCK}
    return path.exists() and (
        not path.is_dir()
        or any(
            not entry.name.startswith(UNFINISHED)
            and (entry.name not in ours or (entry.is_dir() and any(entry.iterdir())))
            for entry in path.iterdir()
        )
    )


def _another(path: Path, old: dict[str, Any], new: dict[str, Any]) -> InputError:
    parts = ("contents", "versions")
    found = [line for part in parts for line in differences(old.get(part), new[part])]
    shown = "; ".join(found[:_MOST_SHOWN]) or "the manifest was edited"
    more = f"; {len(found) - _MOST_SHOWN} more" if len(found) > _MOST_SHOWN else ""
    message = f"this folder holds another experiment: {shown}{more}"
    hint = "--new takes a folder of its own, -o names one"
    return InputError(Fault("changed", message, file=str(path), hint=hint))


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Keep other runs out of a folder; whatever ends this process, the lock ends with it.

    Where the system has no such locks (Windows), nothing is kept out.

    Raises:
        EnvironmentProblem: Another run is writing into it.
    """
    try:
        import fcntl
    except ImportError:
        yield
        return
    with (path / _LOCK).open("a+", encoding="utf-8") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.seek(0)
            holder = lock.read().strip() or "unknown"
            message = f"another run is writing into {path} (process {holder})"
            raise EnvironmentProblem(message) from None
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield
