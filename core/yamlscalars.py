"""What an unquoted YAML scalar means: the core schema of YAML 1.2, less its surprises.

| written                          | value                                  |
|----------------------------------|----------------------------------------|
| `12`, `-3`, `+7`, `010`          | whole number, always decimal           |
| `1.5`, `.5`, `2.`, `1e-3`        | number                                 |
| `true`, `false`                  | truth value                            |
| `null`, `~`, nothing             | nothing                                |
| `.nan`, `.inf`, `1e999`          | refused: no place of a scene wants one |
| all else                         | text                                   |

So `yes`, `no`, `on`, `off`, `True`, `0x10`, `0o17`, `1_000`, `1:30` and `2026-01-01` are text.
"""

import math
import re

from limbik.core.errors import clipped

Scalar = str | int | float | bool | None

_WORDS: dict[str, bool | None] = {"": None, "~": None, "null": None, "true": True, "false": False}
_WHOLE = re.compile(r"[-+]?[0-9]+")
_NUMBER = re.compile(r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")
_LARGEST = 2**63 - 1
_MOST_DIGITS = 400


class ScalarFault(Exception):
    """A scalar that is refused; `code` and `message` go into a `Fault`."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code
        self.message = message


def plain_scalar(text: str) -> Scalar:
    """Give the value of an unquoted scalar.

    Raises:
        ScalarFault: It is a number that is not finite, too large or too small.
    """
    if text in _WORDS:
        return _WORDS[text]
    if _NOT_FINITE.fullmatch(text):
        raise ScalarFault("not-finite", f"{text} is not a finite number")
    if not _NUMBER.fullmatch(text):
        return text
    return _whole(text) if _WHOLE.fullmatch(text) else _number(text)


def looks_like_number(text: str) -> bool:
    """Tell whether the text would be a number if it were not quoted."""
    return _NUMBER.fullmatch(text) is not None


def _whole(text: str) -> int:
    if len(text) > _MOST_DIGITS or abs(int(text)) > _LARGEST:
        raise ScalarFault("number", f"the number is too large: {clipped(text, 15)}")
    return int(text)


def _number(text: str) -> float:
    value = float(text)
    if math.isinf(value):
        raise ScalarFault("number", f"the number is too large: {clipped(text, 15)}")
    if value == 0.0 and re.search("[1-9]", re.split("[eE]", text)[0]):
        raise ScalarFault(
            "number", f"the number is too small to tell from zero: {clipped(text, 15)}"
        )
    return value
