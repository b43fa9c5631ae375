"""Plain words for what a schema refuses: what must be there and what was found.

pydantic's own sentences speak of inputs and instances of classes; a user of a scene file has
neither. Here each kind of error gets one of limbik's stable codes and a short sentence.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from limbik.core.errors import clipped
from limbik.core.yamlscalars import looks_like_number

_TYPES = {
    "bool": "true or false",
    "dataclass": "a mapping",
    "dict": "a mapping",
    "float": "a number",
    "frozen_set": "a list",
    "int": "a whole number",
    "list": "a list",
    "mapping": "a mapping",
    "model": "a mapping",
    "model_attributes": "a mapping",
    "set": "a list",
    "string": "text",
    "tuple": "a list",
}
_BOUNDS = {
    "greater_than": ("gt", "above"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "below"),
    "less_than_equal": ("le", "at most"),
    "multiple_of": ("multiple_of", "a multiple of"),
}
_TRUTH_WORDS = {"yes": "true", "on": "true", "no": "false", "off": "false"}


@dataclass(frozen=True, slots=True)
class Wording:
    """A refusal in words.

    Attributes:
        code: Stable code of the fault.
        allowed: What must be there, to follow "must be"; empty if `message` says it all.
        message: The whole sentence, when `allowed` is empty.
        hint: What to try, or empty.
    """

    code: str
    allowed: str = ""
    message: str = ""
    hint: str = ""


def found_words(value: object) -> str:
    """Say what a value is, briefly: `-3`, `text 'abc'`, `a list of 2`, `a mapping`, `null`."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case str():
            return f"text {clipped(value)!r}"
        case list() | tuple():
            return f"a list of {len(value)}"
        case Mapping():
            return "a mapping"
    return repr(value)[:60]


def refusal(kind: str, context: Mapping[str, Any], message: str, found: object) -> Wording:
    """Put one error of a schema into words.

    Args:
        kind: pydantic's type of the error, such as `float_type`.
        context: pydantic's context of the error.
        message: pydantic's message; used for kinds that have no words of ours.
        found: The value that was refused.
    """
    if kind in _BOUNDS:
        name, words = _BOUNDS[kind]
        return Wording("range", f"{words} {context[name]}")
    if kind == "int_from_float":
        return Wording("type", _TYPES["int"])
    if kind.removesuffix("_type") in _TYPES and kind.endswith("_type"):
        allowed = _TYPES[kind.removesuffix("_type")]
        return Wording("type", allowed, hint=_type_hint(allowed, found))
    if kind in ("literal_error", "enum"):
        return _choice(str(context["expected"]), found)
    if kind in ("too_short", "too_long"):
        return _length(kind, context)
    if kind == "finite_number":
        return Wording("not-finite", "a finite number")
    if kind in ("value_error", "assertion_error"):
        return Wording("value", message=str(context.get("error", message)))
    return _other(kind, context, message)


def near_match(word: str, known: list[str]) -> str:
    """Give the hint `did you mean '...'?`, or nothing when no known word is near."""
    by_lower = {name.lower(): name for name in known}
    lower = word.lower()
    near = get_close_matches(lower, list(by_lower), 1)
    if not near and len(lower) > 2:
        near = [name for name in by_lower if name.startswith(lower)]
    return f"did you mean '{by_lower[near[0]]}'?" if near else ""


def _choice(expected: str, found: object) -> Wording:
    names = expected.replace(" or ", ", ").split(", ")
    hint = ""
    if isinstance(found, str):
        if found in names:
            hint = "write it without quotes"
        else:
            hint = near_match(found, [n[1:-1] for n in names if n.startswith("'")])
    return Wording("choice", expected, hint=hint)


def _length(kind: str, context: Mapping[str, Any]) -> Wording:
    count = context["min_length"] if kind == "too_short" else context["max_length"]
    bound = "at least" if kind == "too_short" else "at most"
    return Wording("length", f"a list of {bound} {count}")


def _other(kind: str, context: Mapping[str, Any], message: str) -> Wording:
    match kind:
        case "string_too_short":
            least = context["min_length"]
            if least == 1:
                return Wording("length", message="must not be empty")
            return Wording("length", f"at least {least} characters")
        case "string_too_long":
            return Wording("length", f"at most {context['max_length']} characters")
        case "string_pattern_mismatch":
            return Wording("pattern", f"text of the form {context['pattern']}")
        case "none_required":
            return Wording("type", "null")
        case "union_tag_not_found":
            return Wording("missing-key", message=f"key {context['discriminator']} is missing")
        case "union_tag_invalid":
            expected, tag = context["expected_tags"], context["tag"]
            sentence = f"{context['discriminator']} must be one of {expected}, not '{tag}'"
            return Wording("choice", message=sentence)
    return Wording(kind.replace("_", "-"), message=message)


def _type_hint(allowed: str, found: object) -> str:
    if not isinstance(found, str):
        return "write it in quotes" if allowed == "text" and isinstance(found, int | float) else ""
    if allowed == "true or false":
        lower = found.lower()
        word = _TRUTH_WORDS.get(lower, lower)
        return f"write {word}" if word in ("true", "false") else ""
    if allowed in ("a number", "a whole number"):
        plain = found.replace("_", "")
        if looks_like_number(plain):
            return f"write {plain}, without quotes" if plain == found else f"write {plain}"
    return ""
