"""What the viewer shows as a scene file that gives it again."""

from typing import Any

import numpy as np
import yaml

from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.plugins.viewer.session import Chained, Session

_LEFT_OUT = ("pole", "judge", "trajectory")  # written anew, or about the whole path


def scene_text(session: Session) -> str:
    """Write the present state as a scene with one goal.

    What the scene says of the chain stays as it is written there, so that a path to a robot or a
    clip needs the same folder.
    """
    one = session.chain
    written = _document(one.setup.given).items()
    content = {key: value for key, value in written if key not in _LEFT_OUT}
    content |= _solve_keys(one)
    content["follow"] = session.follow
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, allow_unicode=True)
    return f"# Saved by `limbik view` from {session.name}.\n\n{text}"


def _document(scene: Scene) -> dict[str, Any]:
    content = scene.document.content
    assert isinstance(content, dict)
    return content


def _solve_keys(one: Chained) -> dict[str, Any]:
    """The keys of a scene that say how a chain is solved, and its goal."""
    scene = one.setup.scene
    choice = one.setup.choice
    keys: dict[str, Any] = {
        "solver": choice["use"] if len(choice) == 1 else _plain(choice),
        "options": _plain(scene.settings.model_dump(exclude_unset=True)),
        "fk": {
            name: np.degrees(turn).tolist()
            for name, turn in zip(scene.chain.names, one.setup.fk, strict=True)
            if turn.any()
        },
    }
    if scene.pole is not None:
        keys["pole"] = _plain(scene.pole.model_dump(exclude_unset=True, exclude_none=True))
        keys["pole"]["bind"] = scene.bind
    goal: dict[str, Any] = {"name": "view", "position": one.goal.tolist()}
    turn = _given(one.turn)
    if turn is not None and scene.pole is not None and scene.pole.rotor:
        goal["rotation"] = np.degrees(turn).tolist()
    keys["goals"] = [goal]
    return keys


def _given(turn: Array | None) -> Array | None:
    return None if turn is None or np.isnan(turn).any() else turn


def _plain(value: Any) -> Any:
    """Return a value as YAML has it: lists for tuples."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    return [_plain(inner) for inner in value] if isinstance(value, tuple | list) else value
