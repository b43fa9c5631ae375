"""Read a scene: a YAML file becomes a chain, settings and goals, or a list of faults.

```yaml
limbik: 1                      # version of the format
chain:
  base: {position: [0, 0, 0], rotation: [0, 0, 0]}    # optional
  joints:                      # base first; the last one is the end
    - {name: shoulder, heading: [-130, 60], pitch: [-85, 85], bank: [-90, 90]}
    - {name: elbow, offset: [0, 0, 30], heading: 0, pitch: [0, 145], bank: [-80, 80]}
    - {name: wrist, offset: [0, 0, 26]}
solver: 3d                     # optional: a whole solver by name, such as lambda-leg
options: {max_iterations: 100, initial_bend: {use: nth-root}}    # optional, keys of Settings
fk: {elbow: [0, 15, 0]}        # optional FK offsets
follow: false                  # optional: solve the goals as a path
judge: {rate: 60, max: {pops: 0}}                   # optional, thresholds for `limbik judge`
solver: 3d                     # optional: 2d bends in the plane of base, goal and pole ...
pole: {position: [0, 9, 9]}    # ... which 2d needs; see `limbik.core.scenemodel.PoleModel`
goals:                         # a list, or {csv: goals.csv}
  - {name: mouth, position: [1, 2, 3]}
```

Instead of its joints a chain may name a file and a part of it, as the scene inputs of the plug-ins
define: `chain: {urdf: robot.urdf, base: torso, end: hand}`. A file with a motion brings goals too.

All faults of a file are found at once, each with line and column. Nothing here imports numba.
"""

import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from limbik.core.binding import Bound
from limbik.core.bodies import read_source
from limbik.core.chain import MAX_JOINTS, Chain, Joint
from limbik.core.errors import ChainError, Fault, InputError, SceneError, shortlist
from limbik.core.formats import Body
from limbik.core.goals import read_goals
from limbik.core.pole import Pole
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scenemodel import CsvModel, JointModel, JudgeModel, SceneModel
from limbik.core.sceneoptions import option_faults, unknown_joints
from limbik.core.settings import Settings
from limbik.core.slots import LIMIT, OPTIONS, SOLVER
from limbik.core.trajectorymodel import TrajectoryModel
from limbik.core.validation import validation_faults
from limbik.core.whole import BUILT_IN_3D, OWN_SOLVERS, prepare
from limbik.core.yamlfile import Document, KeyPath, read_yaml, read_yaml_file
from limbik.core.yamltext import MOST_BYTES

STDIN = "-"


@dataclass(frozen=True, eq=False, slots=True)
class Scene:
    """A scene that can be solved.

    Attributes:
        name: Name of the file without folder and ending.
        chain: The chain.
        settings: The options, angles in degrees.
        fk_offsets: FK offsets, HPB [rad], (n, 3); zeros where none are given.
        goal_names: m names.
        goals: World positions, (m, 3) [length].
        follow: Whether the goals are a path, each solved from the pose before it.
        document: The file with its positions, to point at a place later.
        judge: Rate and thresholds for judging the motion; None where the scene has none.
        trajectory: Key points and moves, if the scene has any.
        body: Where the chain came from, if from another file.
        solver: The whole solver chosen; None for limbik's own in 3D.
        pole: The pole of the 2D solver; None for the 3D solver.
        bind: Whether the 2D solver is bound to the rest pose.
        goal_turns: How the goals are turned, HPB, (m, 3) [rad]; NaN for goals without.
    """

    name: str
    chain: Chain
    settings: Settings
    fk_offsets: Array
    goal_names: tuple[str, ...]
    goals: Array
    follow: bool
    document: Document
    judge: JudgeModel | None = None
    trajectory: TrajectoryModel | None = None
    body: Body | None = None
    solver: Bound | None = None
    pole: Pole | None = None
    bind: bool = False
    goal_turns: Array | None = None

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know about a chain that came from another file."""
        if self.body is None:
            return ()
        across = np.linalg.norm(self.chain.offsets[1:, :2], axis=1)
        if (
            self.pole is not None
            or self.settings.off_axis
            or (across <= 1e-6 * self.chain.length).all()
        ):
            return self.body.notes
        note = "some bones lie off their joints' Z axes: set off_axis: true in the options"
        return (*self.body.notes, note)


def read_scene(source: str | Path, registry: Registry | None = None) -> Scene:
    """Read a scene file.

    Args:
        source: Path of the file, or `-` for standard input.
        registry: Where the strategies are looked up; a new `Registry()` if absent.

    Raises:
        SceneError: With every fault that could be found.
        PluginError: Two plug-ins offer a strategy of one name.
    """
    if str(source) == STDIN:
        document = read_yaml(sys.stdin.buffer.read(MOST_BYTES + 1), "<stdin>")
        return scene_from(document, Path(), registry)
    return scene_from(read_yaml_file(source), Path(source).parent, registry)


def scene_from(document: Document, folder: Path, registry: Registry | None = None) -> Scene:
    """Make a scene of a YAML document that has been read.

    Args:
        document: The document.
        folder: Folder that relative paths in the scene start from.
        registry: As for `read_scene`.

    Raises:
        SceneError: With every fault that could be found.
    """
    faults: list[Fault] = list(_strategy_faults(document, registry))
    source = read_source(document, folder, registry)
    faults += source.faults
    model = None
    try:
        model = SceneModel.model_validate(_checkable(source.content))
    except ValidationError as error:
        faults += validation_faults(error, document, SceneModel)
    if model is None or faults:
        raise SceneError(shortlist(faults))

    body = source.body
    joints = [joint.name for joint in model.chain.joints] if body is None else body.chain.names
    faults += _name_faults(joints, model, document)
    faults += option_faults(joints, model, document)
    chain, solver = body.chain if body else None, None
    try:
        chain = chain or _chain(model)
        solver = None if faults else _solver(model, chain, registry)
    except ChainError as error:
        faults += () if faults else _chain_faults(error, model, document)
    names, goals, goal_faults = _goals(model, document, folder)
    if body and body.goals is not None and "goals" not in document.content:
        names, goals = body.goal_names, body.goals
    faults += goal_faults
    if chain is None or faults:
        raise SceneError(shortlist(faults))
    offsets = np.radians([model.fk.get(name, (0.0, 0.0, 0.0)) for name in chain.names])
    title = Path(document.name).stem.strip("<>")
    pole = None
    if model.pole is not None:
        pole = Pole(position=model.pole.position, rotor=model.pole.rotor)
    return Scene(
        title,
        chain,
        model.options,
        offsets,
        names,
        goals,
        model.follow,
        document,
        model.judge,
        model.trajectory,
        body,
        solver,
        pole,
        model.pole is not None and model.pole.bind,
        _turns(model),
    )


def require_own_solver(scene: Scene, what: str) -> None:
    """Refuse a scene that chooses a solver of a plug-in, where only limbik's own will do.

    Raises:
        SceneError: It does.
    """
    if scene.solver is not None:
        message = f"{what} needs limbik's own solver, 3d, not '{scene.solver.name}'"
        raise SceneError([scene.document.fault("choice", message, (SOLVER.name,))])


def _turns(model: SceneModel) -> Array | None:
    """Return the goals' turns [rad], (m, 3); NaN for goals without one, None if no goal has."""
    if isinstance(model.goals, CsvModel) or not any(goal.rotation for goal in model.goals):
        return None
    return np.radians([goal.rotation or (np.nan, np.nan, np.nan) for goal in model.goals])


def _choices(content: Any) -> Iterator[tuple[KeyPath, str, Any]]:
    """Give place, slot and choice of every strategy a scene chooses, unchecked."""
    if not isinstance(content, dict):
        return
    if content.get(SOLVER.name, BUILT_IN_3D) not in OWN_SOLVERS:
        yield (SOLVER.name,), SOLVER.name, content[SOLVER.name]
    options = content.get("options")
    if isinstance(options, dict):
        yield from ((("options", slot), slot, options[slot]) for slot in OPTIONS if slot in options)
    chain = content.get("chain")
    joints = chain.get("joints") if isinstance(chain, dict) else None
    for number, joint in enumerate(joints if isinstance(joints, list) else ()):
        if isinstance(joint, dict) and LIMIT.name in joint:
            yield ("chain", "joints", number, LIMIT.name), LIMIT.name, joint[LIMIT.name]


def _checkable(content: Any) -> Any:
    """Leave out options without a strategy's name: `_strategy_faults` has them already."""
    nameless = [
        slot
        for place, slot, choice in _choices(content)
        if place[0] == "options"
        and isinstance(choice, dict)
        and not isinstance(choice.get("use"), str)
    ]
    if not nameless:
        return content
    options = {key: value for key, value in content["options"].items() if key not in nameless}
    return {**content, "options": options}


def _strategy_faults(document: Document, registry: Registry | None) -> Iterator[Fault]:
    """Check each chosen strategy and its parameters against the registry."""
    for place, slot, choice in _choices(document.content):
        if not isinstance(choice, str | dict):
            continue
        registry = registry or Registry()
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


def _name_faults(names: Sequence[str], model: SceneModel, document: Document) -> Iterator[Fault]:
    joints: KeyPath = ("chain", "joints")
    if not 2 <= len(names) <= MAX_JOINTS:
        message = f"a chain has 2 to {MAX_JOINTS} joints, this one has {len(names)}"
        yield document.fault("joint-count", message, joints)
    yield from _twice(names, joints, "joint", document)
    yield from unknown_joints(model.fk, names, ("fk",), document)


def _twice(
    names: Sequence[str | None], path: KeyPath, what: str, document: Document
) -> Iterator[Fault]:
    first: dict[str | None, int] = {}
    for index, name in enumerate(names):
        if name is not None and name in first:
            line, _ = document.position((*path, first[name], "name"))
            message = f"the {what} '{name}' is given twice, first at line {line}"
            yield document.fault("duplicate-name", message, (*path, index, "name"))
        first.setdefault(name, index)


def _chain(model: SceneModel) -> Chain:
    base = model.chain.base
    turn = tuple(np.radians(base.rotation).tolist())
    return Chain([_joint(joint) for joint in model.chain.joints], base.position, turn)


def _solver(model: SceneModel, chain: Chain, registry: Registry | None) -> Bound | None:
    """Bind the scene's solver; it refuses chains it does not solve."""
    if model.solver in OWN_SOLVERS:
        return None
    bound = (registry or Registry()).bind(SOLVER.name, model.solver)
    prepare(bound, chain, model.options)
    return bound


def _joint(joint: JointModel) -> Joint:
    return Joint.degrees(
        joint.name,
        joint.offset,
        joint.frozen,
        joint.rest,
        joint.heading,
        joint.pitch,
        joint.bank,
        joint.planar,
        limit=joint.limit,
    )


def _chain_faults(error: ChainError, model: SceneModel, document: Document) -> tuple[Fault, ...]:
    """Point what the chain itself refuses at the joint's line."""
    path: KeyPath = ("chain", "joints")
    for index, joint in enumerate(model.chain.joints):
        if joint.name == error.joint:
            path = (*path, index)
    return tuple(document.fault(f.code, f.message, path, hint=f.hint) for f in error.faults)


def _goals(
    model: SceneModel, document: Document, folder: Path
) -> tuple[tuple[str, ...], Array, list[Fault]]:
    """Give names, positions (m, 3) and faults of the goals, from the scene or its CSV file."""
    if isinstance(model.goals, CsvModel):
        path = folder / model.goals.csv
        table = read_goals(path, str(path))
        unreadable = [fault for fault in table.faults if not fault.line]
        for fault in unreadable:
            table.faults[table.faults.index(fault)] = document.fault(
                fault.code, f"{fault.file}: {fault.message}", ("goals", "csv")
            )
        return tuple(table.names), np.array(table.positions).reshape(-1, 3), table.faults
    given = [goal.name for goal in model.goals]
    faults = list(_twice(given, ("goals",), "goal", document))
    if not model.goals:
        message = "at least one goal is needed"
        faults.append(document.fault("empty", message, ("goals",)))
    names = tuple(name or str(number) for number, name in enumerate(given, 1))
    return names, np.array([goal.position for goal in model.goals]).reshape(-1, 3), faults
