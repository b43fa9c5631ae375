"""What goes into a solve, checked, and the arrays it writes into."""

from typing import NamedTuple, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from limbik.core.chain import LARGEST, Chain
from limbik.core.errors import ChainError, InputError
from limbik.core.rotation import Array
from limbik.core.settings import Settings, joint_tables
from limbik.core.wording import found_words, near_match

_NO_NUMBERS = "cSUMm"  # kinds numpy would turn into numbers: complex, texts, dates
T = TypeVar("T")


class Arrays(NamedTuple):
    """What a solve of m goals writes into."""

    angles: Array
    positions: Array
    rotations: Array
    numbers: Array
    trace: Array

    @classmethod
    def empty(cls, m: int, n: int, stages: int, columns: int) -> Self:
        """Make them for m goals of n joints."""
        angles, positions = np.empty((m, n, 3)), np.empty((m, n, 3))
        numbers, trace = np.empty((m, columns)), np.empty((stages, n, 3))
        return cls(angles, positions, np.empty((m, n, 3, 3)), numbers, trace)

    def part(self, rows: slice) -> Self:
        """Return views of some rows, all with the one trace."""
        return self._replace(
            angles=self.angles[rows],
            positions=self.positions[rows],
            rotations=self.rotations[rows],
            numbers=self.numbers[rows],
        )


def expected(value: object, kind: type[T], what: str) -> T:
    """Return a value that must be of a class.

    Raises:
        InputError: It is something else.
    """
    if not isinstance(value, kind):
        raise InputError(f"{what}: expected a {kind.__name__}, found {found_words(value)}")
    return value


def numbers(values: ArrayLike) -> Array | None:
    """Return values as a new contiguous float64 array, or None if they are no numbers."""
    try:
        given = np.asarray(values)
        if given.dtype.kind in _NO_NUMBERS:
            return None
        # A copy, always: compiled code is entered with writable, contiguous arrays only.
        return np.array(given, np.float64, order="C")
    except (TypeError, ValueError, OverflowError):
        return None


def checked(values: ArrayLike, shape: tuple[int | None, ...], what: str) -> Array:
    """Return values as a contiguous float64 array, or say what is wrong with them.

    Args:
        values: What was given.
        shape: What it must have; None for any length of the first axis.
        what: Its name in a message.

    Raises:
        InputError: The shape is another, or a number is not finite.
    """
    array = numbers(values)
    if array is None:
        raise InputError(f"{what}: expected numbers of shape {_shown(shape)}")
    expects_rows = shape[0] is None
    if array.ndim != len(shape) or array.shape[expects_rows:] != shape[expects_rows:]:
        raise InputError(f"{what}: expected shape {_shown(shape)}, found {array.shape}")
    # A few numbers are checked faster one by one than by numpy.
    few = array.ravel().tolist() if array.size < 16 else (array.min(), array.max())
    if not all(-LARGEST < value < LARGEST for value in few):
        raise InputError(f"{what}: every number must be finite and below {LARGEST:g} in size")
    return array


def checked_turns(values: ArrayLike, shape: tuple[int | None, ...]) -> Array:
    """Return turns of goals; a row of NaNs stands for a goal without one."""
    rows = numbers(values)
    if rows is None or rows.ndim != len(shape):
        return checked(values, shape, "goal turns")
    absent = np.isnan(rows).all(axis=-1, keepdims=True)
    found = checked(np.where(absent, 0.0, rows), shape, "goal turns")
    return np.where(absent, np.nan, found)


def with_turns(goals: Array, turns: ArrayLike) -> Array:
    """Return goals and how each is turned in one array, (m, 6)."""
    given = checked_turns(turns, (None, 3))
    if len(given) != len(goals):
        message = f"goal turns: expected {len(goals)}, one a goal, found {len(given)}"
        raise InputError(message)
    return np.hstack([goals, given])


def checked_memory(values: Array, joints: int) -> Array:
    """Return a copy of a continuity's numbers for a chain of so many joints."""
    memory = numbers(values)
    if memory is None or memory.ndim != 2:
        raise InputError("continuity: expected numbers of shape (n + 4, 3) for n joints")
    if memory.shape != (joints + 4, 3):
        message = f"it is of a chain of {len(memory) - 4} joints, this one has {joints}"
        raise InputError(f"continuity: {message}")
    if not np.isfinite(memory).all():
        raise InputError("continuity: every number must be finite")
    return memory


def _shown(shape: tuple[int | None, ...]) -> str:
    sizes = ["m" if size is None else str(size) for size in shape]
    return f"({', '.join(sizes)}{',' * (len(sizes) == 1)})"


def check_joints(chain: Chain, settings: Settings, first: int) -> None:
    """Refuse settings that name joints the chain does not have.

    Args:
        chain: The chain.
        settings: Of the solver.
        first: The first joint that may be the bend reference.

    Raises:
        ChainError: There is no such joint, or more are held than there are before the end.
    """
    if not first <= settings.bend_reference <= len(chain) - 1:
        raise ChainError(
            f"bend_reference {settings.bend_reference}: this chain of {len(chain)} joints "
            f"allows {first} to {len(chain) - 1}"
        )
    for path, table in joint_tables(settings):
        for name in table:
            if name not in chain.names:
                known = near_match(name, list(chain.names)) or f"known: {', '.join(chain.names)}"
                message = f"{'.'.join(path)}: no joint is called '{name}' ({known})"
                raise ChainError(message)
    held = settings.held.base + settings.held.end
    if held > len(chain) - 1:
        raise ChainError(
            f"held: {held} joints held, this chain has {len(chain) - 1} before its end"
        )
