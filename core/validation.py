"""From the errors of a pydantic model to faults that point into the file.

A scene is checked by pydantic models, whose errors know a path but no line. Here each error finds
its place in the document and our own words. Errors that only follow from another one are left
out: the missing key behind a mistyped one, the other branches of a union.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from limbik.core.errors import Fault, InputError, clipped, shortlist
from limbik.core.wording import Wording, found_words, near_match, refusal
from limbik.core.yamlfile import Document, KeyPath

_MOST_LISTED = 12


@dataclass(frozen=True, slots=True)
class _Finding:
    """One error of the schema at its place in the document."""

    path: KeyPath
    wording: Wording
    found: object = None
    in_union: bool = False
    allowed: tuple[str, ...] = field(default=())

    @property
    def code(self) -> str:
        return self.wording.code


def model_error(
    error: ValidationError, model: type[BaseModel], values: Mapping[str, Any]
) -> InputError:
    """Put the refusal of values a program gave into words."""
    document = Document("", dict(values), {}, {})
    faults = validation_faults(error, document, model)
    return InputError(replace(fault, line=0, column=0) for fault in faults)


def validation_faults(
    error: ValidationError,
    document: Document,
    model: type[BaseModel],
    path: Sequence[str | int] = (),
) -> list[Fault]:
    """Turn the errors of a model into faults with file, line and column.

    Args:
        error: What pydantic raised.
        document: Where the checked content came from.
        model: The model it was checked against; its fields are the known keys.
        path: Place of the checked content inside the document.

    Returns:
        The faults sorted by line, at most 20.
    """
    base = tuple(path)
    content = _follow(document.content, base)
    findings = [_finding(details, content, model) for details in error.errors(include_url=False)]
    findings = _without_other_branches(_joined(findings))
    findings = _without_followers(findings)
    return shortlist(_fault(finding, document, base) for finding in findings)


def known_keys(model: object, path: Iterable[str | int] = ()) -> list[str]:
    """List the keys a model takes at a place inside it, in the order of its fields."""
    kinds = [model]
    for part in path:
        kinds = [inner for kind in kinds for inner in _inside(kind, part)]
    names: dict[str, None] = {}
    for kind in kinds:
        for found in _models(kind):
            names.update(dict.fromkeys(_fields(found)))
    return list(names)


def _finding(details: ErrorDetails, content: Any, model: object) -> _Finding:
    path, in_union = _locate(details["loc"], content, details["type"] == "missing")
    kind = details["type"]
    if kind == "extra_forbidden":
        return _Finding(path, _unknown_key(path, content, model))
    if kind == "missing":
        return _missing(path, content)
    found = _follow(content, path)
    wording = refusal(kind, details.get("ctx", {}), details["msg"], found)
    allowed = (wording.allowed,) if wording.allowed else ()
    return _Finding(path, wording, found, in_union, allowed)


def _locate(location: tuple[int | str, ...], content: Any, missing: bool) -> tuple[KeyPath, bool]:
    """Keep the parts of pydantic's location that are places; the rest names union branches."""
    path: KeyPath = ()
    for index, part in enumerate(location):
        if _holds(content, part):
            content = content[part]
        elif not (missing and index == len(location) - 1):
            continue
        path = (*path, part)
    return path, len(path) < len(location)


def _holds(content: Any, part: int | str) -> bool:
    if isinstance(content, list):
        return isinstance(part, int) and part < len(content)
    return isinstance(content, dict) and part in content


def _unknown_key(path: KeyPath, content: Any, model: object) -> Wording:
    key = str(path[-1])
    known = known_keys(model, path[:-1])
    given = _follow(content, path[:-1])
    hint = near_match(key, [name for name in known if name not in given]) or near_match(key, known)
    if not hint and known:
        listed = ", ".join(known[:_MOST_LISTED])
        hint = f"known: {listed}" + (", ..." if len(known) > _MOST_LISTED else "")
    return Wording("unknown-key", message=f"unknown key '{clipped(key)}'", hint=hint)


def _missing(path: KeyPath, content: Any) -> _Finding:
    last = path[-1]
    if isinstance(last, str):
        return _Finding(path, Wording("missing-key", message=f"key '{last}' is missing"))
    # A tuple that is too short: pydantic reports every absent item, the last one knows the length.
    found = _follow(content, path[:-1])
    allowed = f"a list of {last + 1}"
    return _Finding(path[:-1], Wording("length", allowed), found, allowed=(allowed,))


def _joined(findings: list[_Finding]) -> list[_Finding]:
    """Make one finding of those at one place that differ only in what they would allow."""
    joined: dict[tuple[KeyPath, str], _Finding] = {}
    for finding in findings:
        code = "type" if finding.in_union and finding.code == "choice" else finding.code
        spot = (finding.path, code)
        before = joined.get(spot)
        if before is None or not finding.allowed or code == "length":
            joined[spot] = finding
            continue
        allowed = tuple(dict.fromkeys((*before.allowed, *finding.allowed)))
        hint = before.wording.hint or finding.wording.hint
        joined[spot] = replace(
            before, allowed=allowed, wording=replace(before.wording, code=code, hint=hint)
        )
    return list(joined.values())


def _without_other_branches(findings: list[_Finding]) -> list[_Finding]:
    """Of a union keep the branch that came furthest, not those that refuse the kind of value."""

    def beaten(finding: _Finding) -> bool:
        depth = len(finding.path)
        return (
            finding.in_union
            and finding.code == "type"
            and any(
                other.path[:depth] == finding.path
                and (len(other.path) > depth or other.code != "type")
                for other in findings
            )
        )

    return [finding for finding in findings if not beaten(finding)]


def _without_followers(findings: list[_Finding]) -> list[_Finding]:
    """Leave out a missing key when a mistyped one in the same mapping stands for it."""
    meant = {
        (*finding.path[:-1], finding.wording.hint.removeprefix("did you mean '")[:-2])
        for finding in findings
        if finding.code == "unknown-key" and finding.wording.hint.startswith("did you mean")
    }
    return [f for f in findings if f.code != "missing-key" or f.path not in meant]


def _fault(finding: _Finding, document: Document, base: KeyPath) -> Fault:
    wording = finding.wording
    message = wording.message
    if finding.allowed:
        message = f"must be {' or '.join(finding.allowed)}, not {found_words(finding.found)}"
    at_key = finding.code == "unknown-key"
    path = (*base, *finding.path)
    return document.fault(finding.code, message, path, hint=wording.hint, at_key=at_key)


def _follow(content: Any, path: KeyPath) -> Any:
    for part in path:
        content = content[part]
    return content


def _models(kind: object) -> list[type[BaseModel]]:
    """Models among the alternatives of an annotation."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        return [kind]
    if get_origin(kind) is Annotated:
        return _models(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return [model for choice in get_args(kind) for model in _models(choice)]
    return []


def _inside(kind: object, part: str | int) -> list[object]:
    """Annotations of what lies under a key or an index of an annotation."""
    origin = get_origin(kind)
    arguments = [choice for choice in get_args(kind) if choice is not Ellipsis]
    if origin is Annotated:
        return _inside(arguments[0], part)
    if origin in (Union, UnionType):
        return [inner for choice in arguments for inner in _inside(choice, part)]
    if isinstance(part, int):
        return arguments
    return (
        arguments[1:]
        if origin is dict
        else [fields[part] for model in _models(kind) if part in (fields := _fields(model))]
    )


def _fields(model: type[BaseModel]) -> dict[str, object]:
    """Keys a model takes, with their annotations."""
    return {item.alias or name: item.annotation for name, item in model.model_fields.items()}
