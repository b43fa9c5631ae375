"""Whether the options an experiment names exist, have sense, and suit its chains."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import ValidationError

from limbik.core.choices import choice_faults
from limbik.core.errors import Fault, InputError
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.settings import Settings
from limbik.core.slots import OPTIONS, SOLVER
from limbik.core.solving import scene_solver
from limbik.core.validation import validation_faults
from limbik.core.whole import OWN_SOLVERS, prepare
from limbik.core.wording import near_match
from limbik.core.yamlfile import Document, KeyPath
from limbik.plugins.experiments.model import ExperimentModel
from limbik.plugins.experiments.trials import scene_for
from limbik.plugins.experiments.variants import Choice, Variant, merged

Ready = tuple[Variant, Scene, Choice | None]


def option_faults(
    model: ExperimentModel, document: Document, registry: Registry
) -> Iterator[Fault]:
    """Check options and swept values where they stand, each by itself."""
    yield from _sweep_faults(model.sweep, ("sweep",), document, registry)
    for number, strategy in enumerate(model.strategies):
        place: KeyPath = ("strategies", number)
        yield from _options_faults(strategy.options, (*place, "options"), document, registry)
        yield from _sweep_faults(strategy.sweep, (*place, "sweep"), document, registry)
        if strategy.solver is not None and strategy.solver not in OWN_SOLVERS:
            at = (*place, SOLVER.name)
            yield from choice_faults(SOLVER.name, strategy.solver, at, document, registry)


def _options_faults(
    options: Mapping[str, Any], place: KeyPath, document: Document, registry: Registry
) -> Iterator[Fault]:
    try:
        Settings.model_validate(dict(options))
    except ValidationError as error:
        yield from validation_faults(error, document, Settings, place)
    for slot in OPTIONS:
        if isinstance(choice := options.get(slot), str | dict):
            yield from choice_faults(slot, choice, (*place, slot), document, registry)


def _sweep_faults(
    sweep: Mapping[str, Sequence[Any]], place: KeyPath, document: Document, registry: Registry
) -> Iterator[Fault]:
    """Check swept values; those inside a mapping wait until the rest of it is known."""
    for name, values in sweep.items():
        first, dot, _ = name.partition(".")
        if first not in Settings.model_fields:
            known = list(Settings.model_fields)
            hint = near_match(first, known) or f"known: {', '.join(known)}"
            message = f"no option is called '{first}'"
            at = (*place, name)
            yield document.fault("unknown-key", message, at, hint=hint, at_key=True)
            continue
        for index, value in enumerate(values if not dot else ()):
            for fault in _value_faults(name, value, document, registry):
                path = (*place, name, index)
                yield document.fault(fault.code, fault.message, path, hint=fault.hint)


def _value_faults(name: str, value: Any, document: Document, registry: Registry) -> Iterator[Fault]:
    alone = Document(document.name, {name: value}, {}, {})
    yield from _options_faults({name: value}, (), alone, registry)


def ready_variants(
    tried: Sequence[Variant],
    scenes: Mapping[str, Scene],
    document: Document,
    registry: Registry,
) -> tuple[dict[str, list[Ready]], set[str], list[Fault]]:
    """Put every variant on every chain; what does not fit is a fault of its strategy.

    Returns:
        Variants with scene and solver, by the chain's name; the distributions of all plug-ins
        that are used, but limbik's own; and the faults.
    """
    ready: dict[str, list[Ready]] = {}
    distributions: set[str] = set()
    faults: dict[tuple[int, str], Fault] = {}
    for name, scene in scenes.items():
        ready[name] = []
        for variant in tried:
            try:
                ready[name].append(_ready(variant, scene, document, registry, distributions))
            except InputError as error:
                place: KeyPath = ("strategies", variant.number)
                for fault in error.faults:
                    inner = f"{fault.key}: " if fault.key else ""
                    message = f"'{variant.label}' on '{name}': {inner}{fault.message}"
                    made = document.fault(fault.code, message, place, hint=fault.hint)
                    faults.setdefault((variant.number, inner + fault.message), made)
    return ready, distributions, list(faults.values())


def _ready(
    variant: Variant,
    scene: Scene,
    document: Document,
    registry: Registry,
    distributions: set[str],
) -> Ready:
    """Put a variant on a chain, and note whose strategies it uses."""
    options = merged(scene.settings, variant)
    try:
        settings = Settings.model_validate(options)
    except ValidationError as error:
        alone = Document(document.name, options, {}, {})
        raise InputError(validation_faults(error, alone, Settings)) from None
    bare, whole = scene_for(scene, variant, settings)
    if whole is not None:
        used = [registry.bind(SOLVER.name, whole)]
        prepare(used[0], bare.chain, settings)
    elif variant.solver == "2d" and bare.pole is None:
        raise InputError(Fault("missing", "the 2D solver needs a scene with a pole"))
    else:
        used = list(scene_solver(bare, registry).strategies.values())
    plugins = (bound.plugin for bound in used)
    distributions |= {p.distribution for p in plugins if not p.built_in and p.distribution}
    return variant, bare, whole
