"""A scene's chain out of a file: find the input that reads it, and keep its faults in place."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from limbik.core.errors import ChainError, Fault, InputError, PluginError
from limbik.core.formats import Body, SceneInput
from limbik.core.registry import Registry
from limbik.core.validation import validation_faults
from limbik.core.yamlfile import Document, KeyPath

_STANDS_FOR_CHAIN = {"joints": [{"name": "base"}, {"name": "end"}]}
_STANDS_FOR_GOALS = [{"position": [0.0, 0.0, 0.0]}]


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
    body, faults = _read(found, chain, document, folder)
    if found.has_goals and "goals" not in content and (body is None or body.goals is not None):
        replaced["goals"] = _STANDS_FOR_GOALS
    return Source(replaced, body, faults)


def _read(
    found: SceneInput, chain: dict[str, Any], document: Document, folder: Path
) -> tuple[Body | None, tuple[Fault, ...]]:
    place: KeyPath = ("chain",)
    try:
        return found.read(found.model.model_validate(chain), folder), ()
    except ValidationError as error:
        return None, tuple(validation_faults(error, document, found.model, place))
    except ChainError as error:
        return None, tuple(
            document.fault(f.code, f.message, place, hint=f.hint) for f in error.faults
        )
    except InputError as error:
        return None, tuple(_placed(fault, found, document) for fault in error.faults)
    except (ArithmeticError, LookupError, TypeError, AttributeError) as error:
        cause = f"reading {chain[found.name]} failed: {type(error).__name__}: {error}"
        raise PluginError(cause, found.name, found.name, "scene_input") from error


def _placed(fault: Fault, found: SceneInput, document: Document) -> Fault:
    """Point a fault that has no place in the file read at its key in the scene."""
    if fault.line:
        return fault
    key = fault.key if fault.key in found.model.model_fields else found.name
    message = f"{fault.file}: {fault.message}" if fault.file else fault.message
    return document.fault(fault.code, message, ("chain", key), hint=fault.hint)
