"""The JSON Schema of scenes, for editors: models, strategies and inputs there are (L-03)."""

from enum import IntEnum
from typing import Any

from limbik.core.formats import SceneInput
from limbik.core.params import member_name
from limbik.core.registry import Registry
from limbik.core.scenemodel import SceneModel
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
    schema: dict[str, Any] = SceneModel.model_json_schema()
    schema = {"$schema": _DIALECT, **schema, "title": "limbik scene"}
    definitions = schema["$defs"]
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
    schema["properties"][SOLVER.name] |= choice
    inputs = list(registry.scene_inputs().values())
    chains = [schema["properties"]["chain"]]
    for found_input in inputs:
        chains.append({"$ref": f"#/$defs/{_take_in(found_input, definitions)}"})
    schema["properties"]["chain"] = {"anyOf": chains}
    _need_goals_or_a_clip(schema, [given.name for given in inputs if given.has_goals])
    return schema


def _take_in(given: SceneInput, definitions: dict[str, Any]) -> str:
    """Add an input's model to the definitions and return its name there."""
    own: dict[str, Any] = given.model.model_json_schema()
    definitions |= own.pop("$defs", {})
    name = f"Chain_{given.name}"
    definitions[name] = {**own, "description": given.description}
    return name


def _need_goals_or_a_clip(schema: dict[str, Any], clips: list[str]) -> None:
    """Ask for goals except where the chain's file has them."""
    schema["required"] = [key for key in schema["required"] if key != "goals"]
    held = [{"properties": {"chain": {"required": [name]}}} for name in clips]
    schema["anyOf"] = [{"required": ["goals"]}, *held]


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
