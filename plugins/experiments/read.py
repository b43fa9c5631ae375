"""Read an experiment file: all faults at once, each at its place, before anything is solved."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from limbik.core.errors import Fault, InputError, SceneError, shortlist
from limbik.core.goals import read_goals
from limbik.core.registry import Registry
from limbik.core.scene import Scene, read_scene
from limbik.core.scenegoals import twice
from limbik.core.validation import validation_faults
from limbik.core.wording import near_match
from limbik.core.yamlfile import Document, KeyPath, read_yaml_file
from limbik.plugins.experiments.checks import option_faults, ready_variants
from limbik.plugins.experiments.goalsets import Grid, Points, Reach, along, seed_of
from limbik.plugins.experiments.model import (
    MOST_GOALS,
    ExperimentModel,
    FileModel,
    GoalsModel,
    GridModel,
    PathModel,
    ReachModel,
)
from limbik.plugins.experiments.overrides import Override, apply, blame
from limbik.plugins.experiments.trials import GoalSet, Trial, trials
from limbik.plugins.experiments.variants import axes_of, variants
from limbik.plugins.judging.catalogue import BY_NAME

MOST_TRIALS = 20_000
MOST_MEASURED = 1_000_000
"""Joints posed for a goal set that is solved or measured as a whole: all are held in memory."""


@dataclass(frozen=True)
class Experiment:
    """An experiment that can be run.

    Attributes:
        name: Its name.
        model: What the file says, with all overrides.
        scenes: The scenes by the chains' names.
        trials: All trials, in the order of the file.
        distributions: Packages of the plug-ins that are used, beside limbik.
    """

    name: str
    model: ExperimentModel
    scenes: dict[str, Scene]
    trials: list[Trial]
    distributions: tuple[str, ...]


def read_experiment(
    path: str | Path, overrides: Sequence[Override] = (), registry: Registry | None = None
) -> Experiment:
    """Read an experiment file and the files it names.

    Args:
        path: The file.
        overrides: Values from the command line.
        registry: Where strategies are looked up; a new one if absent.

    Raises:
        InputError: With every fault that could be found.
        PluginError: A plug-in does not work.
    """
    registry = registry or Registry()
    document = apply(read_yaml_file(path), overrides)
    try:
        return _experiment(document, Path(path), registry)
    except SceneError as error:
        raise SceneError(blame(error.faults, overrides)) from None


def _experiment(document: Document, path: Path, registry: Registry) -> Experiment:
    try:
        model = ExperimentModel.model_validate(document.content)
    except ValidationError as error:
        raise SceneError(validation_faults(error, document, ExperimentModel)) from None
    names = [chain.name or Path(chain.scene).stem for chain in model.chains]
    set_names = [_set_name(goals) for goals in model.goals]
    faults = [*_twice(names, "chains", "chain", document)]
    faults += _twice([s.name for s in model.strategies], "strategies", "strategy", document)
    faults += _twice(set_names, "goals", "goal set", document)
    faults += _metric_faults(model, document)
    faults += option_faults(model, document, registry)
    faults += _chain_name_faults(model, names, document)
    scenes, found = _scenes(model, names, document, path.parent, registry)
    faults += found
    sets, found = _goal_sets(model, set_names, document, path.parent)
    faults += found
    faults += _too_many_to_measure(model, sets, names, scenes, document)
    faults += _plane_faults(model, names, scenes, document)
    if faults:
        raise SceneError(shortlist(faults))
    _check_size(model, sum(map(len, sets)), document)
    tried = list(variants(model))
    ready, distributions, found = ready_variants(tried, scenes, document, registry)
    if found:
        raise SceneError(shortlist(found))
    by_chain = {
        name: [
            goal_set
            for number, goals in enumerate(model.goals)
            if goals.chains is None or name in goals.chains
            for goal_set in sets[number]
        ]
        for name in names
    }
    title = model.name or path.stem
    found_trials = list(trials(ready, by_chain))
    return Experiment(title, model, scenes, found_trials, tuple(sorted(distributions)))


def _set_name(goals: GoalsModel) -> str:
    source = getattr(goals, "csv", None)
    return goals.name or (Path(source).stem if source else goals.kind)


def _twice(names: list[str], key: str, what: str, document: Document) -> Iterator[Fault]:
    hint = "give it a name of its own with 'name'"
    return twice(names, (key,), what, document, inside=(), hint=hint)


def _metric_faults(model: ExperimentModel, document: Document) -> Iterator[Fault]:
    for index, name in enumerate(model.metrics):
        place: KeyPath = ("metrics", index)
        if name not in BY_NAME:
            hint = near_match(name, list(BY_NAME)) or f"known: {', '.join(BY_NAME)}"
            yield document.fault(
                "unknown-metric", f"no metric is called '{name}'", place, hint=hint
            )
        elif name in model.metrics[:index]:
            yield document.fault("duplicate-name", f"'{name}' is given twice", place)


def _chain_name_faults(
    model: ExperimentModel, names: list[str], document: Document
) -> Iterator[Fault]:
    for number, goals in enumerate(model.goals):
        for index, name in enumerate(goals.chains or ()):
            if name not in names:
                hint = near_match(name, names) or f"known: {', '.join(names)}"
                message = f"no chain is called '{name}'"
                place = ("goals", number, "chains", index)
                yield document.fault("unknown-chain", message, place, hint=hint)


def _scenes(
    model: ExperimentModel, names: list[str], document: Document, folder: Path, registry: Registry
) -> tuple[dict[str, Scene], list[Fault]]:
    """Read the scenes; a fault inside one is told with its own file and line."""
    scenes: dict[str, Scene] = {}
    faults: list[Fault] = []
    for index, (name, chain) in enumerate(zip(names, model.chains, strict=True)):
        try:
            scenes[name] = read_scene(folder / chain.scene, registry)
        except InputError as error:
            faults += [document.placed(fault, ("chains", index)) for fault in error.faults]
    return scenes, faults


def _goal_sets(
    model: ExperimentModel, names: list[str], document: Document, folder: Path
) -> tuple[list[list[GoalSet]], list[Fault]]:
    """Make the goal sets, several of one where its draw is repeated."""
    faults: list[Fault] = []
    sets: list[list[GoalSet]] = []
    for number, (name, goals) in enumerate(zip(names, model.goals, strict=True)):
        found: list[GoalSet] = []
        match goals:
            case ReachModel():
                for repeat in range(goals.repeats):
                    seed = seed_of(model.seed, name, repeat)
                    drawn = Reach(seed, goals.by, 0, goals.count)
                    found.append(GoalSet(name, drawn, repeat=repeat))
            case GridModel():
                total = int(np.prod(goals.steps, dtype=object))
                if total > MOST_GOALS:
                    message = f"{total} goals, the most are {MOST_GOALS}"
                    faults.append(document.fault("too-many", message, ("goals", number, "steps")))
                grid = Grid(goals.steps, goals.low, goals.high, 0, min(total, MOST_GOALS))
                found.append(GoalSet(name, grid))
            case PathModel(through=list() as corners):
                found.append(_path(name, along(corners, goals.count), goals))
            case PathModel() | FileModel():
                points, wrong = _csv(str(goals.csv), number, document, folder)
                faults += wrong
                is_path = isinstance(goals, PathModel)
                found.append(_path(name, points, goals) if is_path else GoalSet(name, points))
        sets.append(found)
    return sets, faults


def _path(name: str, points: Points, goals: Any) -> GoalSet:
    return GoalSet(name, points, True, goals.follow, goals.rate)


def _csv(name: str, number: int, document: Document, folder: Path) -> tuple[Points, list[Fault]]:
    table = read_goals(folder / name, str(folder / name))
    faults = [document.placed(fault, ("goals", number, "csv")) for fault in table.faults]
    return Points(table.positions), faults


def _too_many_to_measure(
    model: ExperimentModel,
    sets: list[list[GoalSet]],
    names: list[str],
    scenes: dict[str, Scene],
    document: Document,
) -> Iterator[Fault]:
    """Refuse goal sets that are solved or measured as a whole and would not fit into memory."""
    for number, (goals, found) in enumerate(zip(model.goals, sets, strict=True)):
        met = [len(scenes[name].chain) for name in goals.chains or names if name in scenes]
        is_path = isinstance(goals, PathModel)
        if not found or not met or not (model.metrics or is_path):
            continue
        count, most = len(found[0].goals), MOST_MEASURED // max(met)
        if count > most:
            what = "a path is solved" if is_path else "metrics are measured"
            message = f"{what} as a whole: with {max(met)} joints at most {most} goals, not {count}"
            yield document.fault("too-many", message, ("goals", number))


def _plane_faults(
    model: ExperimentModel, names: list[str], scenes: dict[str, Scene], document: Document
) -> Iterator[Fault]:
    """Refuse angles drawn within the limits of chains that have planar ones instead."""
    planar = [name for name, scene in scenes.items() if scene.pole is not None]
    for number, goals in enumerate(model.goals):
        met = [name for name in planar if name in (goals.chains or names)]
        if isinstance(goals, ReachModel) and goals.by == "joints" and met:
            message = f"'{met[0]}' is solved in 2D, where a goal turns the plane of all joints"
            place = ("goals", number)
            yield document.fault("choice", message, place, hint="write 'by: ball'")


def _check_size(model: ExperimentModel, sets: int, document: Document) -> None:
    """Refuse more trials than one can look at, before they are made."""
    tried = sum(prod(map(len, axes_of(model, strategy).values())) for strategy in model.strategies)
    count = tried * sets * len(model.chains)
    if count > MOST_TRIALS:
        message = f"{tried} variants x {len(model.chains)} chains x {sets} goal sets: "
        message += f"more than {MOST_TRIALS} trials"
        raise SceneError([document.fault("too-many", message, ("strategies",))])
