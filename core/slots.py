"""The slots of a solve: the steps a strategy can fill, and what its kernel gets there.

All arrays are float64 and C-contiguous, all angles are in radians. A kernel writes into the
arrays marked OUT (or IN/OUT), returns None, raises nothing and answers the same for the same
arguments. `params` is an instance of the strategy's params class.

The functions that call a strategy from compiled code are offered here too, but loaded on first
use (they need the compiler): `call_initial_bend`, `call_bend_vector`, `call_root_control`,
`call_bank_suppression`, `call_finish`, `call_limit`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from limbik.core.kernels.own import WIDTH as OWN_WIDTH
from limbik.core.rotation import hpb_to_matrix
from limbik.core.strategy import MAX_PARAMS as MAX_PARAMS

if TYPE_CHECKING:
    from limbik.core.callers import call_bank_suppression as call_bank_suppression
    from limbik.core.callers import call_bend_vector as call_bend_vector
    from limbik.core.callers import call_finish as call_finish
    from limbik.core.callers import call_initial_bend as call_initial_bend
    from limbik.core.callers import call_limit as call_limit
    from limbik.core.callers import call_root_control as call_root_control

PASSED_OVER = "none"
"""A slot whose strategy has this name is passed over: a solve does not even call it."""

Kind = Literal["count", "number", "vector", "matrix", "matrices", "params"]
Sample = tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument of a slot's kernels.

    Attributes:
        name: Name every kernel must give it.
        kind: `count` (int), `number` (float), `vector` (1-D array),
            `matrix` (2-D array), `matrices` (3-D array), `params`.
        meaning: What it holds, with its shape and unit.
        written: Whether the kernel writes into it.
        infinite: Whether infinite values may be written.
    """

    name: str
    kind: Kind
    meaning: str
    written: bool = False
    infinite: bool = False


@dataclass(frozen=True, slots=True)
class Slot:
    """A step of the solve that a strategy fills.

    Attributes:
        name: Key in scenes and settings, such as `initial_bend`.
        hook: Name of the hook by which plug-ins offer strategies for it.
        arguments: What a kernel gets, in order.
        samples: Makes arguments to try a kernel with, `None` standing for the parameters.
    """

    name: str
    hook: str
    arguments: tuple[Argument, ...]
    samples: Callable[[], list[Sample]]

    @property
    def names(self) -> tuple[str, ...]:
        """The arguments' names, in order."""
        return tuple(argument.name for argument in self.arguments)


def _bend_samples() -> list[Sample]:
    """Kinds of limbs: three bones, a single one, one whose goal is on the root or out of reach."""
    return [
        (np.array([0.4, 0.35, 0.25]), 0.8, np.array([1.0, 0.9, 0.8]), None, np.zeros(3)),
        (np.array([1.0]), 0.5, np.array([1.0]), None, np.zeros(1)),
        (np.full(5, 0.2), 0.0, np.full(5, 1.0), None, np.zeros(5)),
        (np.array([0.5, 0.5]), 1.25, np.array([1.0, 1.0]), None, np.zeros(2)),
    ]


def _vector_samples() -> list[Sample]:
    """A root turned off its axes; one whose end is on the aim line, at the start of a motion."""
    frame = hpb_to_matrix([0.3, -0.4, 0.0])
    aim = np.ascontiguousarray(frame[:, 2])
    offset = np.array([0.02, -0.03, 0.1])
    previous = np.ascontiguousarray(frame[:, 1])
    forward, none = np.array([0.0, 0.0, 1.0]), np.zeros(3)
    return [
        (frame, aim, offset, hpb_to_matrix([-1.0, 0.2, 0.0]), 0.1, previous, None, np.zeros(3)),
        (np.eye(3), forward, none, np.eye(3), 0.0, none.copy(), None, np.zeros(3)),
    ]


def _root_samples() -> list[Sample]:
    """A free limb, and one whose limits differ on each axis and that has a previous pose."""
    free = np.full((3, 3), np.inf)
    bound = np.array([[1.0, 0.5, 0.2], [0.1, 2.5, 0.0], [3.0, 3.0, 3.0]])
    previous = np.array([[0.2, -0.1, 0.0], [0.05, 0.4, 0.0], [0.0, 1.0, 0.3]])
    return [
        (1, 0, np.zeros((3, 3)), None, -free, free.copy()),
        (1, 1, previous, None, -bound, bound.copy()),
        (0, 1, np.full((2, 3), 4.0), None, -bound[:2].copy(), bound[:2].copy()),
    ]


def _bank_samples() -> list[Sample]:
    """A turn in CCD with both vectors off the axis, and one along it in an earlier stage."""
    off = np.array([0.6, 0.0, 0.8])
    along = np.array([0.0, 0.0, 1.0])
    return [
        (off, along, 0.5, 1, None, np.array([0.1, -0.2, 0.3])),
        (along.copy(), along, -1.5, 0, None, np.array([0.0, 0.0, 1.0])),
        (-along, off, 0.0, 1, None, np.zeros(3)),
    ]


def _finish_samples() -> list[Sample]:
    """A limb with a hinge near its goal, and a free one that is folded on itself."""
    bound = np.array([[1.0, 1.0, 1.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
    low = -bound * np.array([[1.0], [0.0], [1.0]])
    free = np.full((3, 3), np.inf)
    offsets = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.8]])
    frozen = np.tile(np.eye(3), (3, 1, 1))
    angles = np.array([[0.1, -0.3, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.0]])
    folded = np.array([[0.0, 0.0, 0.0], [0.0, np.pi, 0.0], [0.0, 0.0, 0.0]])

    def sample(goal: list[float], low: Any, high: Any, angles: Any) -> Sample:
        place, base, rows = np.zeros(3), np.eye(3), np.zeros((3, 72))
        chain = (offsets, frozen, place, base, low, high)
        own = np.zeros((3, OWN_WIDTH))
        work = angles, rows, np.zeros(2)
        return (np.array(goal), 1e-3, 1.8, *chain, own, 1, None, *work)

    return [
        sample([0.3, 0.5, 1.5], low, bound, angles),
        sample([0.0, 0.0, 0.2], -free, free, folded),
    ]


def _limit_samples() -> list[Sample]:
    """A joint at its zero pose, far from it, upright, and turned all round."""
    turns = ([0.0, 0.0, 0.0], [1.5, -0.7, 2.5], [0.3, 0.5 * np.pi, 0.0], [np.pi, 0.0, -np.pi])
    return [(np.array(turn), None, np.zeros(1)) for turn in turns]


_PARAMS = Argument("params", "params", "the strategy's parameters, angles in radians")

INITIAL_BEND = Slot(
    "initial_bend",
    "limbik_initial_bends",
    (
        Argument("lengths", "vector", "(m,) bones from the bend root on, over their total [-]"),
        Argument("reach_ratio", "number", "distance root→goal over that total, may exceed 1 [-]"),
        Argument("weights", "vector", "(m,) factor of each bone's angle [-]"),
        _PARAMS,
        Argument("angles", "vector", "(m,) OUT: angle of each bone from root→goal [rad]", True),
    ),
    _bend_samples,
)

BEND_VECTOR = Slot(
    "bend_vector",
    "limbik_bend_vectors",
    (
        Argument("frame", "matrix", "(3, 3) axes of the bend root in the aim pose, IK space"),
        Argument("aim", "vector", "(3,) unit vector root→goal, IK space"),
        Argument("end_offset", "vector", "(3,) goal→end in the aim pose, IK space [length]"),
        Argument("to_world", "matrix", "(3, 3) axes of the IK space in the world, as columns"),
        Argument("bank", "number", "bank of the bend root in the aim pose less its rest [rad]"),
        Argument("previous", "vector", "(3,) bend vector of the previous solve, zeros if none"),
        _PARAMS,
        Argument("out", "vector", "(3,) OUT: bend vector, IK space, of any length", True),
    ),
    _vector_samples,
)

ROOT_CONTROL = Slot(
    "root_control",
    "limbik_root_controls",
    (
        Argument("root", "count", "index of the bend root"),
        Argument("has_previous", "count", "1 if there was a previous solve, else 0"),
        Argument("previous", "matrix", "(n, 3) previous (else rest) heading, pitch, bank [rad]"),
        _PARAMS,
        Argument("low", "matrix", "(n, 3) IN/OUT lower limits, -inf where free [rad]", True, True),
        Argument("high", "matrix", "(n, 3) IN/OUT upper limits, inf where free [rad]", True, True),
    ),
    _root_samples,
)

BANK_SUPPRESSION = Slot(
    "bank_suppression",
    "limbik_bank_suppressions",
    (
        Argument("target", "vector", "(3,) unit vector joint→goal, joint's frame"),
        Argument("current", "vector", "(3,) unit vector joint→end, joint's frame"),
        Argument("pitch", "number", "pitch of the joint [rad]"),
        Argument("in_ccd", "count", "1 in CCD rounds, 0 in the stages before"),
        _PARAMS,
        Argument("delta", "vector", "(3,) IN/OUT change of heading, pitch, bank [rad]", True),
    ),
    _bank_samples,
)

FINISH = Slot(
    "finish",
    "limbik_finishes",
    (
        Argument("goal", "vector", "(3,) world [length]"),
        Argument("tolerance", "number", "distance that counts as reached [length]"),
        Argument("length", "number", "sum of the bone lengths [length]"),
        Argument("offsets", "matrix", "(n, 3) joint positions in the parent's frame [length]"),
        Argument("frozen", "matrices", "(n, 3, 3) frozen rotations"),
        Argument("base_position", "vector", "(3,) world [length]"),
        Argument("base_rotation", "matrix", "(3, 3) axes of the IK space in the world"),
        Argument(
            "low", "matrix", "(n, 3) limits, -inf where free, those of held joints equal [rad]"
        ),
        Argument("high", "matrix", "(n, 3) limits, inf where free [rad]"),
        Argument("own", "matrix", "(n, 63) rows for `do_task` of joints with limits of their own"),
        Argument("reachable", "count", "0 if the bones cannot span the distance, else 1"),
        _PARAMS,
        Argument("angles", "matrix", "(n, 3) IN/OUT: CCD's heading, pitch, bank [rad]", True),
        Argument("scratch", "matrix", "(n, 72) IN/OUT to work in, of any content", True),
        Argument(
            "verdict",
            "vector",
            "(2,) OUT: 1 if all it knows was tried in vain, else 0; "
            "least distance it found, infinite unless it says [length]",
            True,
        ),
    ),
    _finish_samples,
)

LIMIT = Slot(
    "limit",
    "limbik_limits",
    (
        Argument(
            "angles",
            "vector",
            "(3,) IN/OUT heading, pitch, bank from the joint's zero pose, in any form; untouched "
            "if allowed, else an allowed turn near it [rad]",
            True,
        ),
        _PARAMS,
        Argument(
            "margin",
            "vector",
            "(1,) OUT: angle that was left to the nearest end of the limit, 0 or less outside, "
            "inf where there is none [rad]",
            True,
            True,
        ),
    ),
    _limit_samples,
)
"""A joint's own limit in place of ranges of heading, pitch and bank (M-08)."""

LIMIT_TASK = Slot(
    "limit_task",
    "",
    (
        Argument("task", "count", "what is to be done"),
        _PARAMS,
        Argument("row", "vector", "IN/OUT see `limbik.core.kernels.limit.do_task`", True),
    ),
    list,
)
"""limbik's own work on joints with limits, compiled apart; no plug-in fills it."""

OPTIONS: dict[str, Slot] = {
    slot.name: slot for slot in (INITIAL_BEND, BEND_VECTOR, ROOT_CONTROL, BANK_SUPPRESSION, FINISH)
}
"""The slots that are options of a solve."""

SLOTS: dict[str, Slot] = {**OPTIONS, LIMIT.name: LIMIT}
"""All that run compiled inside a solve: options, and the limits of joints."""

CALLED: dict[str, Slot] = {**SLOTS, LIMIT_TASK.name: LIMIT_TASK}
"""All that is called by address."""

SOLVER = Slot(
    "solver",
    "limbik_solvers",
    (
        Argument("chain", "params", "the chain"),
        Argument("settings", "params", "the options of the solve"),
        _PARAMS,
    ),
    list,
)
"""Not a step but a whole solve, in Python: see `limbik.core.whole`."""

HOOKED: dict[str, Slot] = {**SLOTS, SOLVER.name: SOLVER}
"""All that plug-ins can offer: the slots and whole solvers."""


def __getattr__(name: str) -> Any:
    """Load the callers on first use: they need the compiler, everything else here does not."""
    if name.startswith("call_") and name.removeprefix("call_") in CALLED:
        from limbik.core import callers

        return getattr(callers, name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
