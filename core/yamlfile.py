"""Read a YAML file strictly, and know where everything in it stands.

Scenes come from strangers. So anchors, aliases, merge keys and tags are refused while the parser
reads, before anything is built from them (a few hundred bytes of aliases can stand for gigabytes);
size, depth and number of nodes are bounded; a key given twice is a fault instead of a silent
overwrite; numbers mean what YAML 1.2 says (`core/yamlscalars.py`). Every value keeps its line and
column, so that a later check can point at it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from limbik.core.errors import Fault, SceneError, clipped, key_text, shortlist
from limbik.core.yamlscalars import ScalarFault, plain_scalar
from limbik.core.yamlsyntax import is_nesting, syntax_fault
from limbik.core.yamltext import MOST_BYTES, odd_character, read_text

MOST_NODES = 100_000
MOST_DEPTH = 20

KeyPath = tuple[str | int, ...]
Position = tuple[int, int]

# The C parser is five times faster; not every build of PyYAML has it.
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True, slots=True)
class Document:
    """What a YAML file holds, and where.

    Attributes:
        name: Name of the file for messages.
        content: Dictionaries with text keys, lists, text, numbers, truth values, None.
        values: Line and column of every value, by its path.
        keys: Line and column of every key of a mapping, by the path of its value.
        at: Where the content stands in the file; paths given to the methods start there.
    """

    name: str
    content: Any
    values: dict[KeyPath, Position]
    keys: dict[KeyPath, Position]
    at: KeyPath = ()

    @property
    def title(self) -> str:
        """Name of the file without folder and ending."""
        return Path(self.name).stem.strip("<>")

    def under(self, path: Sequence[str | int]) -> "Document":
        """Return the part of the document at a path, as a document with places of its own."""
        content = self.content
        for part in path:
            content = content[part]
        return replace(self, content=content, at=(*self.at, *path))

    def position(self, path: Sequence[str | int]) -> Position:
        """Line and column of a value, from 1; of the nearest parent if the path leads nowhere."""
        place = (*self.at, *path)
        while place not in self.values and place:
            place = place[:-1]
        return self.values.get(place, (1, 1))

    def key_position(self, path: Sequence[str | int]) -> Position:
        """Line and column of the key of a value; of the value itself if it has no key."""
        return self.keys.get((*self.at, *path)) or self.position(path)

    def fault(
        self,
        code: str,
        message: str,
        path: Sequence[str | int] = (),
        *,
        hint: str = "",
        at_key: bool = False,
    ) -> Fault:
        """Make a fault that points at a value of this document, or at its key."""
        line, column = self.key_position(path) if at_key else self.position(path)
        key = key_text((*self.at, *path))
        return Fault(code, message, key, self.name, line, column, hint)

    def placed(self, fault: Fault, path: Sequence[str | int]) -> Fault:
        """Point a fault that has no place of its own at a value of this document."""
        if fault.line:
            return fault
        message = f"{fault.file}: {fault.message}" if fault.file else fault.message
        return self.fault(fault.code, message, path, hint=fault.hint)


def read_yaml(source: str | bytes, name: str) -> Document:
    """Read the one document of a YAML text.

    Args:
        source: The text, or the bytes of a UTF-8 file; at most 1 MB.
        name: Name of the file for messages.

    Returns:
        The content and the positions. The content may be of any kind; what it should be is for
        the caller to check.

    Raises:
        SceneError: With every fault that could be found.
    """
    text = read_text(source, name)
    reader = _Reader(text, name)
    content = reader.read()
    if reader.looked_too_deep:
        # The C parser looks ahead past the place where ours would stop, and fails there.
        reader = _Reader(text, name, yaml.SafeLoader)
        content = reader.read()
    if reader.faults:
        raise SceneError(shortlist(reader.faults))
    return Document(name, content, reader.values, reader.keys)


def read_yaml_file(path: str | Path) -> Document:
    """Read a YAML file; as `read_yaml`, and never more of the file than the limit.

    Raises:
        SceneError: The file cannot be opened, or its content is at fault.
    """
    try:
        with Path(path).open("rb") as stream:
            source = stream.read(MOST_BYTES + 1)
            size = max(stream.seek(0, 2), len(source)) if stream.seekable() else len(source)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        message = f"cannot read the file: {reason}"
        raise SceneError(Fault("unreadable", message, file=str(path))) from error
    if size > MOST_BYTES:
        message = f"the file has {size} bytes, the limit is {MOST_BYTES}"
        raise SceneError(Fault("too-large", message, file=str(path), line=1, column=1))
    return read_yaml(source, str(path))


class _Stop(Exception):
    """Nothing sensible can be read past this point."""


class _Reader:
    """Builds plain values out of the parser's events, and collects faults on the way."""

    def __init__(self, text: str, name: str, loader: Any = None) -> None:
        # Without a line break at the end the two parsers of PyYAML differ in where they stop.
        text = text if text.endswith("\n") else text + "\n"
        self._events: Iterator[Any] = yaml.parse(text, Loader=loader or _LOADER)
        self._name = name
        self._nodes = 0
        self.looked_too_deep = False
        self.faults: list[Fault] = []
        self.values: dict[KeyPath, Position] = {}
        self.keys: dict[KeyPath, Position] = {}

    def read(self) -> Any:
        """Read the document; None when it stopped at a fault."""
        try:
            next(self._events)
            if isinstance(next(self._events), yaml.StreamEndEvent):
                self._fault("empty", "the file is empty", (1, 1))
                return None
            content = self._node((), next(self._events))
            next(self._events)
            event = next(self._events)
            if not isinstance(event, yaml.StreamEndEvent):
                message = "a second document starts here; a file holds one"
                self._fault("multi-doc", message, _start(event))
            return content
        except yaml.YAMLError as error:
            self.looked_too_deep = is_nesting(error)
            self.faults.append(syntax_fault(error, self._name))
        except _Stop:
            pass
        return None

    def _fault(self, code: str, message: str, place: Position, path: KeyPath = ()) -> None:
        self.faults.append(Fault(code, message, key_text(path), self._name, *place))

    def _node(self, path: KeyPath, event: Any) -> Any:
        place = self.values[path] = _start(event)
        self._count(place)
        self._refuse_indirection(event, path, place)
        if isinstance(event, yaml.ScalarEvent):
            return self._scalar(event, path, place)
        if isinstance(event, yaml.AliasEvent):
            return None
        if len(path) >= MOST_DEPTH:
            self._fault("too-deep", f"nested deeper than {MOST_DEPTH}", place)
            raise _Stop
        if isinstance(event, yaml.SequenceStartEvent):
            return self._list(path)
        return self._mapping(path)

    def _count(self, place: Position) -> None:
        self._nodes += 1
        if self._nodes > MOST_NODES:
            self._fault("too-many", f"more than {MOST_NODES} values and keys", place)
            raise _Stop

    def _refuse_indirection(self, event: Any, path: KeyPath, place: Position) -> None:
        if event.anchor is not None:
            sign = "*" if isinstance(event, yaml.AliasEvent) else "&"
            message = f"anchors and aliases are not allowed: {sign}{event.anchor[:40]}"
            self._fault("alias", message, place, path)
        tag = getattr(event, "tag", None)
        if tag is not None:
            self._fault("tag", f"tags are not allowed: {tag[:80]}", place, path)

    def _scalar(self, event: Any, path: KeyPath, place: Position) -> Any:
        if not event.implicit[0] and event.tag is None:
            odd = odd_character(event.value)
            if odd:
                self._fault("encoding", f"the character {odd} is not allowed in text", place, path)
            return event.value
        try:
            return plain_scalar(event.value)
        except ScalarFault as fault:
            self._fault(fault.code, fault.message, place, path)
            return None

    def _list(self, path: KeyPath) -> list[Any]:
        items: list[Any] = []
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            items.append(self._node((*path, len(items)), event))
        return items

    def _mapping(self, path: KeyPath) -> dict[str, Any]:
        mapping: dict[str, Any] = {}
        for event in self._events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            key = self._key(path, event)
            inner = (*path, key)
            if key in mapping:
                first = "line {}, column {}".format(*self.keys[inner])
                message = f"key '{clipped(key)}' is given twice, first at {first}"
                self._fault("duplicate", message, _start(event), inner)
            self.keys.setdefault(inner, _start(event))
            mapping[key] = self._node(inner, next(self._events))
        return mapping

    def _key(self, path: KeyPath, event: Any) -> str:
        """Give the text of a key; one that is no text is a fault, and the reading goes on."""
        place = _start(event)
        self._count(place)
        self._refuse_indirection(event, path, place)
        if not isinstance(event, yaml.ScalarEvent):
            self._fault("key", "a key must be text, not a list, mapping or alias", place, path)
            raise _Stop
        text = str(event.value)
        quoted = not event.implicit[0]
        if not quoted and text == "<<":
            self._fault("alias", "merge keys are not allowed", place, path)
        elif not text or not (quoted or isinstance(self._scalar(event, path, place), str)):
            shown = f"write it in quotes: '{clipped(text)}'" if text else "it is empty"
            self._fault("key", f"a key must be text; {shown}", place, path)
        elif odd := odd_character(text):
            self._fault("encoding", f"the character {odd} is not allowed in a key", place, path)
        return text


def _start(event: Any) -> Position:
    return event.start_mark.line + 1, event.start_mark.column + 1
