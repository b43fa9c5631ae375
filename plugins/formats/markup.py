"""Read XML strictly, with the place of every element, on the standard library.

Robot files come from strangers: declarations of entities are refused before they can expand, and
size, depth and number of elements are bounded.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from limbik.core.errors import Fault, InputError

MOST_BYTES = 10_000_000
MOST_ELEMENTS = 200_000
MOST_DEPTH = 100


@dataclass(eq=False, slots=True)
class Element:
    """An element of a file.

    Attributes:
        tag: Its name, as written.
        attributes: Their texts by name.
        file: Name of the file.
        line: Line of its start, from 1.
        column: Column of its start in characters, from 1.
        source: Text of its start tag, to find attributes in.
        children: The elements inside.
    """

    tag: str
    attributes: dict[str, str]
    file: str
    line: int
    column: int
    source: str
    children: list["Element"] = field(default_factory=list)

    def find(self, tag: str) -> "Element | None":
        """Return the first child of a name."""
        return next((child for child in self.children if child.tag == tag), None)

    def walk(self) -> Iterator["Element"]:
        """Give the element and all inside it, in the order of the file."""
        waiting = [self]
        while waiting:
            here = waiting.pop()
            yield here
            waiting.extend(reversed(here.children))

    def fault(self, code: str, message: str, attribute: str = "", *, hint: str = "") -> Fault:
        """Make a fault that points at the element, or at the value of one of its attributes."""
        line, column = self.line, self.column
        found = re.search(rf"\s{re.escape(attribute)}\s*=\s*[\"']", self.source)
        if attribute and found:
            before = self.source[: found.end()]
            line += before.count("\n")
            last = before.rpartition("\n")[2]
            column = len(last) + (1 if "\n" in before else column)
        return Fault(code, message, "", self.file, line, column, hint)


def read_bounded(path: Path, most: int) -> bytes:
    """Read a file of at most so many bytes.

    Raises:
        InputError: The file cannot be read, or is larger.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(most + 1)
    except (OSError, ValueError) as error:
        reason = (error.strerror if isinstance(error, OSError) else "") or str(error)
        message = f"cannot read the file: {reason}"
        raise InputError(Fault("unreadable", message, file=str(path))) from error
    if len(content) > most:
        message = f"the file is larger than {most // 1_000_000} MB"
        raise InputError(Fault("too-large", message, file=str(path), line=1, column=1))
    return content


def read_xml(content: bytes, name: str) -> Element:
    """Read an XML file.

    Args:
        content: The bytes of the file.
        name: Name of the file for messages.

    Returns:
        The outermost element.

    Raises:
        InputError: The file is no XML, declares a document type or is too large.
    """
    return _Builder(content, name).build()


class _Builder:
    def __init__(self, content: bytes, name: str) -> None:
        self._content, self._name = content, name
        self._parser = expat.ParserCreate()
        self._open: list[Element] = []
        self._root: Element | None = None
        self._count = 0
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._doctype

    def build(self) -> Element:
        try:
            self._parser.Parse(self._content, True)
        except expat.ExpatError as error:
            words = expat.ErrorString(error.code)
            raise self._refusal("xml", f"not XML: {words}", error.lineno, error.offset) from None
        if self._root is None:  # expat refuses a file without an element
            raise self._refusal("xml", "not XML: no element found", 1, 0)
        return self._root

    def _refusal(self, code: str, message: str, line: int, offset: int) -> InputError:
        return InputError(Fault(code, message, file=self._name, line=line, column=offset + 1))

    def _stop(self, code: str, message: str) -> InputError:
        parser = self._parser
        return self._refusal(code, message, parser.CurrentLineNumber, parser.CurrentColumnNumber)

    def _doctype(self, *_: object) -> None:
        raise self._stop("doctype", "a document type or entities are not allowed")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if self._count > MOST_ELEMENTS:
            raise self._stop("too-many", f"more than {MOST_ELEMENTS} elements")
        if len(self._open) >= MOST_DEPTH:
            raise self._stop("too-deep", f"nested deeper than {MOST_DEPTH}")
        parser = self._parser
        start = parser.CurrentByteIndex
        end = self._content.find(b">", start)
        source = self._content[start : end + 1].decode("utf-8", "replace")
        line, column = parser.CurrentLineNumber, parser.CurrentColumnNumber + 1
        element = Element(tag, attributes, self._name, line, column, source)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, tag: str) -> None:
        self._open.pop()
