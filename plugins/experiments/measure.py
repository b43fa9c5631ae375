"""Measure a solved goal set: the measures of `limbik judge`, by name."""

from collections.abc import Sequence
from math import nan

import numpy as np

from limbik.core.errors import LimbikError
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.solution import Solution, Status
from limbik.core.solving import single_solver
from limbik.plugins.experiments.trials import Trial
from limbik.plugins.judging.catalogue import BY_NAME, Metric
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

    Measures of a motion say nothing about goals in no order.
    """
    if solution is None:
        return dict.fromkeys(metrics, nan)
    solver = single_solver(scene, registry)
    goal_set, offsets = trial.goal_set, scene.fk_offsets
    run = Run(solver, scene.goals, offsets, goal_set.follow, goal_set.rate, solution)

    def value(metric: Metric) -> float:
        if metric.on_path and not goal_set.is_path:
            return nan
        try:
            return metric.measure(run)
        except (NotJudged, LimbikError):
            return nan

    return {name: value(BY_NAME[name]) for name in metrics}
