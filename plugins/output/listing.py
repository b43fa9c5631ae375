"""What plug-ins are there and which parameters their strategies take, as one record."""

from enum import IntEnum
from typing import Any

from pydantic.fields import FieldInfo

from limbik import __version__
from limbik.core.formats import Output, SceneInput
from limbik.core.params import member_name
from limbik.core.registry import Registry
from limbik.core.roster import Plugin, Registered
from limbik.core.slots import HOOKED
from limbik.core.strategy import Parameter, layout

_SIGNS = {"gt": ">", "ge": ">=", "lt": "<", "le": "<="}


def plugin_record(registry: Registry) -> dict[str, Any]:
    """Describe all plug-ins, what failed in them, and every slot's strategies."""
    failures: dict[str, list[str]] = {}
    for broken in registry.broken:
        failures.setdefault(str(broken.plugin), []).append(str(broken))
    return {
        "status": "ok",
        "plugins": [
            _plugin(plugin, failures.get(str(plugin), [])) for plugin in registry.plugins()
        ],
        "slots": {
            slot: [_strategy(name, found) for name, found in registry.strategies(slot).items()]
            for slot in HOOKED
        },
        "formats": {
            "scene_input": [_format(found) for found in registry.scene_inputs().values()],
            "output": [_format(found) for found in registry.outputs().values()],
        },
    }


def _format(found: SceneInput | Output) -> dict[str, Any]:
    return {
        "name": found.name,
        "suffixes": list(found.suffixes),
        "description": found.description,
    }


def _plugin(plugin: Plugin, failures: list[str]) -> dict[str, Any]:
    return {
        "name": plugin.name,
        "distribution": plugin.distribution,
        "version": __version__ if plugin.built_in else plugin.version,
        "origin": plugin.origin,
        "hooks": list(plugin.hooks),
        "status": "broken" if failures else plugin.status,
        "failures": failures,
    }


def _strategy(name: str, found: Registered) -> dict[str, Any]:
    strategy = found.strategy
    return {
        "name": name,
        "plugin": found.plugin.name,
        "description": strategy.description,
        "parameters": [_parameter(field) for field in layout(strategy.params)],
    }


def _parameter(field: Parameter) -> dict[str, Any]:
    choices = None
    if issubclass(field.kind, IntEnum):
        choices = [member_name(member) for member in field.kind]
    kind = "choice" if choices else field.kind.__name__
    bounds, description = _bounds(field)
    return {
        "name": field.name,
        "type": f"{field.size} x {kind}" if field.size else kind,
        "choices": choices,
        "default": None if field.default is ... else _plain(field.default),
        "required": field.default is ...,
        **bounds,
        "unit": "degrees" if field.degrees else None,
        "description": description,
    }


def _bounds(field: Parameter) -> tuple[dict[str, float | None], str]:
    """Read range and description out of the annotation."""
    bounds: dict[str, float | None] = dict.fromkeys(_SIGNS)
    description = ""
    for constraint in field.constraints:
        parts = constraint.metadata if isinstance(constraint, FieldInfo) else [constraint]
        if isinstance(constraint, FieldInfo):
            description = constraint.description or description
        for part in parts:
            bounds |= {sign: getattr(part, sign) for sign in _SIGNS if hasattr(part, sign)}
    return bounds, description


def _plain(value: Any) -> Any:
    if isinstance(value, IntEnum):
        return member_name(value)
    return list(value) if isinstance(value, tuple) else value


def range_text(parameter: dict[str, Any]) -> str:
    """Write a parameter's range for people, such as `0 to 360` or `> 0`; empty if unbounded."""
    low, high = parameter["ge"], parameter["le"]
    if low is not None and high is not None:
        return f"{low:g} to {high:g}"
    if parameter["choices"]:
        return " | ".join(parameter["choices"])
    found = [(mark, parameter[sign]) for sign, mark in _SIGNS.items()]
    return ", ".join(f"{mark} {bound:g}" for mark, bound in found if bound is not None)
