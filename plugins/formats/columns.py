"""What the outputs `csv`, `json` and `npz` have of one chain, alone or among several."""

from collections.abc import Sequence
from math import isnan
from typing import Any

import numpy as np

from limbik.core.formats import Values
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_quaternion
from limbik.core.solution import Solution, Status


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
    found[given] = matrix_to_quaternion(hpb_to_matrix(turns[given]))
    return found


def labels(solution: Solution) -> list[str]:
    """Give the status of every goal as a word."""
    return [Status(int(status)).label for status in np.asarray(solution.status)]


def solution_record(
    solution: Solution, turns: Array | None, values: Values | None
) -> dict[str, Any]:
    """Describe the motion of a chain by its columns, angles in degrees.

    Args:
        solution: With a leading goal axis.
        turns: How the goals are turned, HPB, (m, 3) [rad]; None where nothing turns by them.
        values: The model's own joint values, if it has some.
    """
    record: dict[str, Any] = {
        "joints": list(solution.chain.names),
        "goals": solution.goal.tolist(),
        "status": labels(solution),
        "distance": np.asarray(solution.distance).tolist(),
        "iterations": np.asarray(solution.iterations).tolist(),
        "angles": np.degrees(solution.angles).tolist(),
    }
    if turns is not None:
        record["goal_rotations"] = turn_record(turns)
    if values is not None:
        own = {"names": list(values.names), "unit": values.unit, "rows": values.rows.tolist()}
        record["model_values"] = own
    return record


def solution_arrays(
    solution: Solution, turns: Array | None, values: Values | None
) -> dict[str, Any]:
    """Return the motion of a chain as arrays, angles in radians; arguments of `solution_record`."""
    arrays: dict[str, Any] = {
        "joints": np.array(solution.chain.names),
        "goals": solution.goal,
        "angles": solution.angles,
        "status": np.asarray(solution.status),
        "distance": np.asarray(solution.distance),
        "iterations": np.asarray(solution.iterations),
    }
    if turns is not None:
        arrays["quaternions"] = turn_quaternions(turns)
    if values is not None:
        arrays |= {"model_names": np.array(values.names), "model_values": values.rows}
    return arrays
