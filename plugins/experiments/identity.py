"""What makes two runs the same experiment: all that its results depend on, and a fingerprint."""

import json
import platform
from collections.abc import Iterator, Sequence
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np

from limbik import __version__
from limbik.core.cache import digest
from limbik.core.errors import key_text
from limbik.core.scene import Scene
from limbik.plugins.experiments.goalsets import Points
from limbik.plugins.experiments.read import Experiment

NOT_RESULTS = ("engine", "workers", "output", "name", "chains")
"""Keys of an experiment that change nothing of its table; the chains count as what they are."""
_LIBRARIES = ("numpy", "numba", "llvmlite")


def contents(experiment: Experiment) -> dict[str, Any]:
    """Return all that the results depend on, as plain values."""
    model = experiment.model.model_dump(mode="json", exclude_unset=True)
    return {
        "experiment": {key: model[key] for key in model if key not in NOT_RESULTS},
        "scenes": {name: _scene_contents(scene) for name, scene in experiment.scenes.items()},
        "points": {
            trial.goal_set.name: _digest(trial.goal_set.goals.points)
            for trial in experiment.trials
            if isinstance(trial.goal_set.goals, Points)
        },
    }


def _scene_contents(scene: Scene) -> dict[str, Any]:
    """Return what counts of a scene: not its goals, and a chain from another file by its joints."""
    content = {key: scene.document.content[key] for key in scene.document.content}
    for aside in ("goals", "judge", "trajectory", "follow"):
        content.pop(aside, None)
    chain = scene.chain
    arrays = (chain.offsets, chain.frozen, chain.rest, chain.low, chain.high, chain.base_rotation)
    return {**content, "joints": _digest(*arrays)}


def versions(distributions: Sequence[str] = ()) -> dict[str, str]:
    """Return the versions the results depend on.

    Args:
        distributions: Those of plug-ins that are used.
    """
    found = {name: _version(name) for name in (*_LIBRARIES, *distributions)}
    return {"limbik": __version__, "python": platform.python_version(), **found}


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "missing"


def fingerprint(content: dict[str, Any], of: dict[str, str]) -> str:
    """Shorten contents and versions to 16 hexadecimal digits."""
    text = json.dumps([content, of], sort_keys=True, ensure_ascii=False)
    return digest(text)


def differences(old: Any, new: Any, path: tuple[str | int, ...] = ()) -> Iterator[str]:
    """Name the keys in which two contents differ, with both values where they are short."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted({*old, *new}, key=str):
            yield from differences(old.get(key), new.get(key), (*path, str(key)))
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for index, (before, after) in enumerate(zip(old, new, strict=True)):
            yield from differences(before, after, (*path, index))
    elif old != new:
        shown = [json.dumps(value, ensure_ascii=False) for value in (old, new)]
        brief = all(len(text) <= 40 for text in shown)
        yield key_text(path) + (f": {shown[0]} there, {shown[1]} here" if brief else "")


def _digest(*arrays: Any) -> str:
    joined = b"".join(np.ascontiguousarray(array, np.float64).tobytes() for array in arrays)
    return sha256(joined).hexdigest()[:16]
