"""What can be set in a parameter model, read from the model itself: no list of options here.

Settings and the parameters of strategies are pydantic models; their JSON Schema says type, range
and meaning of each field. A new option, or a strategy of a plug-in, so appears by itself.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from pydantic import BaseModel

Kind = Literal["bool", "int", "float", "choice", "vector", "switch"]
_KINDS: dict[str, Kind] = {"boolean": "bool", "integer": "int", "number": "float"}


@dataclass(frozen=True)
class Control:
    """One thing to set.

    Attributes:
        path: Keys from the model down to the field.
        kind: What it holds; a `switch` turns an optional group on, whose controls follow it.
        low, high: Its range, None where it has no end.
        choices: Of a choice.
        size: Of a vector.
        text: What it means.
        initial: What a switch sets its group to.
        by_joint: Whether there is one for each joint, its name being the path's next key.
        absent: What a joint without one has; None for its rest pose.
    """

    path: tuple[str, ...]
    kind: Kind
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    size: int = 0
    text: str = ""
    initial: Any = None
    by_joint: bool = False
    absent: float | None = None

    def of_joint(self, joint: str) -> "Control":
        """Return the control of one joint."""
        return replace(self, path=(*self.path, joint), by_joint=False)

    @property
    def name(self) -> str:
        """The field's name for people."""
        return " ".join(self.path).replace("_", " ")


def controls(model: type[BaseModel]) -> list[Control]:
    """List what can be set in a model, in its order; fields of other kinds are left out."""
    schema = model.model_json_schema()
    return list(_fields(schema, schema.get("$defs", {}), ()))


def value_at(values: Mapping[str, Any], path: tuple[str, ...]) -> Any:
    """Return the value at a path; None where a group on the way is off."""
    found: Any = values
    for key in path:
        if found is None:
            return None
        found = found[key]
    return found


def _fields(
    schema: Mapping[str, Any], definitions: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[Control]:
    for name, field in schema.get("properties", {}).items():
        yield from _field(field, definitions, (*path, name))


def _field(
    field: Mapping[str, Any], definitions: Mapping[str, Any], path: tuple[str, ...]
) -> Iterator[Control]:
    text = field.get("description", "")
    forms = field.get("anyOf", [])
    if "$ref" in field:
        yield from _fields(_named(field, definitions), definitions, path)
    elif [form for form in forms if form.get("type") == "null"]:
        inner = next(form for form in forms if form.get("type") != "null")
        group = _named(inner, definitions) if "$ref" in inner else inner
        text = text or str(group.get("description", "")).split(" (")[0]
        if "$ref" in inner or _is_by_joint(inner):
            yield Control(path, "switch", text=text, initial=_start(group))
        if "$ref" in inner:
            yield from _fields(group, definitions, path)
        elif _is_by_joint(inner):
            yield from _field(inner, definitions, path)
    elif _is_by_joint(field):
        item = field["additionalProperties"]
        for control in _field(item, definitions, path):
            yield replace(control, text=text, by_joint=True, absent=item.get("default"))
    elif "enum" in field:
        yield Control(path, "choice", choices=tuple(field["enum"]), text=text)
    elif field.get("type") in _KINDS:
        yield Control(path, _KINDS[field["type"]], *_range(field), text=text)
    elif field.get("type") == "array" and "minItems" in field:
        item = field["prefixItems"][0] if "prefixItems" in field else field["items"]
        yield Control(path, "vector", *_range(item), size=field["minItems"], text=text)


def _is_by_joint(field: Mapping[str, Any]) -> bool:
    """Look whether a field is a table with the same kind of value for each joint."""
    return isinstance(field.get("additionalProperties"), Mapping)


def _named(field: Mapping[str, Any], definitions: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = definitions[field["$ref"].rsplit("/", 1)[1]]
    return found


def _range(field: Mapping[str, Any]) -> tuple[float | None, float | None]:
    low = field.get("minimum", field.get("exclusiveMinimum"))
    return low, field.get("maximum", field.get("exclusiveMaximum"))


def _start(group: Mapping[str, Any]) -> dict[str, Any]:
    """Return values for the fields a group asks for: a first choice, the middle of a range."""
    values: dict[str, Any] = {}
    for name in group.get("required", []):
        field = group["properties"][name]
        low, high = _range(field)
        values[name] = field["enum"][0] if "enum" in field else ((low or 0.0) + (high or 0.0)) / 2.0
    return values
