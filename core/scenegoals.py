"""The goals of a scene: from its own list, a CSV file or an NPZ file."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from limbik.core.errors import Fault
from limbik.core.frames import BY_NAME
from limbik.core.goals import GoalTable, read_goal_arrays, read_goals
from limbik.core.pole import Pole
from limbik.core.rotation import Array
from limbik.core.scenemodel import CsvModel, NpzModel, SceneModel, SolveModel
from limbik.core.yamlfile import Document, KeyPath


def goals_of(
    model: SolveModel, document: Document, folder: Path
) -> tuple[tuple[str, ...], Array, list[Fault]]:
    """Give names, positions (m, 3) in limbik's axes, and faults of the goals."""
    names, places, faults = _given(model, document, folder)
    return names, turned(model, places), faults


def pole_of(model: SolveModel) -> Pole | None:
    """Give the pole, in limbik's axes."""
    if model.pole is None:
        return None
    x, y, z = turned(model, np.array(model.pole.position)).tolist()
    return Pole(position=(x, y, z), rotor=model.pole.rotor)


def turned(model: SolveModel, places: Array) -> Array:
    """Return positions in limbik's axes that are given in the model's."""
    axes = BY_NAME.get(model.axes)
    return places if axes is None else axes.points(places)


def axes_faults(model: SolveModel, document: Document) -> Iterator[Fault]:
    """Refuse what only has a meaning in limbik's axes where a scene gives others."""
    if model.axes not in BY_NAME:
        return
    if isinstance(model, SceneModel) and model.trajectory is not None:
        message = "a trajectory is in limbik's axes"
        yield document.fault("axes", message, ("axes",), hint="leave 'axes' out")
    for number, goal in enumerate(model.goals if isinstance(model.goals, list) else ()):
        if goal.turn_key:
            message = "an orientation is in limbik's axes"
            hint = "leave 'axes' out and give the positions in limbik's axes too"
            yield document.fault("axes", message, ("goals", number, goal.turn_key), hint=hint)


def _given(
    model: SolveModel, document: Document, folder: Path
) -> tuple[tuple[str, ...], Array, list[Fault]]:
    if isinstance(model.goals, CsvModel):
        path = folder / model.goals.csv
        return _of_table(read_goals(path, str(path)), "csv", document)
    if isinstance(model.goals, NpzModel):
        path = folder / model.goals.npz
        return _of_table(read_goal_arrays(path, model.goals.array), "npz", document)
    given = [goal.name for goal in model.goals]
    faults = list(twice(given, ("goals",), "goal", document))
    if not model.goals and "goals" in document.content:
        message = "at least one goal is needed"
        faults.append(document.fault("empty", message, ("goals",)))
    names = tuple(name or str(number) for number, name in enumerate(given, 1))
    return names, np.array([goal.place for goal in model.goals]).reshape(-1, 3), faults


def _of_table(
    table: GoalTable, key: str, document: Document
) -> tuple[tuple[str, ...], Array, list[Fault]]:
    """Point faults without a place in the file at its key in the scene."""
    faults = [
        fault
        if fault.line
        else document.fault(
            fault.code,
            f"{fault.file}: {fault.message}",
            ("goals", fault.key if fault.key == "array" else key),
            hint=fault.hint,
        )
        for fault in table.faults
    ]
    return tuple(table.names), np.array(table.positions).reshape(-1, 3), faults


def turns_of(model: SolveModel) -> Array | None:
    """Return the goals' turns [rad], (m, 3); NaN for goals without one, None if no goal has."""
    turns = [goal.turn for goal in model.goals] if isinstance(model.goals, list) else []
    if all(turn is None for turn in turns):
        return None
    return np.array([np.full(3, np.nan) if turn is None else turn for turn in turns])


def twice(
    names: Sequence[str | None], path: KeyPath, what: str, document: Document
) -> Iterator[Fault]:
    """Give a fault for every name that is given again."""
    first: dict[str | None, int] = {}
    for index, name in enumerate(names):
        if name is not None and name in first:
            line, _ = document.position((*path, first[name], "name"))
            message = f"the {what} '{name}' is given twice, first at line {line}"
            yield document.fault("duplicate-name", message, (*path, index, "name"))
        first.setdefault(name, index)
