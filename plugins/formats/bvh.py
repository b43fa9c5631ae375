"""Read a BVH motion clip: strictly, bounded in bytes and tokens, with the place of every fault.

What is read stays as the file has it: right-handed with Y up (as good as always), its own unit of
length, degrees.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array
from limbik.core.scenemodel import FARTHEST
from limbik.core.yamlscalars import looks_like_number
from limbik.plugins.formats.markup import read_bounded

MOST_BYTES: Final = 64_000_000
MOST_JOINTS: Final = 2_000
MOST_DEPTH: Final = 256
_CHANNEL = re.compile(r"([xyz])(position|rotation)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class BvhJoint:
    """A joint of a clip.

    Attributes:
        name: Its name.
        parent: Index of the joint it hangs from; -1 for a root.
        offset: In the parent's frame [length].
        moves: Axes of its position channels, in order.
        turns: Axes of its rotation channels, in order.
        columns: Column of each channel in a frame: those of `moves`, then those of `turns`.
        channels: The channels' names as written.
        site: Offset of its end site [length]; None if it has children instead.
        line: Line of its name.
    """

    name: str
    parent: int
    offset: tuple[float, float, float]
    moves: tuple[int, ...]
    turns: tuple[int, ...]
    columns: tuple[int, ...]
    channels: tuple[str, ...]
    site: tuple[float, float, float] | None
    line: int


@dataclass(frozen=True, eq=False)
class Clip:
    """A motion clip.

    Attributes:
        file: Name of the file.
        joints: n joints, parents before children.
        frames: Channel values, (m, k) [length or deg].
        frame_time: Seconds a frame.
    """

    file: str
    joints: tuple[BvhJoint, ...]
    frames: Array
    frame_time: float

    @property
    def names(self) -> list[str]:
        """Names of the joints."""
        return [joint.name for joint in self.joints]


def read_bvh(path: Path) -> Clip:
    """Read a clip.

    Raises:
        InputError: The file is at fault; with line and column.
    """
    content = read_bounded(path, MOST_BYTES)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        message = f"the byte 0x{content[error.start]:02x} is not UTF-8"
        raise InputError(Fault("encoding", message, file=str(path), line=line)) from None
    return _Reader(text, str(path)).clip()


@dataclass(slots=True)
class _Draft:
    """A joint while its block is being read."""

    name: str
    parent: int
    line: int
    offset: tuple[float, float, float] | None = None
    channels: tuple[str, ...] | None = None
    site: tuple[float, float, float] | None = None
    first_column: int = 0
    children: int = 0


class _Reader:
    """Reads line by line, word by word."""

    def __init__(self, text: str, name: str) -> None:
        self._lines = text.splitlines()
        self._name = name
        self._line = 0
        self._words: Iterator[re.Match[str]] = iter(())
        self._place = (1, 1)
        self._drafts: list[_Draft] = []
        self._seen: dict[str, int] = {}
        self._columns = 0

    def clip(self) -> Clip:
        self._expect("HIERARCHY")
        while (word := self._word("ROOT or MOTION")).upper() == "ROOT":
            self._joint(-1, 1)
        if not self._drafts:
            raise self._fault("bvh", f"expected ROOT, found '{word[:40]}'")
        if word.upper() != "MOTION":
            raise self._fault("bvh", f"expected ROOT or MOTION, found '{word[:40]}'")
        count, seconds = self._counts()
        return Clip(self._name, self._joints(), self._frames(count), seconds)

    def _fault(self, code: str, message: str, place: tuple[int, int] | None = None) -> InputError:
        line, column = place or self._place
        return InputError(Fault(code, message, file=self._name, line=line, column=column))

    def _word(self, expected: str) -> str:
        """Give the next word; `expected` says what should stand there."""
        while (found := next(self._words, None)) is None:
            if self._line >= len(self._lines):
                last = self._lines[-1] if self._lines else ""
                self._place = (max(len(self._lines), 1), len(last) + 1)
                raise self._fault("cut", f"the file ends where {expected} should stand")
            self._words = re.finditer(r"[{}]|[^\s{}]+", self._lines[self._line])
            self._line += 1
        self._place = (self._line, found.start() + 1)
        return found.group()

    def _expect(self, word: str) -> None:
        found = self._word(word)
        if found.upper() != word:
            raise self._fault("bvh", f"expected {word}, found '{found[:40]}'")

    def _title(self) -> str:
        """Give the name that follows ROOT or JOINT: the rest of the line, up to a brace."""
        words = [self._word("a name")]
        start = self._place
        if words[0] in "{}":
            raise self._fault("name", "the joint has no name")
        while (word := self._word("{")) != "{":
            if self._place[0] != start[0]:
                raise self._fault("bvh", f"expected {{, found '{word[:40]}'")
            words.append(word)
        name = " ".join(words)
        if name in self._seen:
            message = f"the joint '{name}' is given twice, first at line {self._seen[name]}"
            raise self._fault("duplicate-name", message, start)
        self._seen[name] = start[0]
        return name

    def _joint(self, parent: int, depth: int) -> None:
        place = self._place
        name = self._title()
        if len(self._drafts) >= MOST_JOINTS:
            raise self._fault("too-many", f"more than {MOST_JOINTS} joints", place)
        if depth > MOST_DEPTH:
            raise self._fault("too-deep", f"nested deeper than {MOST_DEPTH}", place)
        index = len(self._drafts)
        draft = _Draft(name, parent, place[0])
        self._drafts.append(draft)
        while (word := self._word("}")) != "}":
            match word.upper():
                case "OFFSET":
                    draft.offset = self._three(draft.offset is not None, name)
                case "CHANNELS":
                    self._channels(draft)
                case "JOINT":
                    draft.children += 1
                    self._joint(index, depth + 1)
                case "END":
                    self._expect("SITE")
                    draft.site = self._site(draft)
                case _:
                    wanted = "OFFSET, CHANNELS, JOINT, End Site or }"
                    raise self._fault("bvh", f"expected {wanted}, found '{word[:40]}'")
        if draft.offset is None:
            raise self._fault("missing-key", f"joint '{name}' has no OFFSET")

    def _three(self, again: bool, name: str) -> tuple[float, float, float]:
        if again:
            raise self._fault("duplicate", f"joint '{name}' has two OFFSETs")
        x, y, z = (self._number("a number") for _ in range(3))
        return x, y, z

    def _site(self, draft: _Draft) -> tuple[float, float, float]:
        if draft.site is not None:
            raise self._fault("duplicate", f"joint '{draft.name}' has two end sites")
        while (word := self._word("{")) != "{":
            if word in ("}", "OFFSET"):
                raise self._fault("bvh", f"expected {{, found '{word}'")
        self._expect("OFFSET")
        offset = self._three(False, draft.name)
        self._expect("}")
        return offset

    def _number(self, expected: str) -> float:
        word = self._word(expected)
        if not looks_like_number(word):
            raise self._fault("number", f"not a number: '{word[:40]}'")
        value = float(word)
        if abs(value) > FARTHEST:
            raise self._fault("range", f"must be at most {FARTHEST:g} in size: {word[:40]}")
        return value

    def _count(self, what: str, most: int) -> int:
        word = self._word(what)
        if not (word.isascii() and word.isdigit() and len(word) < 10 and int(word) <= most):
            raise self._fault("number", f"{what} must be 0 to {most}, not '{word[:40]}'")
        return int(word)

    def _channels(self, draft: _Draft) -> None:
        if draft.channels is not None:
            raise self._fault("duplicate", f"joint '{draft.name}' has two CHANNELS")
        count = self._count("the number of channels", 6)
        names: list[str] = []
        for _ in range(count):
            word = self._word("a channel")
            if not _CHANNEL.fullmatch(word):
                message = f"no such channel: '{word[:40]}'; a channel is like Xposition, Zrotation"
                raise self._fault("channel", message)
            if word.lower() in map(str.lower, names):
                message = f"joint '{draft.name}' has the channel {word} twice"
                raise self._fault("channel", message)
            names.append(word)
        draft.channels = tuple(names)
        draft.first_column = self._columns
        self._columns += count

    def _joints(self) -> tuple[BvhJoint, ...]:
        return tuple(map(_finished, self._drafts))

    def _counts(self) -> tuple[int, float]:
        """Read the number of frames and the seconds a frame takes."""
        self._expect("FRAMES:")
        count = self._count("the number of frames", 10_000_000)
        self._expect("FRAME")
        self._expect("TIME:")
        seconds = self._number("the frame time")
        if seconds <= 0.0:
            raise self._fault("range", f"the frame time must be above 0, not {seconds:g}")
        if extra := next(self._words, None):
            raise self._fault("bvh", f"nothing may follow the frame time: '{extra.group()[:40]}'")
        return count, seconds

    def _frames(self, count: int) -> Array:
        """Read the frames, one a line; slowly only if something is wrong."""
        rows = [(n, row) for n, row in enumerate(self._lines[self._line :], self._line + 1)]
        rows = [(n, row) for n, row in rows if row.strip()]
        if not self._columns:
            return np.empty((count, 0))
        if len(rows) == count and (values := self._numbers([row for _, row in rows])) is not None:
            return values
        raise self._frame_fault(rows, count)

    def _numbers(self, rows: list[str]) -> Array | None:
        """Read the frames at once; None if there is a fault anywhere."""
        if not rows:
            return np.empty((0, self._columns))
        try:
            values = np.loadtxt(rows, np.float64, comments=None, ndmin=2)
        except ValueError:
            return None
        plain = not any("_" in row for row in rows)
        fits = values.shape == (len(rows), self._columns)
        return values if plain and fits and (np.abs(values) <= FARTHEST).all() else None

    def _frame_fault(self, rows: list[tuple[int, str]], count: int) -> InputError:
        for number, row in rows[:count]:
            words = row.split()
            for found in re.finditer(r"\S+", row):
                place = (number, found.start() + 1)
                if not looks_like_number(found.group()):
                    return self._fault("number", f"not a number: '{found.group()[:40]}'", place)
                if abs(float(found.group())) > FARTHEST:
                    return self._fault("range", f"must be at most {FARTHEST:g} in size", place)
            if len(words) != self._columns:
                message = f"a frame has {self._columns} numbers, this line has {len(words)}"
                return self._fault("length", message, (number, 1))
        if len(rows) > count:
            message = f"the file announces {count} frames and holds {len(rows)}"
            return self._fault("length", message, (rows[count][0], 1))
        last = self._lines[-1]
        message = f"the file ends after {len(rows)} of {count} frames"
        return self._fault("cut", message, (len(self._lines), len(last) + 1))


def _finished(draft: _Draft) -> BvhJoint:
    channels = draft.channels or ()
    kinds: dict[str, list[tuple[int, int]]] = {"position": [], "rotation": []}
    for place, channel in enumerate(channels):
        column = draft.first_column + place
        kinds[channel[1:].lower()].append(("xyz".index(channel[0].lower()), column))
    moves, turns = kinds["position"], kinds["rotation"]
    return BvhJoint(
        draft.name,
        draft.parent,
        draft.offset or (0.0, 0.0, 0.0),
        tuple(axis for axis, _ in moves),
        tuple(axis for axis, _ in turns),
        tuple(column for _, column in (*moves, *turns)),
        channels,
        draft.site,
        draft.line,
    )
