"""Results as the content of files: JSON, CSV, NPZ."""

import csv
import io
import json
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import numpy as np

SCHEMA = 1
"""Keys of JSON records are never taken away while this stays the same number."""


def to_json(record: dict[str, Any]) -> str:
    """Write a record as one JSON object; a number that is not finite becomes null."""
    return json.dumps(_finite({"schema": SCHEMA, **record}), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:
    """Replace what JSON cannot hold by null."""
    if isinstance(value, float):
        return value if isfinite(value) else None
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    return value


def csv_text(head: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Write a CSV table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    return text.getvalue()


def npz_bytes(arrays: Mapping[str, Any]) -> bytes:
    """Write arrays by their names as a compressed NPZ file."""
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()
