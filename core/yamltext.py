"""From the bytes of a YAML file to text that a parser may see: size, encoding, characters.

Only UTF-8 is read. Characters that YAML 1.2 does not allow are refused here, and so are the line
breaks that only YAML 1.1 knows (U+0085, U+2028, U+2029): with them in the text, line numbers would
differ from those of an editor.
"""

import re
from itertools import islice

from limbik.core.errors import MOST_FAULTS, Fault, SceneError

MOST_BYTES = 1_000_000

_LINE_BREAK = re.compile("\r\n|\r|\n")
_NOT_ALLOWED = re.compile(
    "[^\t\n\r\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"
)
_OTHER_ENCODINGS = {b"\xff\xfe": "UTF-16", b"\xfe\xff": "UTF-16", b"\0\0\xfe\xff": "UTF-32"}
_BYTE_ORDER_MARK = "\ufeff"


def read_text(source: str | bytes, name: str) -> str:
    """Check size and encoding and return the text, without a byte order mark.

    Args:
        source: What the file holds.
        name: Name of the file for messages.

    Raises:
        SceneError: The file is too large, not UTF-8, or holds characters that are not allowed.
    """
    size = len(source) if isinstance(source, bytes) else len(source.encode(errors="surrogatepass"))
    if size > MOST_BYTES:
        message = f"the file has {size} bytes, the limit is {MOST_BYTES}"
        raise SceneError(Fault("too-large", message, file=name, line=1, column=1))
    text = _decode(source, name) if isinstance(source, bytes) else source
    text = text.removeprefix(_BYTE_ORDER_MARK)
    found = islice(_NOT_ALLOWED.finditer(text), MOST_FAULTS)
    faults = [_character_fault(text, character, name) for character in found]
    if faults:
        raise SceneError(faults)
    return text


def odd_character(text: str) -> str | None:
    """Name the first character of a scalar that may not be in it, even when escaped."""
    found = _NOT_ALLOWED.search(text)
    return _code_point(found.group()) if found else None


def _decode(source: bytes, name: str) -> str:
    for mark, encoding in _OTHER_ENCODINGS.items():
        if source.startswith(mark):
            message = f"the file is {encoding}, it must be UTF-8"
            raise SceneError(Fault("encoding", message, file=name, line=1, column=1))
    try:
        return source.decode()
    except UnicodeDecodeError as error:
        line, column = _end_of(source[: error.start].decode().removeprefix(_BYTE_ORDER_MARK))
        fault = Fault(
            "encoding",
            f"the byte 0x{source[error.start]:02x} is not UTF-8",
            file=name,
            line=line,
            column=column,
            hint="save the file as UTF-8",
        )
        raise SceneError(fault) from None


def _character_fault(text: str, found: re.Match[str], name: str) -> Fault:
    line, column = _end_of(text[: found.start()])
    message = f"the character {_code_point(found.group())} is not allowed"
    return Fault("encoding", message, file=name, line=line, column=column)


def _code_point(character: str) -> str:
    return f"U+{ord(character):04X}"


def _end_of(text: str) -> tuple[int, int]:
    """Line and column, from 1, of the place right after `text`."""
    lines = _LINE_BREAK.split(text)
    return len(lines), len(lines[-1]) + 1
