"""What a YAML parser's complaint means, in plain words.

The two parsers of PyYAML word the same fault differently; here both end in the same message.
"""

from typing import Any

from limbik.core.errors import Fault

_TAB = "a tab cannot indent; use spaces"

# Looked for in the parser's "problem", in this order.
_PLAIN_WORDS = (
    ("unexpected end of stream", "the file ends inside a quoted text"),
    ("unexpected document", "a line '---' or '...' inside a quoted text"),
    ("'\\t'", _TAB),
    ("tab character", _TAB),
    ("cannot start any token", "this character cannot start a value; put the text in quotes"),
    (
        "mapping values are not allowed",
        "no ':' may stand here: wrong indentation, or text that needs quotes",
    ),
    ("could not find expected ':'", "a ':' is missing after the key"),
    ("',' or ']'", "expected ',' or ']'"),
    ("',' or '}'", "expected ',' or '}'"),
    ("expected '-' indicator", "this line is indented differently from its neighbours"),
    ("<block end>, but found", "this line is indented differently from its neighbours"),
    ("did not find expected key", "this line is indented differently from its neighbours"),
    ("expected node content", "a value is missing here"),
    ("the node content", "a value is missing here"),
    ("unknown escape character", "unknown escape; write '\\\\' for a backslash in double quotes"),
    ("block sequence entries are not allowed", "a list item '-' cannot start here"),
    ("sequence entries are not allowed", "a list item '-' cannot start here"),
    ("block mapping keys are not allowed", "a key cannot start here"),
    ("mapping keys are not allowed", "a key cannot start here"),
    ("<document start>", "the document has ended, yet more text follows"),
    ("found unexpected ':'", "put a space after ':', or quotes round the text"),
    (
        "expected alphabetic or numeric",
        "'&' and '*' start anchors and aliases, which are not allowed; quote the text",
    ),
    ("directive name", "'%' at the start of a line is a directive; quote the text"),
    ("indentation", "wrong indentation of a block of text"),
)


def is_nesting(error: Exception) -> bool:
    """Tell whether the C parser gave up looking ahead because of the depth."""
    return "nesting depth" in str(getattr(error, "problem", None))


def syntax_fault(error: Exception, name: str) -> Fault:
    """Turn an error of the YAML parser into a fault with line and column.

    Args:
        error: A `yaml.YAMLError`, from the C or the Python parser.
        name: Name of the file for messages.
    """
    mark: Any = getattr(error, "problem_mark", None)
    opened: Any = getattr(error, "context_mark", None)
    problem = str(getattr(error, "problem", None) or "this is not YAML")
    message = next((words for sign, words in _PLAIN_WORDS if sign in problem), problem)
    mark = mark or opened
    line, column = (mark.line + 1, mark.column + 1) if mark else (1, 1)
    hint = ""
    if opened and opened.line + 1 < line and message != _TAB:
        hint = f"it began at line {opened.line + 1}, column {opened.column + 1}"
    return Fault("syntax", message, file=name, line=line, column=column, hint=hint)
