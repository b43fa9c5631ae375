"""Columns that say in words what a trial is, for readers of single parts."""

from collections.abc import Sequence
from typing import Any

from limbik.plugins.experiments.trials import Trial
from limbik.plugins.experiments.variants import shown


def label_columns(trials: Sequence[Trial]) -> dict[str, list[Any]]:
    """Return chain, strategy, goals, repeat, the chain's length and what is swept, a value a trial.

    A column of swept values is of numbers or truth values where all of them are, else of text; a
    strategy that does not sweep it has None.
    """
    columns: dict[str, list[Any]] = {
        "chain": [trial.chain for trial in trials],
        "strategy": [trial.strategy for trial in trials],
        "goals": [trial.goal_set.name for trial in trials],
        "repeat": [trial.goal_set.repeat for trial in trials],
        "length": [trial.scene.chain.length for trial in trials],
    }
    for name in dict.fromkeys(name for trial in trials for name in trial.params):
        columns[name] = _of_one_type([trial.params.get(name) for trial in trials])
    return columns


def _of_one_type(values: list[Any]) -> list[Any]:
    given = [value for value in values if value is not None]
    if all(isinstance(value, bool) for value in given):
        return values
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in given):
        return [None if value is None else float(value) for value in values]
    return [None if value is None else shown(value) for value in values]
