"""Measure a solved goal set: the measures of `limbik judge`, by name."""

from collections.abc import Sequence
from math import nan

import numpy as np

from limbik.core.errors import LimbikError
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.solution import Solution, Status
from limbik.core.solving import scene_solver
from limbik.plugins.experiments.trials import Trial
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.judging.run import NotJudged, Run

PATH_COLUMNS = ("goals", "reached", "distance_p50", "distance_p95", "distance_max", "iterations")


def path_columns(scene: Scene, solution: Solution | None) -> dict[str, float]:
    """Return what every row of the table `paths` has: counts, shares and distances [length]."""
    if solution is None:
        return dict.fromkeys(PATH_COLUMNS, nan) | {"goals": float(len(scene.goals))}
    distance = np.asarray(solution.distance)
    half, most, largest = np.percentile(distance, (50, 95, 100)).tolist()
    values = (
        float(len(distance)),
        float(np.mean(np.asarray(solution.status) == Status.REACHED)),
        half,
        most,
        largest,
        float(np.mean(solution.iterations)),
    )
    return dict(zip(PATH_COLUMNS, values, strict=True))


def measured(
    trial: Trial,
    scene: Scene,
    solution: Solution | None,
    metrics: Sequence[str],
    registry: Registry,
) -> dict[str, float]:
    """Return metrics by name; NaN where one says nothing about this goal set.

    Measures of a motion say nothing about goals in no order, and a whole solver of a plug-in is
    not measured: the measures solve again in ways only limbik's own solver knows.
    """
    if solution is None or scene.solver is not None:
        return dict.fromkeys(metrics, nan)
    goal_set = trial.goal_set
    run = Run(
        scene_solver(scene, registry),
        scene.goals,
        scene.fk_offsets,
        goal_set.follow,
        goal_set.rate,
        solution,
    )
    return {name: _value(name, run, goal_set.is_path) for name in metrics}


def _value(name: str, run: Run, is_path: bool) -> float:
    metric = BY_NAME[name]
    if metric.on_path and not is_path:
        return nan
    try:
        return metric.measure(run)
    except (NotJudged, LimbikError):
        return nan
