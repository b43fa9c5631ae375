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
axes: limbik                   # optional: y-up or z-up if positions are right-handed
judge: {rate: 60, max: {pops: 0}}                   # optional, thresholds for `limbik judge`
solver: 3d                     # optional: 2d bends in the plane of base, goal and pole ...
pole: {position: [0, 9, 9]}    # ... which 2d needs; see `limbik.core.scenemodel.PoleModel`
goals:                         # a list, {csv: goals.csv}, {npz: motion.npz}; optional beside those
  - {name: mouth, position: [1, 2, 3]}
```

Instead of its joints a chain may name a file and a part of it, as the scene inputs of the plug-ins
define: `chain: {urdf: robot.urdf, base: torso, end: hand}`. A file with a motion brings goals too.
Scenes with several chains are read by `limbik.core.bodyscene`.

All faults of a file are found at once, each with line and column. Nothing here imports numba.
"""

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from limbik.core.binding import Bound
from limbik.core.chain import MAX_JOINTS, Chain, Joint
from limbik.core.chainfile import read_source
from limbik.core.choices import checkable, strategy_faults
from limbik.core.errors import ChainError, Fault, SceneError, shortlist
from limbik.core.formats import Body
from limbik.core.pole import Pole
from limbik.core.posegoals import PoseBatch
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scenegoals import file_axes_faults, goals_of, pole_of, taken_turns, twice
from limbik.core.scenemodel import JointModel, JudgeModel, SceneModel, SolveModel
from limbik.core.sceneoptions import option_faults, unknown_joints
from limbik.core.scenesolver import turn_faults
from limbik.core.settings import Settings
from limbik.core.slots import SOLVER
from limbik.core.trajectorymodel import TrajectoryModel
from limbik.core.validation import validation_faults
from limbik.core.whole import OWN_SOLVERS, prepare
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
    document, folder = open_scene(source)
    return scene_from(document, folder, registry)


def open_scene(source: str | Path) -> tuple[Document, Path]:
    """Read the YAML of a scene; give it with the folder its relative paths start from.

    Raises:
        SceneError: It is no YAML, or not of the kind limbik reads.
    """
    if str(source) == STDIN:
        return read_yaml(sys.stdin.buffer.read(MOST_BYTES + 1), "<stdin>"), Path()
    return read_yaml_file(source), Path(source).parent


def scene_from(document: Document, folder: Path, registry: Registry | None = None) -> Scene:
    """Make a scene of a YAML document that has been read.

    Args:
        document: The document.
        folder: Folder that relative paths in the scene start from.
        registry: As for `read_scene`.

    Raises:
        SceneError: With every fault that could be found.
    """
    content = document.content
    if isinstance(content, dict) and "chains" in content:
        message = "this scene has several chains; a scene with one 'chain' is needed here"
        raise SceneError([document.fault("chains", message, ("chains",), at_key=True)])
    faults: list[Fault] = list(strategy_faults(document, registry))
    source = read_source(document, folder, registry)
    faults += source.faults
    model = None
    try:
        model = SceneModel.model_validate(checkable(source.content))
    except ValidationError as error:
        faults += validation_faults(error, document, SceneModel)
    if model is None or faults:
        raise SceneError(shortlist(faults))

    if source.body is not None:
        return build_scene(document.title, model, document, folder, registry, source.body)
    joints = [joint.name for joint in model.chain.joints]
    faults += _joint_faults(joints, document)
    chain = None
    try:
        chain = _chain(model)
    except ChainError as error:
        faults += () if faults else _chain_faults(error, model, document)
    title = document.title
    return build_scene(title, model, document, folder, registry, None, chain, joints, faults)


def build_scene(
    title: str,
    model: SolveModel,
    document: Document,
    folder: Path,
    registry: Registry | None,
    body: Body | None,
    chain: Chain | None = None,
    joints: Sequence[str] = (),
    faults: Sequence[Fault] = (),
) -> Scene:
    """Make a scene of a checked model, or one chain of a scene with several.

    Args:
        title: Name of the scene.
        model: The model; it fits the document.
        document: Where the model came from.
        folder: Folder that relative paths start from.
        registry: As for `read_scene`.
        body: The chain, if it comes from elsewhere.
        chain: The chain, if it does not; None if it is at fault.
        joints: Names of the chain's joints, if it does not come from elsewhere.
        faults: What is wrong already.

    Raises:
        SceneError: With every fault that could be found.
    """
    chain, names = (body.chain, body.chain.names) if body else (chain, tuple(joints))
    found = [*faults, *unknown_joints(model.fk, names, ("fk",), document)]
    limited = [] if chain is None else [j.name for j in chain.joints if j.limit is not None]
    goals = goals_of(model, document, folder, title, body)
    found += option_faults(names, limited, model, goals, document)
    solver, turns_end = None, False
    try:
        if chain is not None and not found:
            solver, turns_end = _solver(model, chain, registry)
            found += turn_faults(model, turns_end, document)
    except ChainError as error:
        found += [document.placed(fault, ("solver",)) for fault in error.faults]
    turns = taken_turns(model, goals, turns_end)
    found += [*file_axes_faults(model, goals, turns, document), *goals.faults]
    if chain is None or found:
        raise SceneError(shortlist(found))
    if body is not None and turns is not None and (turns_end or model.options.end_orientation):
        body = body.turning_end()
    return Scene(
        title,
        chain,
        model.options,
        np.radians([model.fk.get(name, (0.0, 0.0, 0.0)) for name in names]),
        goals.names,
        goals.places,
        model.follow,
        document,
        model.judge,
        model.trajectory if isinstance(model, SceneModel) else None,
        body,
        solver,
        pole_of(model),
        model.pole is not None and model.pole.bind,
        turns,
    )


def require_goals(scene: Scene) -> None:
    """Refuse a scene that has a trajectory and no goals.

    Raises:
        SceneError: It has none.
    """
    if not len(scene.goals):
        hint = "'limbik trajectory' solves its trajectory"
        fault = scene.document.fault("missing-key", "the scene has no goals", hint=hint)
        raise SceneError([fault])


def _joint_faults(names: Sequence[str], document: Document) -> Iterator[Fault]:
    joints: KeyPath = ("chain", "joints")
    if not 2 <= len(names) <= MAX_JOINTS:
        message = f"a chain has 2 to {MAX_JOINTS} joints, this one has {len(names)}"
        yield document.fault("joint-count", message, joints)
    yield from twice(names, joints, "joint", document)


def _chain(model: SceneModel) -> Chain:
    base = model.chain.base
    turn = tuple(np.radians(base.rotation).tolist())
    return Chain([joint_of(joint) for joint in model.chain.joints], base.position, turn)


def _solver(
    model: SolveModel, chain: Chain, registry: Registry | None
) -> tuple[Bound | None, bool]:
    """Bind the scene's solver; it refuses chains it does not solve. Tell if it turns the end."""
    if model.solver in OWN_SOLVERS:
        return None, False
    bound = (registry or Registry()).bind(SOLVER.name, model.solver)
    return bound, isinstance(prepare(bound, chain, model.options), PoseBatch)


def joint_of(joint: JointModel) -> Joint:
    """Make a joint of its model."""
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
    return tuple(document.placed(fault, path) for fault in error.faults)
