"""Strategies x sweeps: every set of options an experiment tries on a scene."""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from itertools import product
from typing import Any

from limbik.core.settings import Settings
from limbik.core.slots import OPTIONS
from limbik.plugins.experiments.model import ExperimentModel, StrategyModel

Choice = str | dict[str, Any]


@dataclass(frozen=True)
class Variant:
    """A strategy with one value of everything that is swept.

    Attributes:
        number: Of its strategy, from 0.
        strategy: The strategy's name.
        params: What is swept, by the option's name.
        options: What the strategy sets on top of a scene's options.
        solver: The solver it asks for; None for the scene's.
    """

    number: int
    strategy: str
    params: Mapping[str, Any]
    options: Mapping[str, Any]
    solver: Choice | None

    @property
    def label(self) -> str:
        """The strategy's name and what is swept, for people."""
        swept = (f"{name}={shown(value)}" for name, value in self.params.items())
        return " ".join([self.strategy, *swept])


def shown(value: Any) -> str:
    """Write a swept value briefly."""
    if isinstance(value, dict):
        inner = (f"{name}={shown(item)}" for name, item in value.items() if name != "use")
        return "/".join([str(value.get("use", "")), *inner]).strip("/")
    if isinstance(value, list):
        return "[" + " ".join(map(shown, value)) + "]"
    if isinstance(value, bool) or value is None:
        return {True: "true", False: "false", None: "null"}[value]
    return f"{value:g}" if isinstance(value, float) else str(value)


def axes_of(model: ExperimentModel, strategy: StrategyModel) -> dict[str, list[Any]]:
    """Return what is swept for a strategy: the experiment's axes, then its own."""
    return {**model.sweep, **strategy.sweep}


def variants(model: ExperimentModel) -> Iterator[Variant]:
    """Give every variant, in the order of the file; the last axis changes fastest."""
    for number, strategy in enumerate(model.strategies):
        axes = axes_of(model, strategy)
        for values in product(*axes.values()):
            params = dict(zip(axes, values, strict=True))
            yield Variant(number, strategy.name, params, strategy.options, strategy.solver)


def place(options: dict[str, Any], name: str, value: Any) -> None:
    """Put a swept value into options; `bend_vector.angle` reaches into a strategy's parameters."""
    first, *rest = name.split(".")
    if not rest:
        options[first] = value
        return
    found = options.get(first)
    if found is None and first in OPTIONS:
        found = Settings.model_fields[first].default
    inner = {"use": found} if isinstance(found, str) else dict(found or {})
    place(inner, ".".join(rest), value)
    options[first] = inner


def merged(base: Settings, variant: Variant) -> dict[str, Any]:
    """Return a scene's options with the strategy's on top, and on top of both what is swept."""
    options = {**base.model_dump(exclude_unset=True), **deepcopy(dict(variant.options))}
    for name, value in variant.params.items():
        place(options, name, value)
    return options
