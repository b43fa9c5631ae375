"""Parts of a table as bytes and back: Parquet where pyarrow is installed, else compressed NPZ."""

import json
import zlib
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from limbik.core.errors import EnvironmentProblem
from limbik.core.solution import Status
from limbik.plugins.output.encoding import npz_bytes

PARQUET: Final = "parquet"
NPZ: Final = "npz"
FAILED: Final = len(Status)
STATUSES: Final = (*(status.label for status in Status), "failed")
"""Words by the numbers in the column `status`; a failed solve has no pose."""

Column = NDArray[Any]
Table = dict[str, Column]
STAMP: Final = "limbik"
"""Name under which a part says what it belongs to."""
_UNREADABLE = (OSError, ValueError, KeyError, EOFError, BadZipFile, zlib.error)
_ALL_DIFFERENT = ("goal", "x", "y", "z", "distance")


def form_here() -> str:
    """Return the form new runs are written in on this machine."""
    return PARQUET if find_spec("pyarrow") else NPZ


def require_reader(form: str, place: Path) -> None:
    """Refuse parts that cannot be read here.

    Raises:
        EnvironmentProblem: They are Parquet and pyarrow is not installed.
    """
    if form == PARQUET and not find_spec("pyarrow"):
        message = f"the parts in {place} are Parquet: pip install 'limbik[experiments]'"
        raise EnvironmentProblem(message)


def encode(
    table: Table, labels: Mapping[str, Sequence[Any]], stamp: Mapping[str, Any], form: str
) -> bytes:
    """Return a part as the bytes of a file.

    Args:
        table: Columns of one length; the column `trial` counts up.
        labels: What Parquet shows beside the trial's number: for each column a value, all of one
            type, for each trial from the first to the last in the table.
        stamp: What the part says about itself.
        form: `parquet` or `npz`.
    """
    if form == NPZ:
        return npz_bytes({**table, STAMP: np.array(json.dumps(stamp))})
    import pyarrow as pa
    from pyarrow import parquet

    trial = table["trial"]
    index = pa.array((trial - trial[0]).astype(np.int32))
    made: dict[str, Any] = {"trial": pa.array(trial)}
    for name, values in labels.items():
        made[name] = pa.DictionaryArray.from_arrays(index, pa.array(values))
        if not isinstance(next((v for v in values if v is not None), ""), str):
            made[name] = made[name].dictionary_decode()
    for name, column in table.items():
        if name == "status":
            made[name] = pa.DictionaryArray.from_arrays(pa.array(column), pa.array(STATUSES))
        elif name != "trial":
            made[name] = pa.array(column, from_pandas=True)  # NaN becomes null
    sink = pa.BufferOutputStream()
    parquet.write_table(
        pa.table(made).replace_schema_metadata({STAMP: json.dumps(stamp)}),
        sink,
        compression="zstd",
        use_dictionary=[name for name in made if name not in _ALL_DIFFERENT],
        write_page_checksum=True,
    )
    return bytes(sink.getvalue())


def is_whole(path: Path, rows: int) -> bool:
    """Whether a part can be read and has so many rows; looks at its end only."""
    if not path.exists():
        return False
    try:
        if path.suffix == f".{NPZ}":
            with path.open("rb") as stream, np.load(stream) as part:
                return len(part["trial"]) == rows
        from pyarrow import parquet

        return int(parquet.read_metadata(path).num_rows) == rows
    except _UNREADABLE:
        return False


def decode(path: Path, columns: Sequence[str]) -> Table:
    """Read columns of numbers from a part; what is missing in a row is NaN.

    Args:
        path: The file.
        columns: Their names; the status comes as its place in `STATUSES`.

    Raises:
        EnvironmentProblem: It cannot be read.
    """
    try:
        if path.suffix == f".{NPZ}":
            with path.open("rb") as stream, np.load(stream) as part:
                return {name: part[name] for name in columns}
        return _from_parquet(path, columns)
    except _UNREADABLE as error:
        message = f"cannot read {path}: {error}; run the experiment again to make it anew"
        raise EnvironmentProblem(message) from error


def _from_parquet(path: Path, columns: Sequence[str]) -> Table:
    from pyarrow import parquet

    read = parquet.read_table(path, columns=list(columns), page_checksum_verification=True)
    table: Table = {}
    for name in columns:
        column = read.column(name).combine_chunks()
        if name == "status":
            codes = [STATUSES.index(word) for word in column.dictionary.to_pylist()]
            table[name] = np.array(codes, np.int8)[column.indices.to_numpy()]
        else:
            table[name] = column.to_numpy(zero_copy_only=False)
    return table
