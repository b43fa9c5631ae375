"""Read a scene with several chains on one skeleton, see `limbik.core.bodymodel` (M-11).

Each chain becomes a `Scene` of its own, checked as a scene with one chain is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from limbik.core.bodymodel import BodyModel, PartModel, SkeletonJointModel
from limbik.core.bodyorder import order_faults
from limbik.core.chain import MAX_JOINTS
from limbik.core.chainfile import STANDS_FOR_GOALS, read_file
from limbik.core.choices import checkable, strategy_faults
from limbik.core.errors import ChainError, Fault, InputError, SceneError, shortlist
from limbik.core.formats import SceneInput
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene, build_scene, joint_of, open_scene, scene_from
from limbik.core.scenegoals import twice
from limbik.core.skeleton import WORLD, JointSkeleton, Limb, Skeleton
from limbik.core.validation import validation_faults
from limbik.core.wording import near_match
from limbik.core.yamlfile import Document

_STANDS_FOR_SKELETON = {"joints": [{"name": "base"}]}


@dataclass(frozen=True, eq=False, slots=True)
class Part:
    """One chain of a body.

    Attributes:
        name: Its name.
        scene: Chain, options and goals, standing where the skeleton's first frame has it. The goals
            are one a frame, in the axes of `frame`.
        limb: The chain as a part of the skeleton.
        frame: Index of the joint in whose frame goals and pole are; -1 for the world.
    """

    name: str
    scene: Scene
    limb: Limb
    frame: int = WORLD


@dataclass(frozen=True, eq=False, slots=True)
class BodyScene:
    """A scene of several chains that can be solved.

    Attributes:
        name: Name of the file without folder and ending.
        skeleton: What the chains are part of.
        parts: The chains, in the order they are solved.
        frame_names: One a frame.
        document: The file with its positions.
        frame_time: Seconds a frame of the skeleton's own motion; None if it has none.
    """

    name: str
    skeleton: Skeleton
    parts: tuple[Part, ...]
    frame_names: tuple[str, ...]
    document: Document
    frame_time: float | None = None

    @property
    def goals(self) -> dict[str, Array]:
        """The goals of each chain by its name, one a frame, (m, 3) [length]."""
        return {part.name: part.scene.goals for part in self.parts}

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know, one sentence each."""
        own = [f"{part.name}: {note}" for part in self.parts for note in part.scene.notes]
        return (*self.skeleton.notes, *own)


def read_any(source: str | Path, registry: Registry | None = None) -> Scene | BodyScene:
    """Read a scene file, with one chain or several.

    Args:
        source: Path of the file, or `-` for standard input.
        registry: Where strategies and inputs are looked up; a new `Registry()` if absent.

    Raises:
        SceneError: With every fault that could be found.
        PluginError: A plug-in failed.
    """
    document, folder = open_scene(source)
    content = document.content
    if isinstance(content, dict) and {"skeleton", "chains"} & content.keys():
        return body_from(document, folder, registry)
    return scene_from(document, folder, registry)


def read_body(source: str | Path, registry: Registry | None = None) -> BodyScene:
    """Read a scene file with several chains; as `read_any`."""
    document, folder = open_scene(source)
    return body_from(document, folder, registry)


def body_from(document: Document, folder: Path, registry: Registry | None = None) -> BodyScene:
    """Make a scene of several chains of a YAML document that has been read.

    Args:
        document: The document.
        folder: Folder that relative paths in the scene start from.
        registry: As for `read_any`.

    Raises:
        SceneError: With every fault that could be found.
    """
    registry = registry or Registry()
    given = document.content if isinstance(document.content, dict) else {}
    chosen = _input(given.get("skeleton"), document, registry)
    parts = given["chains"] if isinstance(given.get("chains"), list) else []
    documents = [document.under(("chains", index)) for index in range(len(parts))]
    faults = [f for part in (document, *documents) for f in strategy_faults(part, registry)]
    model = None
    try:
        model = BodyModel.model_validate(_standing_in(document.content, chosen))
    except ValidationError as error:
        faults += validation_faults(error, document, BodyModel)
    skeleton = None
    if chosen is not None and chosen.skeleton is not None:
        place, reader = document.under(("skeleton",)), chosen.skeleton
        skeleton, found = read_file(chosen.name, reader.model, reader.read, place, folder)
        faults += found
    elif model is not None:
        skeleton, found = _skeleton(model.skeleton.joints, document)
        faults += found
    if model is None or skeleton is None or faults:
        raise SceneError(shortlist(faults))
    return _body(model, skeleton, document, documents, folder, registry)


def _input(given: Any, document: Document, registry: Registry) -> SceneInput | None:
    """Find what reads the skeleton's file, if it comes from one."""
    if not isinstance(given, dict) or not given or "joints" in given:
        return None
    found = registry.scene_input(given)
    if found is not None and found.skeleton is None:
        message = f"'{found.name}' gives single chains, no skeleton"
        raise SceneError([document.fault("skeleton", message, ("skeleton",))])
    return found


def _standing_in(content: Any, chosen: SceneInput | None) -> Any:
    """Put something harmless where a file's skeleton and goals go, and faulty choices were."""
    if not isinstance(content, dict):
        return content
    replaced = dict(content)
    if chosen is not None:
        replaced["skeleton"] = _STANDS_FOR_SKELETON
    if isinstance(content.get("chains"), list):
        own_goals = {} if chosen is None or not chosen.has_goals else {"goals": STANDS_FOR_GOALS}
        replaced["chains"] = [
            {**own_goals, **checkable(part)} if isinstance(part, dict) else part
            for part in content["chains"]
        ]
    return replaced


def _skeleton(
    models: Sequence[SkeletonJointModel], document: Document
) -> tuple[Skeleton | None, tuple[Fault, ...]]:
    """Make the skeleton of joints that are written out."""
    place = ("skeleton", "joints")
    names = [model.name for model in models]
    faults = list(twice(names, place, "joint", document))
    if not 2 <= len(names) <= MAX_JOINTS:
        message = f"a skeleton has 2 to {MAX_JOINTS} joints, this one has {len(names)}"
        faults.append(document.fault("joint-count", message, place))
    parents = []
    for index, model in enumerate(models):
        above = names[:index]
        parents.append(above.index(model.parent) if model.parent in above else WORLD)
        if model.parent is None or model.parent in above:
            continue
        message, hint = f"no joint is called '{model.parent}'", near_match(model.parent, names)
        if model.parent == model.name:
            message, hint = f"the joint '{model.name}' hangs from itself", ""
        elif model.parent in names:
            message = f"'{model.parent}' comes after '{model.name}'"
            hint = "list parents before their children; a circle has no such order"
        path = (*place, index, "parent")
        faults.append(document.fault("parent", message, path, hint=hint))
    if faults:
        return None, tuple(faults)
    try:
        return JointSkeleton.of([joint_of(model) for model in models], parents), ()
    except ChainError as error:
        return None, tuple(document.placed(fault, place) for fault in error.faults)


def _body(
    model: BodyModel,
    skeleton: Skeleton,
    document: Document,
    documents: Sequence[Document],
    folder: Path,
    registry: Registry,
) -> BodyScene:
    """Cut the limbs out of the skeleton and make a scene of each."""
    faults = list(twice([part.name for part in model.chains], ("chains",), "chain", document))
    parts = []
    for part, inner in zip(model.chains, documents, strict=True):
        try:
            parts.append(_part(part, skeleton, inner, folder, registry))
        except InputError as error:
            faults += [inner.placed(fault, (fault.key or "end",)) for fault in error.faults]
    if not faults:
        order = order_faults(skeleton, [(p.name, p.limb, p.frame) for p in parts])
        for index, fault in order:
            path = (fault.key,) if fault.key in documents[index].content else ()
            faults.append(documents[index].placed(fault, path))
        faults += _count_faults(parts, len(skeleton.motion.turns))
    if faults:
        raise SceneError(shortlist(faults))
    frames = len(skeleton.motion.turns)
    count = max(frames, *(len(part.scene.goals) for part in parts))
    fullest = next((p.scene.goal_names for p in parts if len(p.scene.goals) == count), None)
    names = fullest or tuple(str(k) for k in range(1, count + 1))
    moving = skeleton.motion.frame_time if frames > 1 else None
    parts = [replace(part, scene=_spread(part.scene, count)) for part in parts]
    return BodyScene(document.title, skeleton, tuple(parts), names, document, moving)


def _part(
    model: PartModel, skeleton: Skeleton, document: Document, folder: Path, registry: Registry
) -> Part:
    frame = WORLD if model.frame == "world" else skeleton.at(model.frame, "frame")
    try:
        limb = skeleton.limb(model.base, model.end)
    except ChainError as error:
        raise SceneError(document.placed(fault, ("end",)) for fault in error.faults) from error
    if frame != WORLD:
        limb = skeleton.seen_from(frame, limb)
    scene = build_scene(model.name, model, document, folder, registry, limb)
    assert isinstance(scene.body, Limb)
    return Part(model.name, scene, scene.body, frame)


def _count_faults(parts: Sequence[Part], frames: int) -> Iterator[Fault]:
    """Refuse chains whose goals are not one a frame."""
    counts = [len(part.scene.goals) for part in parts]
    most = max(frames, *counts)
    for part, count in zip(parts, counts, strict=True):
        if count in (1, most) and (frames == 1 or count in (1, frames)):
            continue
        whose = f"the skeleton moves for {frames} frames"
        if frames == 1:
            whose = f"the chain '{parts[counts.index(most)].name}' has {most}"
        message = f"{count} goals, but {whose}: give one goal, or one a frame"
        yield part.scene.document.fault("goal-count", message, ("goals",))


def _spread(scene: Scene, count: int) -> Scene:
    """Return a scene whose only goal is that of all frames."""
    if len(scene.goals) == count:
        return scene
    turns = scene.goal_turns
    return replace(
        scene,
        goal_names=scene.goal_names * count,
        goals=np.repeat(scene.goals, count, axis=0),
        goal_turns=None if turns is None else np.repeat(turns, count, axis=0),
    )
