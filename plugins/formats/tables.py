"""The outputs `csv`, `json` and `npz`: every frame's angles, positions, status and distance.

Angles in degrees in text, in radians in arrays; a robot's own joint values as its file has them.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np

from limbik.core.formats import Bake, Output, Values
from limbik.core.frames import mirror_hpb
from limbik.core.goals import PLACE, TURN
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array
from limbik.plugins.formats.bodytables import write_body_csv, write_body_json, write_body_npz
from limbik.plugins.formats.columns import labels, solution_arrays, solution_record, turn_cells
from limbik.plugins.output.encoding import csv_text, npz_bytes, to_json


def unmirrored(bake: Bake) -> Array:
    """Return the angles as they were solved, before a mirror, HPB (m, n, 3) [rad]."""
    angles = bake.solution.angles
    return mirror_hpb(angles) if bake.mirrored else angles


def _values(bake: Bake) -> Values | None:
    """A model's own joint values; a mirrored motion is not one of the model any more."""
    return None if bake.mirrored else bake.body.values(bake.solution.angles)


def _times(bake: Bake) -> list[float]:
    return [frame * bake.frame_time for frame in range(len(bake.solution.goal))]


def write_csv(bake: Bake) -> str:
    """Write one line a frame; its columns of name and goal make it a goal file again."""
    solution, values = bake.solution, _values(bake)
    own = [f"{name} [{values.unit}]" for name in values.names] if values else []
    told = list(bake.servos.names) if bake.servos else []
    turns = bake.goal_turns
    head = ["name", "time", *PLACE, *(() if turns is None else TURN)]
    head += ["status", "distance", "iterations", *solution.chain.axis_names, *own, *told]
    degrees = np.degrees(solution.angles).reshape(len(solution.goal), -1).tolist()
    rows, ticks = (
        kind.rows.tolist() if kind else [[] for _ in degrees] for kind in (values, bake.servos)
    )
    columns = (
        bake.scene.goal_names,
        _times(bake),
        solution.goal.tolist(),
        turn_cells(turns, len(solution.goal)),
        labels(solution),
        np.asarray(solution.distance).tolist(),
        np.asarray(solution.iterations).tolist(),
        degrees,
        rows,
        ticks,
    )
    lines = (
        [name, time, *goal, *turn, *rest, *turned, *row, *tick]
        for name, time, goal, turn, *rest, turned, row, tick in zip(*columns, strict=True)
    )
    return csv_text(head, lines)


def write_json(bake: Bake) -> str:
    """Write one JSON object: columns of the motion, and what the motion is like."""
    record: dict[str, Any] = {
        "scene": bake.scene.document.name,
        "mirrored": bake.mirrored,
        "frame_time": bake.frame_time,
        "metrics": bake.metrics,
        "names": list(bake.scene.goal_names),
        **solution_record(bake.solution, bake.goal_turns, _values(bake)),
        "positions": bake.solution.positions.tolist(),
    }
    if bake.servos:
        record["servos"] = list(bake.servos.names)
        record["servo_ticks"] = bake.servos.rows.tolist()
    return to_json(record) + "\n"


def write_npz(bake: Bake) -> bytes:
    """Write arrays: angles (m, n, 3) [rad], positions, rotations, goals, status, distance.

    Goals with an orientation have it as `quaternions` w, x, y, z, (m, 4), NaN where there is none.
    """
    arrays: dict[str, Any] = {
        "names": np.array(bake.scene.goal_names),
        "frame_time": np.array(bake.frame_time),
        **solution_arrays(bake.solution, bake.goal_turns, _values(bake)),
        "positions": bake.solution.positions,
        "rotations": bake.solution.rotations,
    }
    if bake.servos:
        arrays |= {"servos": np.array(bake.servos.names), "servo_ticks": bake.servos.rows}
    return npz_bytes(arrays)


@hookimpl
def limbik_outputs() -> Iterable[Output]:
    """Offer `csv`, `json` and `npz`."""
    line = "One line a frame, angles in degrees."
    columns = "Columns of the motion, angles in degrees."
    arrays = "Arrays of the motion, angles in radians."
    return [
        Output("csv", (".csv",), write_csv, line, write_body_csv, True),
        Output("json", (".json",), write_json, columns, write_body_json, True),
        Output("npz", (".npz",), write_npz, arrays, write_body_npz, True),
    ]
