"""The outputs `csv`, `json` and `npz`: every frame's angles, positions, status and distance.

Angles in degrees in text, in radians in arrays; a robot's own joint values as its file has them.
"""

import io
from collections.abc import Iterable
from typing import Any

import numpy as np

from limbik.core.chain import AXES
from limbik.core.formats import Bake, Output, Values
from limbik.core.frames import mirror_hpb
from limbik.core.goals import PLACE, TURN
from limbik.core.hooks import hookimpl
from limbik.core.rotation import Array
from limbik.core.solution import Status
from limbik.plugins.formats.bodytables import write_body_csv, write_body_json, write_body_npz
from limbik.plugins.formats.goalturns import turn_cells, turn_quaternions, turn_record


def unmirrored(bake: Bake) -> Array:
    """Return the angles as they were solved, before a mirror, HPB (m, n, 3) [rad]."""
    angles = bake.solution.angles
    return mirror_hpb(angles) if bake.mirrored else angles


def _values(bake: Bake) -> Values | None:
    """A model's own joint values; a mirrored motion is not one of the model any more."""
    return None if bake.mirrored else bake.body.values(bake.solution.angles)


def _labels(bake: Bake) -> list[str]:
    return [Status(int(status)).label for status in np.asarray(bake.solution.status)]


def _times(bake: Bake) -> list[float]:
    return [frame * bake.frame_time for frame in range(len(bake.solution.goal))]


def write_csv(bake: Bake) -> str:
    """Write one line a frame; its columns of name and goal make it a goal file again."""
    import csv

    solution, values = bake.solution, _values(bake)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    angles = [f"{name} {axis}" for name in solution.chain.names for axis in AXES]
    own = [f"{name} [{values.unit}]" for name in values.names] if values else []
    told = list(bake.servos.names) if bake.servos else []
    turns = bake.goal_turns
    head = ["name", "time", *PLACE, *(() if turns is None else TURN)]
    head += ["status", "distance", "iterations"]
    writer.writerow([*head, *angles, *own, *told])
    degrees = np.degrees(solution.angles).reshape(len(solution.goal), -1).tolist()
    rows, ticks = (
        kind.rows.tolist() if kind else [[] for _ in degrees] for kind in (values, bake.servos)
    )
    columns = (
        bake.scene.goal_names,
        _times(bake),
        solution.goal.tolist(),
        turn_cells(turns, len(solution.goal)),
        _labels(bake),
        np.asarray(solution.distance).tolist(),
        np.asarray(solution.iterations).tolist(),
        degrees,
        rows,
        ticks,
    )
    for name, time, goal, turn, *rest, turned, row, tick in zip(*columns, strict=True):
        writer.writerow([name, time, *goal, *turn, *rest, *turned, *row, *tick])
    return text.getvalue()


def write_json(bake: Bake) -> str:
    """Write one JSON object: columns of the motion, and what the motion is like."""
    from limbik.plugins.output.records import to_json

    solution, values = bake.solution, _values(bake)
    record: dict[str, Any] = {
        "scene": bake.scene.document.name,
        "mirrored": bake.mirrored,
        "frame_time": bake.frame_time,
        "joints": list(solution.chain.names),
        "metrics": bake.metrics,
        "names": list(bake.scene.goal_names),
        "goals": solution.goal.tolist(),
        "status": _labels(bake),
        "distance": np.asarray(solution.distance).tolist(),
        "iterations": np.asarray(solution.iterations).tolist(),
        "angles": np.degrees(solution.angles).tolist(),
        "positions": solution.positions.tolist(),
    }
    if bake.goal_turns is not None:
        record["goal_rotations"] = turn_record(bake.goal_turns)
    if values:
        own = {"names": list(values.names), "unit": values.unit, "rows": values.rows.tolist()}
        record["model_values"] = own
    if bake.servos:
        record["servos"] = list(bake.servos.names)
        record["servo_ticks"] = bake.servos.rows.tolist()
    return to_json(record) + "\n"


def write_npz(bake: Bake) -> bytes:
    """Write arrays: angles (m, n, 3) [rad], positions, rotations, goals, status, distance.

    Goals with an orientation have it as `quaternions` w, x, y, z, (m, 4), NaN where there is none.
    """
    solution, values = bake.solution, _values(bake)
    arrays: dict[str, Any] = {
        "joints": np.array(solution.chain.names),
        "names": np.array(bake.scene.goal_names),
        "frame_time": np.array(bake.frame_time),
        "goals": solution.goal,
        "angles": solution.angles,
        "positions": solution.positions,
        "rotations": solution.rotations,
        "status": np.asarray(solution.status),
        "distance": np.asarray(solution.distance),
        "iterations": np.asarray(solution.iterations),
    }
    if bake.goal_turns is not None:
        arrays["quaternions"] = turn_quaternions(bake.goal_turns)
    if values:
        arrays |= {"model_names": np.array(values.names), "model_values": values.rows}
    if bake.servos:
        arrays |= {"servos": np.array(bake.servos.names), "servo_ticks": bake.servos.rows}
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


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
