"""The strategies a scene chooses, checked against the registry."""

import re
from collections.abc import Iterator
from typing import Any

from limbik.core.errors import Fault, InputError
from limbik.core.registry import Registry
from limbik.core.slots import LIMIT, OPTIONS, SOLVER
from limbik.core.whole import BUILT_IN_3D, OWN_SOLVERS
from limbik.core.yamlfile import Document, KeyPath


def _choices(content: Any) -> Iterator[tuple[KeyPath, str, Any]]:
    """Give place, slot and choice of every strategy a scene chooses, unchecked."""
    if not isinstance(content, dict):
        return
    if content.get(SOLVER.name, BUILT_IN_3D) not in OWN_SOLVERS:
        yield (SOLVER.name,), SOLVER.name, content[SOLVER.name]
    options = content.get("options")
    if isinstance(options, dict):
        yield from ((("options", slot), slot, options[slot]) for slot in OPTIONS if slot in options)
    for holder in ("chain", "skeleton"):
        owner = content.get(holder)
        joints = owner.get("joints") if isinstance(owner, dict) else None
        for number, joint in enumerate(joints if isinstance(joints, list) else ()):
            if isinstance(joint, dict) and LIMIT.name in joint:
                yield (holder, "joints", number, LIMIT.name), LIMIT.name, joint[LIMIT.name]


def checkable(content: Any) -> Any:
    """Leave out options without a strategy's name: `strategy_faults` has them already.

    A scene with a trajectory needs no goals.
    """
    nameless = [
        slot
        for place, slot, choice in _choices(content)
        if place[0] == "options"
        and isinstance(choice, dict)
        and not isinstance(choice.get("use"), str)
    ]
    if isinstance(content, dict) and "trajectory" in content:
        content = {"goals": [], **content}
    if not nameless:
        return content
    options = {key: value for key, value in content["options"].items() if key not in nameless}
    return {**content, "options": options}


def strategy_faults(document: Document, registry: Registry | None) -> Iterator[Fault]:
    """Check each chosen strategy and its parameters against the registry."""
    for place, slot, choice in _choices(document.content):
        if isinstance(choice, str | dict):
            registry = registry or Registry()
            yield from choice_faults(slot, choice, place, document, registry)


def choice_faults(
    slot: str, choice: str | dict[str, Any], place: KeyPath, document: Document, registry: Registry
) -> Iterator[Fault]:
    """Check a chosen strategy and its parameters against the registry.

    Args:
        slot: What the strategy is chosen for.
        choice: Its name, or a mapping with the name under `use`.
        place: Where in the document it is chosen.
        document: Where it was read.
        registry: Where strategies are looked up.
    """
    try:
        registry.bind(slot, choice)
    except InputError as error:
        for fault in error.faults:
            key = "use" if fault.code == "unknown-strategy" else fault.key
            path = (*place, *_key_path(key))
            at_key = fault.code == "unknown-key"
            message = fault.message
            if slot == SOLVER.name:
                message = message.replace("known: ", f"known: {', '.join(OWN_SOLVERS)}, ")
            yield document.fault(fault.code, message, path, hint=fault.hint, at_key=at_key)


def _key_path(key: str) -> KeyPath:
    """Take `axis[2]` apart into `("axis", 2)`."""
    parts = re.findall(r"\[(\d+)\]|([^.\[\]]+)", key)
    return tuple(int(index) if index else name for index, name in parts)
