"""The JSON Schema of scenes, for editors: models, strategies and inputs there are (L-03)."""

from collections.abc import Mapping
from enum import IntEnum
from typing import Any

from pydantic.json_schema import models_json_schema

from limbik.core.bodymodel import BodyModel
from limbik.core.params import member_name
from limbik.core.registry import Registry
from limbik.core.scenemodel import SceneModel
from limbik.core.settings import Model
from limbik.core.slots import LIMIT, OPTIONS, SOLVER
from limbik.core.strategy import Parameter, Strategy, layout
from limbik.core.whole import OWN_SOLVERS

_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_WORDS = {"ge": "minimum", "le": "maximum", "gt": "exclusiveMinimum", "lt": "exclusiveMaximum"}
_TYPES: dict[type, str] = {bool: "boolean", int: "integer", float: "number"}


def scene_schema(registry: Registry) -> dict[str, Any]:
    """Return the JSON Schema of a scene file.

    Args:
        registry: Its strategies and scene inputs become choices.
    """
    _, models = models_json_schema([(m, "validation") for m in (SceneModel, BodyModel)])
    definitions: dict[str, Any] = models["$defs"]
    options = definitions["Settings"]["properties"]
    for slot in OPTIONS:
        found = registry.strategies(slot)
        options[slot] |= _choice(slot, [found[name].strategy for name in found])
    limits = [found.strategy for found in registry.strategies(LIMIT.name).values()]
    joint = definitions["JointModel"]["properties"][LIMIT.name]
    joint["anyOf"] = _choice(LIMIT.name, limits)["anyOf"]
    solvers = registry.strategies(SOLVER.name).values()
    choice = _choice(SOLVER.name, [found.strategy for found in solvers])
    choice["anyOf"][:0] = [{"const": name} for name in OWN_SOLVERS]
    for model in ("SceneModel", "PartModel"):
        definitions[model]["properties"][SOLVER.name] |= choice
    inputs = list(registry.scene_inputs().values())
    clips = [given.name for given in inputs if given.has_goals]
    chains = {given.name: given.model for given in inputs}
    _take_in("SceneModel", "chain", chains, definitions)
    _goals_may_be_absent("SceneModel", definitions)
    held = [{"properties": {"chain": {"required": [name]}}} for name in clips]
    goals = [{"required": ["goals"]}, {"required": ["trajectory"]}]
    definitions["SceneModel"]["anyOf"] = [*goals, *held]
    skeletons = {given.name: given.skeleton.model for given in inputs if given.skeleton}
    _take_in("BodyModel", "skeleton", skeletons, definitions)
    _goals_may_be_absent("PartModel", definitions)
    each = {"items": {"required": ["goals"]}}
    held = [{"properties": {"skeleton": {"required": [name]}}} for name in clips]
    definitions["BodyModel"]["anyOf"] = [{"properties": {"chains": each}}, *held]
    return {
        "$schema": _DIALECT,
        "title": "limbik scene",
        "if": {"anyOf": [{"required": ["skeleton"]}, {"required": ["chains"]}]},
        "then": {"$ref": "#/$defs/BodyModel"},
        "else": {"$ref": "#/$defs/SceneModel"},
        "$defs": definitions,
    }


def _take_in(
    model: str, key: str, inputs: Mapping[str, type[Model]], definitions: dict[str, Any]
) -> None:
    """Let a key of a model hold what the scene inputs take there, too."""
    forms = [definitions[model]["properties"][key]]
    for name, given in inputs.items():
        own: dict[str, Any] = given.model_json_schema()
        definitions |= own.pop("$defs", {})
        definitions[f"{key}_{name}"] = own
        forms.append({"$ref": f"#/$defs/{key}_{name}"})
    definitions[model]["properties"][key] = {"anyOf": forms}


def _goals_may_be_absent(model: str, definitions: dict[str, Any]) -> None:
    required = definitions[model]["required"]
    definitions[model]["required"] = [key for key in required if key != "goals"]


def _choice(slot: str, strategies: list[Strategy]) -> dict[str, Any]:
    """Schema of a strategy's choice: its name, or a mapping with `use` and parameters."""
    names = [strategy.name for strategy in strategies]
    forms = [{"enum": names}, *map(_mapping, strategies)]
    return {"anyOf": forms, "description": f"strategy for {slot}"}


def _mapping(strategy: Strategy) -> dict[str, Any]:
    fields = layout(strategy.params)
    properties = {field.name: _parameter(field) for field in fields}
    return {
        "type": "object",
        "description": strategy.description,
        "properties": {"use": {"const": strategy.name}, **properties},
        "required": ["use", *(field.name for field in fields if field.default is ...)],
        "additionalProperties": False,
    }


def _parameter(field: Parameter) -> dict[str, Any]:
    schema: dict[str, Any] = {"type": _TYPES.get(field.kind, "number")}
    if issubclass(field.kind, IntEnum):
        schema = {"enum": [member_name(member) for member in field.kind]}
    for constraint in field.constraints:
        if text := getattr(constraint, "description", None):
            schema["description"] = text
        for part in getattr(constraint, "metadata", [constraint]):
            bounds = {word: getattr(part, sign, None) for sign, word in _WORDS.items()}
            schema |= {word: bound for word, bound in bounds.items() if bound is not None}
    if not field.size:
        return schema
    return {"type": "array", "items": schema, "minItems": field.size, "maxItems": field.size}
