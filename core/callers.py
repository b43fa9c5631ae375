"""Call a strategy by its address, from compiled code as from Python.

The arguments are those of the slot (`limbik.core.slots`), with the strategy's parameters as the
flat array `limbik.core.strategy.flatten` makes. A strategy that raises stops nothing: what it had
to write is filled with NaN, which the solve finds and reports.
"""

from math import nan

from limbik.core.compiler import invoker
from limbik.core.jit import entry
from limbik.core.kernels.own import ANGLES, STEP
from limbik.core.rotation import Array
from limbik.core.slots import (
    BANK_SUPPRESSION,
    BEND_VECTOR,
    FINISH,
    INITIAL_BEND,
    LIMIT,
    LIMIT_TASK,
    ROOT_CONTROL,
)

_initial_bend = invoker(INITIAL_BEND)
_bend_vector = invoker(BEND_VECTOR)
_root_control = invoker(ROOT_CONTROL)
_bank_suppression = invoker(BANK_SUPPRESSION)
_finish = invoker(FINISH)
_limit = invoker(LIMIT)
_limit_task = invoker(LIMIT_TASK)


@entry
def call_initial_bend(
    address: int,
    lengths: Array,
    reach_ratio: float,
    weights: Array,
    params_array: Array,
    angles: Array,
) -> None:
    """Let an initial-bend method write `angles` (m,) [rad]."""
    if not _initial_bend(address, (lengths, reach_ratio, weights, params_array, angles)):
        angles[:] = nan


@entry
def call_bend_vector(
    address: int,
    frame: Array,
    aim: Array,
    end_offset: Array,
    to_world: Array,
    bank: float,
    previous: Array,
    params_array: Array,
    out: Array,
) -> None:
    """Let a bend-vector mode write `out` (3,), IK space."""
    arguments = (frame, aim, end_offset, to_world, bank, previous, params_array, out)
    if not _bend_vector(address, arguments):
        out[:] = nan


@entry
def call_root_control(
    address: int,
    root: int,
    has_previous: int,
    previous: Array,
    params_array: Array,
    low: Array,
    high: Array,
) -> None:
    """Let a root control narrow `low` and `high` (n, 3) [rad]."""
    if not _root_control(address, (root, has_previous, previous, params_array, low, high)):
        low[:] = nan
        high[:] = nan


@entry
def call_bank_suppression(
    address: int,
    target: Array,
    current: Array,
    pitch: float,
    in_ccd: int,
    params_array: Array,
    delta: Array,
) -> None:
    """Let a bank suppression change `delta` (3,) [rad]."""
    if not _bank_suppression(address, (target, current, pitch, in_ccd, params_array, delta)):
        delta[:] = nan


@entry
def call_finish(
    address: int,
    goal: Array,
    tolerance: float,
    length: float,
    offsets: Array,
    frozen: Array,
    base_position: Array,
    base_rotation: Array,
    low: Array,
    high: Array,
    own: Array,
    reachable: int,
    params_array: Array,
    angles: Array,
    scratch: Array,
    verdict: Array,
) -> None:
    """Let a finish move `angles` (n, 3) [rad] to the goal."""
    chain = (offsets, frozen, base_position, base_rotation, low, high, own)
    work = (params_array, angles, scratch, verdict)
    if not _finish(address, (goal, tolerance, length, *chain, reachable, *work)):
        angles[:] = nan


@entry
def call_limit(address: int, angles: Array, params_array: Array, margin: Array) -> None:
    """Let a joint's limit pull `angles` (3,) [rad] inside and write its `margin` (1,) [rad]."""
    if not _limit(address, (angles, params_array, margin)):
        angles[:] = nan
        margin[:] = nan


@entry
def call_limit_task(address: int, task: int, row: Array) -> None:
    """Let a task be carried out on a joint with a limit of its own; `row` is IN/OUT."""
    if not _limit_task(address, (task, row, row)):
        # Number by number: an assignment to a slice takes a second to compile.
        row[ANGLES], row[STEP] = nan, nan
