"""Goals out of CSV files, which spreadsheets write and `limbik bake` and `trajectory` too.

```
name,x,y,z,heading,pitch,bank
cup,0.4,0.2,0.1,0,180,0
shelf,0.3,0.8,0.2,,,
```

The orientation is in degrees, or a quaternion in the columns `qw,qx,qy,qz`; a goal whose cells of
it are all empty has none. Without a column `name` goals are numbered. In a scene with several
chains the columns `arm: x` and so on are those of the chain `arm`.
"""

import csv
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from math import hypot, nan
from pathlib import Path

import numpy as np

from limbik.core.errors import MOST_FAULTS, Fault
from limbik.core.goalturn import UNIT, length_fault, quaternion_to_hpb
from limbik.core.rotation import Array
from limbik.core.scenemodel import FARTHEST, FULLEST
from limbik.core.wording import found_words
from limbik.core.yamlscalars import ScalarFault, plain_scalar

NAME = "name"
PLACE = ("x", "y", "z")
TURN = ("heading", "pitch", "bank")
QUATERNION = ("qw", "qx", "qy", "qz")
MOST_GOALS = 1_000_000


@dataclass
class GoalTable:
    """What a file of goals holds.

    Attributes:
        names: m names.
        positions: (m, 3) [length].
        turns: Orientations, HPB, (m, 3) [rad], NaN for goals without; None if none has one.
        turned_by: Column or array that the orientations came from; empty without.
        faults: What is wrong with the file; the rest is only good when this is empty.
    """

    names: list[str] = field(default_factory=list)
    positions: Array = field(default_factory=lambda: np.zeros((0, 3)))
    turns: Array | None = None
    turned_by: str = ""
    faults: list[Fault] = field(default_factory=list)


def read_goals(path: Path, shown_as: str, chain: str = "") -> GoalTable:
    """Read a CSV file of goals; never raises for what the file holds.

    Args:
        path: The file, UTF-8, with or without a byte order mark.
        shown_as: Name of the file for messages.
        chain: The chain whose goals are wanted, where the file holds those of several.
    """
    table = GoalTable()
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = csv.reader(stream, strict=True)
            header = [title.strip() for title in next(rows, [])]
            reader = _Rows(header, chain, shown_as)
            if not reader.faults:
                reader.read((rows.line_num, row) for row in rows)
            table = reader.table()
    except OSError as error:
        message = f"cannot read the file: {error.strerror or error}"
        table.faults.append(Fault("unreadable", message, file=shown_as))
    except UnicodeDecodeError:
        table.faults.append(Fault("encoding", "the file is not UTF-8", file=shown_as, line=1))
    except csv.Error as error:
        faults = [*reader.faults, Fault("csv", str(error), file=shown_as, line=rows.line_num)]
        table.faults += faults
    if not table.names and not table.faults:
        table.faults.append(Fault("empty", "the file holds no goals", file=shown_as, line=1))
    return table


class _Rows:
    """Reads the lines below a header."""

    def __init__(self, header: Sequence[str], chain: str, file: str) -> None:
        self.faults: list[Fault] = []
        self._file, self._header = file, header
        prefix = f"{chain}: " if "x" not in header and f"{chain}: x" in header else ""
        self._place = [prefix + title for title in PLACE]
        self._turn: list[str] = []
        self._names: dict[str, int] = {}
        self._numbers: list[list[float]] = []
        missing = [title for title in self._place if title not in header]
        if missing:
            message = f"the first line must name the columns {','.join(self._place)}; "
            self._fault("csv", f"{message}missing: {', '.join(missing)}", 1)
        groups = [[prefix + title for title in group] for group in (TURN, QUATERNION)]
        given = [group for group in groups if any(title in header for title in group)]
        if len(given) > 1:
            message = "one orientation, heading,pitch,bank or qw,qx,qy,qz, not both"
            self._fault("csv", message, 1)
        elif given:
            self._turn = given[0]
            missing = [title for title in self._turn if title not in header]
            if missing:
                message = f"an orientation has the columns {','.join(self._turn)}; "
                self._fault("csv", f"{message}missing: {', '.join(missing)}", 1)

    def _fault(self, code: str, message: str, line: int, key: str = "") -> None:
        column = 1 if line == 1 else 0
        self.faults.append(Fault(code, message, key, self._file, line, column))

    def read(self, rows: Iterator[tuple[int, list[str]]]) -> None:
        """Read all lines, or so many that there are faults enough."""
        for line, row in rows:
            if len(self.faults) >= MOST_FAULTS:
                return
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(self._header):
                message = f"this line has {len(row)} values, the header has {len(self._header)}"
                self._fault("csv", message, line)
                continue
            if len(self._names) >= MOST_GOALS:
                self._fault("too-many", f"more than {MOST_GOALS} goals", line)
                return
            cells = dict(zip(self._header, (cell.strip() for cell in row), strict=True))
            self._name(cells.get(NAME), line)
            place = [self._number(cells, title, FARTHEST, line) for title in self._place]
            self._numbers.append([*place, *self._turned(cells, line)])

    def _name(self, title: str | None, line: int) -> None:
        title = str(len(self._names) + 1) if title is None else title
        if not title or title in self._names:
            message = f"'{title}' is given twice, first at line {self._names.get(title)}"
            self._fault("name", message if title else "the name is empty", line, NAME)
        self._names[title] = line

    def _turned(self, cells: dict[str, str], line: int) -> list[float]:
        """Give the numbers of an orientation, NaN if its cells are empty."""
        empty = [title for title in self._turn if not cells[title]]
        if len(empty) == len(self._turn):
            return [nan] * len(empty)
        if empty:
            message = f"give {','.join(self._turn)} together, or none of them"
            self._fault("type", message, line, empty[0])
            return [nan] * len(self._turn)
        most = FULLEST if len(self._turn) == len(TURN) else 1.0 + UNIT
        known = len(self.faults)
        numbers = [self._number(cells, title, most, line) for title in self._turn]
        if len(numbers) == len(QUATERNION) and len(self.faults) == known:
            length = hypot(*numbers)
            if abs(length - 1.0) > UNIT:
                self._fault("range", length_fault(length), line, self._turn[0])
        return numbers

    def _number(self, cells: dict[str, str], title: str, most: float, line: int) -> float:
        """Read a number; a fault is noted and 0 returned."""
        text = cells[title]
        try:
            value = plain_scalar(text)
        except ScalarFault as fault:
            self._fault(fault.code, fault.message, line, title)
            return 0.0
        if isinstance(value, bool) or not isinstance(value, int | float):
            self._fault("type", f"must be a number, not {found_words(text)}", line, title)
            return 0.0
        if abs(value) > most:
            message = f"must be between -{most:g} and {most:g}, not {value!r}"
            self._fault("range", message, line, title)
        return float(value)

    def table(self) -> GoalTable:
        """Return what was read."""
        if self.faults:
            return GoalTable(faults=self.faults)
        numbers = np.array(self._numbers, np.float64).reshape(-1, 3 + len(self._turn))
        places, turns = numbers[:, :3], numbers[:, 3:]
        names = list(self._names)
        if not np.isfinite(turns).any():
            return GoalTable(names, places)
        is_hpb = len(self._turn) == len(TURN)
        turns = np.radians(turns) if is_hpb else quaternion_to_hpb(turns)
        return GoalTable(names, places, turns, self._turn[0])
