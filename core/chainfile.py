"""A scene's chain or skeleton out of a file: what reads it, and its faults kept in place."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from limbik.core.errors import ChainError, Fault, InputError, PluginError
from limbik.core.formats import Body
from limbik.core.registry import Registry
from limbik.core.settings import Model
from limbik.core.validation import validation_faults
from limbik.core.yamlfile import Document

Read = TypeVar("Read")

STANDS_FOR_GOALS = [{"position": [0.0, 0.0, 0.0]}]
_STANDS_FOR_CHAIN = {"joints": [{"name": "base"}, {"name": "end"}]}


@dataclass(frozen=True)
class Source:
    """What became of a scene's chain that is not written out.

    Attributes:
        content: The scene with something harmless where the chain was, for the schema to check.
        body: The body; None if the chain is written out or at fault.
        faults: What is wrong with it.
    """

    content: Any
    body: Body | None = None
    faults: tuple[Fault, ...] = ()


def read_source(document: Document, folder: Path, registry: Registry | None) -> Source:
    """Read a scene's chain if it comes from a file.

    Args:
        document: The scene.
        folder: Folder that relative paths start from.
        registry: Where the inputs are looked up; a new `Registry()` if absent.

    Raises:
        PluginError: An input failed.
    """
    content = document.content
    chain = content.get("chain") if isinstance(content, dict) else None
    if not isinstance(chain, dict) or not chain or "joints" in chain:
        return Source(content)
    found = (registry or Registry()).scene_input(chain)
    if found is None:
        return Source(content)
    replaced = {**content, "chain": _STANDS_FOR_CHAIN}
    place = document.under(("chain",))
    body, faults = read_file(found.name, found.model, found.read, place, folder)
    if found.has_goals and "goals" not in content and (body is None or body.goals is not None):
        replaced["goals"] = STANDS_FOR_GOALS
    return Source(replaced, body, faults)


def read_file(
    name: str,
    model: type[Model],
    read: Callable[[Any, Path], Read],
    document: Document,
    folder: Path,
) -> tuple[Read | None, tuple[Fault, ...]]:
    """Let a scene input read the file a mapping of a scene names.

    Args:
        name: Of the input, and of the mapping's key for the file.
        model: What the mapping may hold.
        read: Makes a body or a skeleton of it.
        document: The mapping.
        folder: Folder that relative paths start from.

    Returns:
        What was read and what is wrong with it; the former is None if anything is.

    Raises:
        PluginError: The input failed.
    """
    try:
        return read(model.model_validate(document.content), folder), ()
    except ValidationError as error:
        return None, tuple(validation_faults(error, document, model))
    except ChainError as error:
        return None, tuple(document.placed(fault, ()) for fault in error.faults)
    except InputError as error:
        keys = [f.key if f.key in model.model_fields else name for f in error.faults]
        pairs = zip(error.faults, keys, strict=True)
        return None, tuple(document.placed(fault, (key,)) for fault, key in pairs)
    except (ArithmeticError, LookupError, TypeError, AttributeError) as error:
        cause = f"reading {document.content[name]} failed: {type(error).__name__}: {error}"
        raise PluginError(cause, name, name, "scene_input") from error
