"""Goals out of NPZ files, such as NumPy, `limbik bake` and `limbik trajectory` write.

Positions are an array `goals` or `positions`, (m, 3). Their orientations, if there are any, are an
array `hpb`, (m, 3) [deg], or `quaternions`, (m, 4) as w, x, y, z; a row of NaN is a goal without.
`names` has as many texts, otherwise goals are numbered. Files of several chains hold `arm/goals`.
"""

from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile
from zlib import error as zlib_error

import numpy as np
from numpy.typing import NDArray

from limbik.core.errors import Fault
from limbik.core.goals import MOST_GOALS, GoalTable
from limbik.core.goalturn import quaternion_to_hpb
from limbik.core.rotation import Array
from limbik.core.scenemodel import FARTHEST, FULLEST

PLACES = ("goals", "positions")
TURNS = {"hpb": 3, "quaternions": 4}
MOST_BYTES = 500_000_000


def read_goal_arrays(path: Path, array: str | None, chain: str = "") -> GoalTable:
    """Read goals from an NPZ file; never raises for what the file holds.

    Args:
        path: The file; nothing in it is executed.
        array: Name of the array of positions; None for the first there is of `PLACES`.
        chain: The chain whose goals are wanted, where the file holds those of several.
    """
    table, shown = GoalTable(), str(path)
    try:
        if message := _too_large(path):
            table.faults.append(Fault("too-large", message, file=shown))
            return table
        with np.load(path, allow_pickle=False) as file:
            if not isinstance(file, np.lib.npyio.NpzFile):
                raise ValueError("not an archive")
            table = _table(file, array, chain)
    except _Refused as refused:
        table.faults.append(
            Fault(refused.code, str(refused), refused.key, shown, hint=refused.hint)
        )
    except OSError as error:
        message = f"cannot read the file: {error.strerror or error}"
        table.faults.append(Fault("unreadable", message, file=shown))
    except (ValueError, EOFError, BadZipFile, zlib_error):
        table.faults.append(Fault("npz", "this is no NPZ file of plain arrays", file=shown))
    return table


class _Refused(Exception):
    """What is wrong with an array."""

    def __init__(self, message: str, code: str = "array", key: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.code, self.key, self.hint = code, key, hint


def _too_large(path: Path) -> str:
    """Say so if a file's arrays would fill the memory, however small they are packed."""
    with ZipFile(path) as archive:
        size = sum(member.file_size for member in archive.infolist())
    return f"its arrays hold {size} bytes, the limit is {MOST_BYTES}" if size > MOST_BYTES else ""


def _table(file: Any, array: str | None, chain: str) -> GoalTable:
    wanted = PLACES if array is None else (array,)
    own = [f"{chain}/{name}" for name in wanted] if array is None and chain else []
    found = next((name for name in (*own, *wanted) if name in file.files), None)
    if found is None:
        hint = f"it has: {', '.join(file.files[:12])}"
        key = "" if array is None else "array"
        raise _Refused(f"there is no array {' or '.join(wanted)}", "unknown-array", key, hint)
    places = _numbers(file[found], found, 3, FARTHEST)
    if not 1 <= len(places) <= MOST_GOALS:
        raise _Refused(f"the array '{found}' must hold 1 to {MOST_GOALS} goals, not {len(places)}")
    names = file["names"] if "names" in file.files else np.zeros(0)
    numbers = range(1, len(places) + 1)
    named = names.dtype.kind == "U" and names.shape == (len(places),)
    titles = [str(name) for name in (names if named else numbers)]
    turns, turned_by = _turns(file, found.rpartition("/")[0], len(places))
    return GoalTable(titles, places, turns, turned_by)


def _turns(file: Any, folder: str, count: int) -> tuple[Array | None, str]:
    """Read the orientations beside an array of positions, and the name of their array."""
    wanted = {f"{folder}/{name}" if folder else name: size for name, size in TURNS.items()}
    given = [name for name in wanted if name in file.files]
    if not given:
        return None, ""
    if len(given) > 1:
        raise _Refused(f"one orientation, '{given[0]}' or '{given[1]}', not both")
    name = given[0]
    turns = _numbers(file[name], name, wanted[name], FULLEST, may_lack=True)
    if len(turns) != count:
        raise _Refused(f"the array '{name}' must hold {count} orientations, not {len(turns)}")
    if np.isnan(turns).all():
        return None, ""
    if wanted[name] == TURNS["hpb"]:
        return np.radians(turns), name
    try:
        return quaternion_to_hpb(turns), name
    except ValueError as error:
        raise _Refused(f"the array '{name}': {error}") from None


def _numbers(
    found: NDArray[Any], name: str, size: int, most: float, may_lack: bool = False
) -> Array:
    """Check an array of rows; rows that are all NaN pass where they may lack."""
    must = f"the array '{name}' must hold numbers"
    if found.ndim != 2 or found.shape[-1] != size or found.dtype.kind not in "iuf":
        raise _Refused(f"{must} of shape (m, {size}), not {found.dtype} of {found.shape}")
    good = (np.abs(found) <= most).all(axis=1)  # false for NaN too
    if may_lack:
        good |= np.isnan(found).all(axis=1)
    if not good.all():
        row = int(np.flatnonzero(~good)[0])
        span = f"between -{most:g} and {most:g}"
        raise _Refused(f"{must} {span}; row {row}, counted from 0, does not")
    return np.asarray(found, np.float64)
