"""What a file format is to limbik: a scene input, an output, or both; offered by plug-ins (K-02).

Core knows no format by its name. A scene input reads a file of its kind into a `Body`: a chain
and, if the file holds a motion, goals. An output writes a `Bake`: a scene with its solved path.
Everything here is in limbik's axes; a format turns what it reads and writes with
`limbik.core.frames`.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain
from limbik.core.frames import mirror_hpb
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.settings import Model

if TYPE_CHECKING:
    from limbik.core.bodyscene import BodyScene
    from limbik.core.scene import Scene
    from limbik.core.skeleton import Skeleton
    from limbik.core.solution import Solution


@dataclass(frozen=True, eq=False)
class Motion:
    """A skeleton that moves: m frames of n joints, parents before their children.

    Attributes:
        names: n names.
        parents: Index of each joint's parent; -1 for a root, which stands in the world.
        offsets: Positions in the parent's frame, (m, n, 3) [length].
        turns: Rotations in the parent's frame, (m, n, 3, 3).
        zero: The same in the zero pose, (n, 3, 3).
        frame_time: Seconds a frame.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array
    turns: Array
    zero: Array
    frame_time: float

    @property
    def first(self) -> "Motion":
        """The first frame alone."""
        return replace(self, offsets=self.offsets[:1], turns=self.turns[:1])

    def world(self) -> tuple[Array, Array]:
        """Return world positions (m, n, 3) and rotations (m, n, 3, 3)."""
        positions, rotations = self.offsets.copy(), self.turns.copy()
        for joint, parent in enumerate(self.parents):
            if parent >= 0:
                turned = rotations[:, parent]
                moved = (turned @ self.offsets[:, joint, :, None])[..., 0]
                positions[:, joint] = positions[:, parent] + moved
                rotations[:, joint] = turned @ self.turns[:, joint]
        return positions, rotations


@dataclass(frozen=True, eq=False)
class Body:
    """What a scene input makes of its file; a format may extend it.

    Attributes:
        chain: The chain.
        notes: What the user should know, one sentence each.
        goals: Positions the end passes in the file's own motion, (m, 3) [length]; None if it
            holds no motion.
        goal_names: m names.
        frame_time: Seconds a frame of that motion.
        goal_turns: How the end is turned there, HPB, (m, 3) [rad].
    """

    chain: Chain
    notes: tuple[str, ...] = ()
    goals: Array | None = None
    goal_names: tuple[str, ...] = ()
    frame_time: float | None = None
    goal_turns: Array | None = None

    def motion(self, angles: Array, frame_time: float) -> Motion:
        """Return the whole skeleton's motion for the chain's angles, HPB (m, n, 3) [rad]."""
        return chain_motion(self.chain, angles, frame_time)

    def turning_end(self) -> Self:
        """Return the body for a solver that turns the end to its goals, if the file lets it."""
        return self

    def values(self, angles: Array) -> "Values | None":
        """Return what the model itself calls its joints' values, if it has its own."""
        return None


@dataclass(frozen=True, eq=False)
class Values:
    """Values of a model's own joints.

    Attributes:
        names: k names, as in the model's file.
        unit: Unit of the values.
        rows: (m, k).
    """

    names: tuple[str, ...]
    unit: str
    rows: Array | NDArray[np.int64]


@dataclass(frozen=True)
class Inspection:
    """What a file holds, for people: a table of joints and chains one could solve.

    Attributes:
        title: One line about the whole.
        columns: Titles of the table.
        rows: Its lines.
        chains: Candidate chains: base, end, what the chain is made of.
        notes: What else is worth knowing.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    chains: tuple[tuple[str, str, str], ...]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class SkeletonInput:
    """How a kind of file gives a whole skeleton.

    Attributes:
        model: What the `skeleton` mapping of a scene may hold.
        read: Makes a skeleton of a checked model, as the scene input's `read` makes a body.
    """

    model: type[Model]
    read: "Callable[[Any, Path], Skeleton]"


@dataclass(frozen=True)
class SceneInput:
    """A kind of file a chain can come from.

    Attributes:
        name: The key that chooses it in a scene's `chain` mapping, such as `urdf`.
        suffixes: Endings of its files, such as `.urdf`.
        model: What else the `chain` mapping may hold; has a field called `name` for the file.
        read: Makes a body of a checked model; relative paths start from the folder given. Raises
            InputError; a fault without a file is pointed at the model's key of that name.
        inspect: Says what a file holds. Raises InputError.
        description: One sentence.
        has_goals: Whether its files may hold the goals, so that a scene needs none.
        skeleton: How such files give the skeleton of a scene with several chains; None if they
            give single chains only.
    """

    name: str
    suffixes: tuple[str, ...]
    model: type[Model]
    read: Callable[[Any, Path], Body]
    inspect: Callable[[Path], Inspection]
    description: str = ""
    has_goals: bool = False
    skeleton: "SkeletonInput | None" = None


@dataclass(frozen=True, eq=False)
class Bake:
    """A scene with its solved path, to be written.

    Attributes:
        scene: The scene.
        solution: All goals in order, with a leading goal axis; mirrored if `mirrored`.
        frame_time: Seconds from goal to goal.
        mirrored: Whether left and right are exchanged.
        metrics: What the motion is like, see `limbik.core.motion`.
        servos: What servos are told, where that is asked for.
    """

    scene: "Scene"
    solution: "Solution"
    frame_time: float
    mirrored: bool = False
    metrics: dict[str, Any] = field(default_factory=dict)
    servos: Values | None = None

    @property
    def body(self) -> Body:
        """The body the chain came from."""
        return self.scene.body or Body(self.scene.chain)

    @property
    def goal_turns(self) -> Array | None:
        """How the goals are turned, HPB, (m, 3) [rad], mirrored if `mirrored`; see `Scene`."""
        turns = self.scene.goal_turns
        return turns if turns is None or not self.mirrored else mirror_hpb(turns)


@dataclass(frozen=True, eq=False)
class BodyBake:
    """A scene of several chains with its solved motion, to be written.

    Attributes:
        scene: The scene.
        solutions: Of each chain by its name, in the scene's order, all frames in order with a
            leading goal axis; mirrored if `mirrored`, and named for their new side.
        motion: The whole skeleton, solved, before a mirror.
        frame_time: Seconds from frame to frame.
        mirrored: Whether left and right are exchanged.
        metrics: Of each chain by its name, see `Bake`.
        goal_turns: How the goals of chains that turn by them are turned in the world, HPB, (m, 3)
            [rad], by the names of `solutions`; mirrored if `mirrored`.
    """

    scene: "BodyScene"
    solutions: "dict[str, Solution]"
    motion: Motion
    frame_time: float
    mirrored: bool = False
    metrics: dict[str, dict[str, Any]] = field(default_factory=dict)
    goal_turns: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True)
class Output:
    """A kind of file a baked motion can be written to.

    Attributes:
        name: Its name, such as `csv`.
        suffixes: Endings of its files that choose it, such as `.csv`.
        write: Gives the content of the whole file. Raises InputError if the motion does not fit.
        description: One sentence.
        write_body: The same for scenes of several chains; None if such files hold one chain.
        servos: Whether its files hold what servos are told.
    """

    name: str
    suffixes: tuple[str, ...]
    write: Callable[[Bake], str | bytes]
    description: str = ""
    write_body: Callable[[BodyBake], str | bytes] | None = None
    servos: bool = False


FORMAT_HOOKS: dict[str, tuple[str, type]] = {
    "scene_input": ("limbik_scene_inputs", SceneInput),
    "output": ("limbik_outputs", Output),
}
"""The kinds of formats: name of the hook that offers them, and what it must return."""


def format_fault(kind: str, offered: Any) -> str:
    """Say what is wrong with an offered format, or nothing.

    Args:
        kind: Key of `FORMAT_HOOKS`.
        offered: What the plug-in's hook returned.
    """
    hook, expected = FORMAT_HOOKS[kind]
    if not isinstance(offered, SceneInput | Output) or not isinstance(offered, expected):
        return f"{hook} must return {expected.__name__} objects, not {type(offered).__name__}"
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", offered.name):
        return f"the name '{offered.name}' must be lower-case words joined by underscores"
    odd = [suffix for suffix in offered.suffixes if not re.fullmatch(r"(\.[a-z0-9]+)+", suffix)]
    if odd:
        return f"the ending '{odd[0]}' must be a dot and lower-case letters, like '.csv'"
    if isinstance(offered, SceneInput) and offered.name not in offered.model.model_fields:
        return f"its model needs a field '{offered.name}' for the path of the file"
    return ""


def chain_motion(chain: Chain, angles: Array, frame_time: float) -> Motion:
    """Return the motion of a chain that stands alone.

    Args:
        chain: n joints.
        angles: HPB [rad], (m, n, 3).
        frame_time: Seconds a frame.
    """
    turns = chain.frozen @ hpb_to_matrix(angles)
    turns[:, 0] = chain.base_rotation @ turns[:, 0]
    zero = chain.frozen.copy()
    zero[0] = chain.base_rotation @ zero[0]
    offsets = np.repeat(chain.offsets[None], len(angles), axis=0)
    offsets[:, 0] = chain.base_position + chain.base_rotation @ chain.offsets[0]
    parents = tuple(range(-1, len(chain) - 1))
    return Motion(chain.names, parents, offsets, turns, zero, frame_time)
