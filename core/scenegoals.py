"""The goals of a scene: from its own list, a CSV file, an NPZ file, or its chain's own motion."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from limbik.core.chain import vector
from limbik.core.errors import Fault
from limbik.core.formats import Body
from limbik.core.frames import BY_NAME
from limbik.core.goalarrays import read_goal_arrays
from limbik.core.goals import GoalTable, read_goals
from limbik.core.pole import Pole
from limbik.core.rotation import Array
from limbik.core.scenemodel import CsvModel, GoalModel, NpzModel, SolveModel
from limbik.core.yamlfile import Document, KeyPath


@dataclass(frozen=True, eq=False)
class Goals:
    """The goals of a chain.

    Attributes:
        names: m names.
        places: (m, 3) [length], in limbik's axes.
        turns: Orientations, HPB, (m, 3) [rad]; NaN for goals without, None if no goal has one.
        given: Where the orientations came from, as a path of the scene's keys.
        faults: What is wrong with them; the rest is only good when this is empty.
    """

    names: tuple[str, ...]
    places: Array
    turns: Array | None = None
    given: KeyPath = ("goals",)
    faults: tuple[Fault, ...] = ()


def goals_of(
    model: SolveModel, document: Document, folder: Path, title: str, body: Body | None
) -> Goals:
    """Give the goals of a chain.

    Args:
        model: What is asked for.
        document: Where the model came from.
        folder: Folder that relative paths start from.
        title: Name of the chain, if it is one of several.
        body: What the chain came from; its motion's goals are taken where the scene has none.
    """
    if body is not None and body.goals is not None and "goals" not in document.content:
        return Goals(body.goal_names, body.goals, body.goal_turns)
    if isinstance(model.goals, CsvModel):
        path = folder / model.goals.csv
        return _of_table(read_goals(path, str(path), title), "csv", model, document)
    if isinstance(model.goals, NpzModel):
        table = read_goal_arrays(folder / model.goals.npz, model.goals.array, title)
        return _of_table(table, "npz", model, document)
    return _listed(model.goals, model, document)


def pole_of(model: SolveModel) -> Pole | None:
    """Give the pole, in limbik's axes."""
    if model.pole is None:
        return None
    place = vector(turned(model, np.array(model.pole.position)))
    return Pole(position=place, rotor=model.pole.rotor)


def turned(model: SolveModel, places: Array) -> Array:
    """Return positions in limbik's axes that are given in the model's."""
    axes = BY_NAME.get(model.axes)
    return places if axes is None else axes.points(places)


def turn_paths(model: SolveModel) -> Iterator[KeyPath]:
    """Give the places of the orientations in a scene's own list of goals."""
    for number, goal in enumerate(model.goals if isinstance(model.goals, list) else ()):
        for key in goal.turn_keys:
            yield ("goals", number, key)


def taken_turns(model: SolveModel, goals: Goals, turns_end: bool) -> Array | None:
    """Return the goals' turns if anything turns by them; files may hold more than is asked for."""
    rotor = model.pole is not None and model.pole.rotor is not None
    taken = turns_end or model.is_planned or rotor or model.options.end_orientation > 0.0
    return goals.turns if taken else None


def axes_faults(model: SolveModel, document: Document) -> Iterator[Fault]:
    """Refuse what only has a meaning in limbik's axes where a scene gives others."""
    if model.axes not in BY_NAME:
        return
    if model.is_planned:
        message = "a trajectory is in limbik's axes"
        yield document.fault("axes", message, ("axes",), hint="leave 'axes' out")
    for path in turn_paths(model):
        yield _axes_fault(path, document)


def file_axes_faults(
    model: SolveModel, goals: Goals, turns: Array | None, document: Document
) -> Iterator[Fault]:
    """Refuse orientations of a file, where they are taken, likewise."""
    if turns is not None and model.axes in BY_NAME and isinstance(model.goals, CsvModel | NpzModel):
        yield _axes_fault(goals.given, document)


def _axes_fault(path: KeyPath, document: Document) -> Fault:
    message = "an orientation is in limbik's axes"
    hint = "leave 'axes' out and give the positions in limbik's axes too"
    return document.fault("axes", message, path, hint=hint)


def _of_table(table: GoalTable, key: str, model: SolveModel, document: Document) -> Goals:
    """Point faults without a place in the file at its key in the scene."""
    faults = tuple(
        document.placed(fault, ("goals", fault.key if fault.key == "array" else key))
        for fault in table.faults
    )
    places = turned(model, table.positions)
    return Goals(tuple(table.names), places, table.turns, ("goals", key), faults)


def _listed(goals: Sequence[GoalModel], model: SolveModel, document: Document) -> Goals:
    given = [goal.name for goal in goals]
    faults = list(twice(given, ("goals",), "goal", document))
    if not goals and "goals" in document.content:
        message = "at least one goal is needed"
        faults.append(document.fault("empty", message, ("goals",)))
    names = tuple(name or str(number) for number, name in enumerate(given, 1))
    places = turned(model, np.array([goal.place for goal in goals]).reshape(-1, 3))
    turns = [np.full(3, np.nan) if goal.turn is None else goal.turn for goal in goals]
    has_turns = any(goal.turn_keys for goal in goals)
    return Goals(names, places, np.array(turns) if has_turns else None, faults=tuple(faults))


def twice(
    names: Sequence[str | None],
    path: KeyPath,
    what: str,
    document: Document,
    *,
    inside: KeyPath = ("name",),
    hint: str = "",
) -> Iterator[Fault]:
    """Give a fault for every name that is given again.

    Args:
        names: Of the entries of a list; None for those without.
        path: Place of the list.
        what: The entries are.
        document: Where the list stands.
        inside: Place of a name in its entry.
        hint: What to try.
    """
    first: dict[str | None, int] = {}
    for index, name in enumerate(names):
        if name is not None and name in first:
            line, _ = document.position((*path, first[name], *inside))
            message = f"the {what} '{name}' is given twice, first at line {line}"
            yield document.fault("duplicate-name", message, (*path, index, *inside), hint=hint)
        first.setdefault(name, index)
