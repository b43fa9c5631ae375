"""What the viewer shows as a scene file that gives it again."""

from typing import Any

import numpy as np
import yaml

from limbik.core.chain import AXES
from limbik.plugins.viewer.session import Chained, Session
from limbik.plugins.viewer.setup import Setup

_LEFT_OUT = ("pole", "axes", "judge", "trajectory")  # written anew, or about the whole path


def scene_text(session: Session) -> str:
    """Write the present state as a scene with one goal.

    What the scene says of the chain stays as it is written there, so that a path to a robot or a
    clip needs the same folder.
    """
    if session.body is None:
        content = _changed(session.chain, session)
    else:
        content = dict(session.body.document.content)
        content["chains"] = [_changed(one, session) for one in session.chains.values()]
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, allow_unicode=True)
    return f"# Saved by `limbik view` from {session.name}.\n\n{text}"


def _changed(one: Chained, session: Session) -> dict[str, Any]:
    """What a scene says of a chain, with how it is solved now."""
    written = one.setup.given.document.content
    kept = {key: value for key, value in written.items() if key not in _LEFT_OUT}
    if one.setup.takes_limits:
        kept["chain"] = _limited(written["chain"], one.setup)
    return kept | _solve_keys(one, session.frame) | {"follow": session.follow}


def _limited(chain: dict[str, Any], setup: Setup) -> dict[str, Any]:
    """A chain as its scene writes it, with the limits its joints have now."""
    joints = []
    given = zip(chain["joints"], setup.given.chain.joints, setup.chain.joints, strict=True)
    for written, before, now in given:
        joint = dict(written)
        if now != before:
            for key in ("limit",) if now.limit is None else (*AXES, "limit"):
                joint.pop(key, None)
            if now.limit is not None:
                joint["limit"] = _plain(now.limit)
        joints.append(joint)
    return {**chain, "joints": joints}


def _solve_keys(one: Chained, frame: int) -> dict[str, Any]:
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
    turn = one.turn(frame)
    if turn is not None and one.setup.takes_turn and np.isfinite(turn).all():
        goal["rotation"] = np.degrees(turn).tolist()
    keys["goals"] = [goal]
    return keys


def _plain(value: Any) -> Any:
    """Return a value as YAML has it: lists for tuples."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    return [_plain(inner) for inner in value] if isinstance(value, tuple | list) else value
