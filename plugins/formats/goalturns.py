"""How goals are turned, as the outputs `csv`, `json` and `npz` write it."""

from collections.abc import Sequence
from math import isnan

import numpy as np

from limbik.core.rotation import Array, hpb_to_matrix
from limbik.plugins.paths.quaternions import from_matrix


def turn_cells(turns: Array | None, count: int) -> list[Sequence[float | str]]:
    """Return the cells heading, pitch, bank [deg] of each goal; empty ones for a goal without.

    Args:
        turns: HPB, (m, 3) [rad], NaN for goals without; None for no such cells.
        count: Number of goals, m.
    """
    if turns is None:
        return [[] for _ in range(count)]
    return [row or ["", "", ""] for row in turn_record(turns)]


def turn_record(turns: Array) -> list[list[float] | None]:
    """Return heading, pitch, bank [deg] of each goal, (m, 3) [rad]; None for a goal without."""
    return [None if isnan(row[0]) else row for row in np.degrees(turns).tolist()]


def turn_quaternions(turns: Array) -> Array:
    """Return unit quaternions w, x, y, z of turns, (m, 3) [rad]; rows of NaN stay such."""
    found = np.full((len(turns), 4), np.nan)
    given = np.isfinite(turns).all(axis=1)
    found[given] = from_matrix(hpb_to_matrix(turns[given]))
    return found
