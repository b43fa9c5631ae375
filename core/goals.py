"""Goals out of files: CSV with the columns `name,x,y,z`, or arrays in an NPZ file."""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile
from zlib import error as zlib_error

import numpy as np

from limbik.core.errors import MOST_FAULTS, Fault
from limbik.core.scenemodel import FARTHEST
from limbik.core.wording import found_words
from limbik.core.yamlscalars import ScalarFault, plain_scalar

COLUMNS = ("name", "x", "y", "z")
ARRAYS = ("goals", "positions")
MOST_GOALS = 1_000_000
MOST_BYTES = 500_000_000


@dataclass
class GoalTable:
    """What a CSV file holds.

    Attributes:
        names: m names.
        positions: m positions [length].
        faults: What is wrong with the file; the rest is only good when this is empty.
    """

    names: list[str] = field(default_factory=list)
    positions: list[tuple[float, float, float]] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def read_goals(path: Path, shown_as: str) -> GoalTable:
    """Read a CSV file of goals; never raises for what the file holds.

    Args:
        path: The file, UTF-8, with or without a byte order mark.
        shown_as: Name of the file for messages.
    """
    table = GoalTable()
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = csv.reader(stream, strict=True)
            header = [title.strip() for title in next(rows, [])]
            missing = [column for column in COLUMNS if column not in header]
            if missing:
                message = f"the first line must name the columns {','.join(COLUMNS)}; "
                message += f"missing: {', '.join(missing)}"
                table.faults.append(Fault("csv", message, file=shown_as, line=1, column=1))
                return table
            _read_rows(((rows.line_num, row) for row in rows), header, shown_as, table)
    except OSError as error:
        message = f"cannot read the file: {error.strerror or error}"
        table.faults.append(Fault("unreadable", message, file=shown_as))
    except UnicodeDecodeError:
        table.faults.append(Fault("encoding", "the file is not UTF-8", file=shown_as, line=1))
    except csv.Error as error:
        table.faults.append(Fault("csv", str(error), file=shown_as, line=rows.line_num))
    if not table.names and not table.faults:
        table.faults.append(Fault("empty", "the file holds no goals", file=shown_as, line=1))
    return table


def read_goal_arrays(path: Path, array: str | None) -> GoalTable:
    """Read positions from an NPZ file; never raises for what the file holds.

    Names come from an array `names` of as many texts, else from counting.

    Args:
        path: The file; nothing in it is executed.
        array: Name of the array of positions; None for the first there is of `ARRAYS`.
    """
    table, shown = GoalTable(), str(path)
    try:
        if message := _too_large(path):
            table.faults.append(Fault("too-large", message, file=shown))
            return table
        with np.load(path, allow_pickle=False) as file:
            if not isinstance(file, np.lib.npyio.NpzFile):
                raise ValueError("not an archive")
            _read_arrays(file, array, shown, table)
    except OSError as error:
        message = f"cannot read the file: {error.strerror or error}"
        table.faults.append(Fault("unreadable", message, file=shown))
    except (ValueError, EOFError, BadZipFile, zlib_error):
        table.faults.append(Fault("npz", "this is no NPZ file of plain arrays", file=shown))
    return table


def _too_large(path: Path) -> str:
    """Say so if a file's arrays would fill the memory, however small they are packed."""
    with ZipFile(path) as archive:
        size = sum(member.file_size for member in archive.infolist())
    return f"its arrays hold {size} bytes, the limit is {MOST_BYTES}" if size > MOST_BYTES else ""


def _read_arrays(file: Any, array: str | None, shown: str, table: GoalTable) -> None:
    wanted = ARRAYS if array is None else (array,)
    found = next((name for name in wanted if name in file.files), None)
    if found is None:
        message = f"there is no array {' or '.join(wanted)}"
        hint = f"it has: {', '.join(file.files[:12])}"
        key = "" if array is None else "array"
        table.faults.append(Fault("unknown-array", message, key, shown, hint=hint))
        return
    places, message = file[found], ""
    if places.ndim != 2 or places.shape[-1] != 3 or places.dtype.kind not in "iuf":
        message = f"must hold numbers of shape (m, 3), not {places.dtype} of {places.shape}"
    elif not 1 <= len(places) <= MOST_GOALS:
        message = f"must hold 1 to {MOST_GOALS} goals, not {len(places)}"
    elif not (np.abs(places) <= FARTHEST).all():  # false for NaN too
        row = int(np.flatnonzero(~(np.abs(places) <= FARTHEST).all(axis=1))[0])
        span = f"-{FARTHEST:g} and {FARTHEST:g}"
        message = f"must hold numbers between {span}; row {row}, counted from 0, does not"
    if message:
        table.faults.append(Fault("array", f"the array '{found}' {message}", file=shown))
        return
    names = file["names"] if "names" in file.files else np.zeros(0)
    numbers = range(1, len(places) + 1)
    named = names.dtype.kind == "U" and names.shape == (len(places),)
    table.names = [str(name) for name in (names if named else numbers)]
    table.positions = [(float(x), float(y), float(z)) for x, y, z in places]


def _read_rows(
    rows: Iterator[tuple[int, list[str]]], header: Sequence[str], name: str, table: GoalTable
) -> None:
    at = [header.index(column) for column in COLUMNS]
    seen: dict[str, int] = {}
    for line, row in rows:
        if len(table.faults) >= MOST_FAULTS:
            return
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            message = f"this line has {len(row)} values, the header has {len(header)}"
            table.faults.append(Fault("csv", message, file=name, line=line))
            continue
        title = row[at[0]].strip()
        if not title or title in seen:
            message = f"'{title}' is given twice, first at line {seen.get(title)}"
            message = message if title else "the name is empty"
            table.faults.append(Fault("name", message, key="name", file=name, line=line))
        if len(seen) >= MOST_GOALS:
            message = f"more than {MOST_GOALS} goals"
            table.faults.append(Fault("too-many", message, file=name, line=line))
            return
        seen[title] = line
        x, y, z = (_number(row[at[k]], COLUMNS[k], name, line, table) for k in (1, 2, 3))
        table.names.append(title)
        table.positions.append((x, y, z))


def _number(text: str, column: str, name: str, line: int, table: GoalTable) -> float:
    """Read a number; a fault is noted and 0 returned."""
    try:
        value = plain_scalar(text.strip())
    except ScalarFault as fault:
        table.faults.append(Fault(fault.code, fault.message, key=column, file=name, line=line))
        return 0.0
    if isinstance(value, bool) or not isinstance(value, int | float):
        message = f"must be a number, not {found_words(text.strip())}"
        table.faults.append(Fault("type", message, key=column, file=name, line=line))
        return 0.0
    if abs(value) > FARTHEST:
        message = f"must be between -{FARTHEST:g} and {FARTHEST:g}, not {value!r}"
        table.faults.append(Fault("range", message, key=column, file=name, line=line))
    return float(value)
