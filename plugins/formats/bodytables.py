"""The outputs `csv`, `json` and `npz` of scenes with several chains.

What is a chain's own stands under the chain's name; positions are those of the whole skeleton.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from limbik.core.formats import BodyBake, Values
from limbik.core.frames import Y_UP
from limbik.core.goals import PLACE, TURN
from limbik.core.mirror import side_swapped
from limbik.core.rotation import Array
from limbik.core.solution import Solution
from limbik.plugins.formats.columns import labels, solution_arrays, solution_record, turn_cells
from limbik.plugins.output.encoding import csv_text, npz_bytes, to_json


def body_rows(
    names: Sequence[str],
    solutions: Mapping[str, Solution],
    times: Sequence[float] | None = None,
    values: Mapping[str, Values] | None = None,
    goal_turns: Mapping[str, Array] | None = None,
) -> str:
    """Write a CSV table, one line a frame: each chain's goal, status, distance, rounds and angles.

    Args:
        names: m names of frames.
        solutions: Of each chain, with a leading goal axis.
        times: m times [s]; absent = no such column.
        values: A model's own joint values, of chains that have some.
        goal_turns: How goals are turned, HPB, (m, 3) [rad], of chains that turn by them.
    """
    head = ["name", *([] if times is None else ["time"])]
    columns: list[list[Any]] = [list(names), *([] if times is None else [list(times)])]
    for chain, solution in solutions.items():
        angles = np.degrees(solution.angles).reshape(len(names), -1)
        own = (values or {}).get(chain)
        model = [f"{name} [{own.unit}]" for name in own.names] if own else []
        turns = (goal_turns or {}).get(chain)
        titles = [*PLACE, *(() if turns is None else TURN), "status", "distance", "iterations"]
        head += [f"{chain}: {title}" for title in (*titles, *solution.chain.axis_names, *model)]
        columns += solution.goal.T.tolist()
        columns += map(list, zip(*turn_cells(turns, len(names)), strict=True))
        columns += [labels(solution), np.asarray(solution.distance).tolist()]
        columns += [np.asarray(solution.iterations).tolist(), *angles.T.tolist()]
        columns += own.rows.T.tolist() if own else []
    return csv_text(head, zip(*columns, strict=True))


def _values(bake: BodyBake) -> dict[str, Values]:
    """Models' own joint values; a mirrored motion is not one of the model any more."""
    parts = () if bake.mirrored else bake.scene.parts
    found = {part.name: part.limb.values(bake.solutions[part.name].angles) for part in parts}
    return {name: values for name, values in found.items() if values is not None}


def _world(bake: BodyBake) -> tuple[list[str], Array, Array]:
    """Names, world positions and rotations of the whole skeleton, mirrored if asked for."""
    positions, rotations = bake.motion.world()
    names = list(bake.motion.names)
    if bake.mirrored:
        return side_swapped(names), Y_UP.points(positions), Y_UP.rotations(rotations)
    return names, positions, rotations


def write_body_csv(bake: BodyBake) -> str:
    """Write one line a frame."""
    times = [frame * bake.frame_time for frame in range(len(bake.scene.frame_names))]
    names, values = bake.scene.frame_names, _values(bake)
    return body_rows(names, bake.solutions, times, values, bake.goal_turns)


def write_body_json(bake: BodyBake) -> str:
    """Write one JSON object: the skeleton's positions, and the columns of each chain."""
    names, positions, _ = _world(bake)
    values = _values(bake)
    chains = {
        name: {
            "metrics": bake.metrics[name],
            **solution_record(solution, bake.goal_turns.get(name), values.get(name)),
        }
        for name, solution in bake.solutions.items()
    }
    record = {
        "scene": bake.scene.document.name,
        "mirrored": bake.mirrored,
        "frame_time": bake.frame_time,
        "joints": names,
        "parents": list(bake.motion.parents),
        "names": list(bake.scene.frame_names),
        "positions": positions.tolist(),
        "chains": chains,
    }
    return to_json(record) + "\n"


def write_body_npz(bake: BodyBake) -> bytes:
    """Write arrays: the skeleton's, and those of each chain as `chain/array`."""
    names, positions, rotations = _world(bake)
    arrays: dict[str, Any] = {
        "joints": np.array(names),
        "parents": np.array(bake.motion.parents),
        "names": np.array(bake.scene.frame_names),
        "frame_time": np.array(bake.frame_time),
        "positions": positions,
        "rotations": rotations,
        "chains": np.array(list(bake.solutions)),
    }
    values = _values(bake)
    for name, solution in bake.solutions.items():
        own = solution_arrays(solution, bake.goal_turns.get(name), values.get(name))
        arrays |= {f"{name}/{key}": array for key, array in own.items()}
    return npz_bytes(arrays)
