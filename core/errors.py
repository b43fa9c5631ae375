"""The errors limbik raises, and the faults that say what is wrong with an input.

Everything a user can cause is a `LimbikError`; whatever else escapes is a bug in limbik.

```
LimbikError
├── InputError            exit 2   the input is wrong; `.faults` lists everything found
│   ├── ChainError                 joints that make no chain; `.joint` names the culprit
│   └── SceneError                 faults in a scene file, each with file:line:column
├── EnvironmentProblem    exit 3   something is missing on this machine
└── PluginError           exit 4   a plug-in failed; `.plugin`, `.strategy`, `.slot`
```

This module imports nothing but the standard library, so every other module may import it.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar

MOST_FAULTS = 20
"""How many faults one error shows: more are no help, and the first ones often cause the rest."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with an input, and where.

    Attributes:
        code: Stable name of the kind of fault, such as `unknown-key`.
        message: What was found and what would be right, in one sentence.
        key: Place inside the input, such as `chain.joints[1].offset[2]`; empty if none.
        file: Name of the file, or empty.
        line: Line in the file, counted from 1; 0 if unknown.
        column: Column in characters, counted from 1; 0 if unknown.
        hint: What to try, such as `did you mean 'offset'?`; empty if none.
    """

    code: str
    message: str
    key: str = ""
    file: str = ""
    line: int = 0
    column: int = 0
    hint: str = ""

    @property
    def place(self) -> str:
        """Where it is, as `file:line:column`, without the parts that are unknown."""
        parts = [self.file] if self.file else []
        if self.line:
            parts.append(str(self.line))
            if self.column:
                parts.append(str(self.column))
        return ":".join(parts)

    def __str__(self) -> str:
        heads = [part for part in (self.place, f"error[{self.code}]", self.key) if part]
        tail = f" ({self.hint})" if self.hint else ""
        return ": ".join([*heads, self.message]) + tail


class LimbikError(Exception):
    """Base of every error that is not a bug in limbik.

    Attributes:
        exit_code: Code the command line ends with when this error reaches it.
    """

    exit_code: ClassVar[int] = 2


class InputError(LimbikError):
    """The input is wrong.

    Args:
        faults: One or more faults, or a sentence for a fault that needs no place.

    Attributes:
        faults: Everything found; `str()` gives one line for each.
    """

    exit_code: ClassVar[int] = 2

    def __init__(self, faults: "Iterable[Fault] | Fault | str") -> None:
        if isinstance(faults, str):
            faults = Fault("input", faults)
        self.faults: tuple[Fault, ...] = (faults,) if isinstance(faults, Fault) else tuple(faults)
        if not self.faults:
            raise ValueError("an InputError needs at least one fault")
        super().__init__(self.faults)

    def __str__(self) -> str:
        return "\n".join(map(str, self.faults))


class ChainError(InputError):
    """Joints that make no chain.

    Args:
        faults: As for `InputError`.
        joint: Name of the joint at fault; None when it is the chain as a whole.
    """

    def __init__(self, faults: "Iterable[Fault] | Fault | str", joint: str | None = None) -> None:
        if isinstance(faults, str):
            faults = Fault("chain", faults, key=joint or "")
        super().__init__(faults)
        self.joint = joint

    def __reduce__(self) -> "tuple[type[ChainError], tuple[tuple[Fault, ...], str | None]]":
        return type(self), (self.faults, self.joint)


class SceneError(InputError):
    """Faults in a scene file, each with its file, line and column."""


class EnvironmentProblem(LimbikError):
    """Something is missing on this machine: an extra, a writable folder, a program."""

    exit_code: ClassVar[int] = 3


class PluginError(LimbikError):
    """A plug-in failed: at import, at registration or while solving.

    Args:
        message: What happened.
        plugin: Name of the plug-in (its distribution, or `limbik` for a built-in one).
        strategy: Name of the strategy, or empty.
        slot: Slot the strategy fills, or empty.
    """

    exit_code: ClassVar[int] = 4

    def __init__(self, message: str, plugin: str = "", strategy: str = "", slot: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.plugin = plugin
        self.strategy = strategy
        self.slot = slot

    def __reduce__(self) -> "tuple[type[PluginError], tuple[str, str, str, str]]":
        return type(self), (self.message, self.plugin, self.strategy, self.slot)

    def __str__(self) -> str:
        parts = [
            f"{label} '{name}'"
            for label, name in (
                ("plug-in", self.plugin),
                (self.slot or "strategy", self.strategy),
            )
            if name
        ]
        return ": ".join([", ".join(parts), self.message] if parts else [self.message])


def key_text(path: Sequence[str | int]) -> str:
    """Write a place inside an input the way it is read, such as `chain.joints[1].offset[2]`.

    Args:
        path: Keys of mappings and indices of lists, outermost first.
    """
    text = ""
    for part in path:
        if isinstance(part, int):
            text += f"[{part}]"
        elif re.fullmatch(r"[\w-]{1,60}", part):
            text += f".{part}" if text else part
        else:
            text += f"[{clipped(part)!r}]"
    return text


def clipped(text: str, most: int = 40) -> str:
    """Return a text for a message, its end left out if it has more characters than `most`."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def shortlist(faults: Iterable[Fault]) -> list[Fault]:
    """Sort faults by place and keep at most `MOST_FAULTS`.

    Unknown keys stay in the list before others do, because a mistyped key causes further faults.
    When some are left out, the last entry says how many.
    """
    ranked = sorted(faults, key=lambda f: (f.code != "unknown-key", f.line, f.column))
    kept = ranked if len(ranked) <= MOST_FAULTS else ranked[: MOST_FAULTS - 1]
    kept = sorted(kept, key=lambda f: (f.line, f.code != "unknown-key", f.column))
    left_out = len(ranked) - len(kept)
    if left_out:
        last = kept[-1]
        message = f"{left_out} more faults are not shown"
        kept.append(Fault("more", message, file=last.file, line=last.line, column=last.column))
    return kept
