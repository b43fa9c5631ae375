"""Does a chain have the shape a solver is made for? If not, say which joint and what is right."""

import numpy as np

from limbik.core.chain import AXES, Chain
from limbik.core.errors import ChainError
from limbik.core.rotation import Array

SAME = 1e-6  # largest difference of entries of matrices that count as equal


def require_count(chain: Chain, count: int, solver: str) -> None:
    """Refuse a chain of another length.

    Raises:
        ChainError: It does not have `count` joints.
    """
    if len(chain) != count:
        raise ChainError(f"{solver} solves chains of {count} joints, this one has {len(chain)}")


def require_axes(chain: Chain, joint: int, turning: tuple[int, ...], solver: str) -> None:
    """Refuse a joint that turns about other axes than a solver uses.

    Raises:
        ChainError: An axis that is not in `turning` is not fixed at 0.
    """
    for axis in range(3):
        fixed = chain.low[joint, axis] == 0.0 == chain.high[joint, axis]
        if axis not in turning and not fixed:
            raise ChainError(
                f"{solver} does not turn its {AXES[axis]}: write `{AXES[axis]}: 0`",
                chain.names[joint],
            )


def require_offset(chain: Chain, joint: int, axis: int, solver: str) -> float:
    """Return how far a joint lies from the one before, along one of its axes.

    Raises:
        ChainError: It lies off that axis, or not on its positive side.
    """
    offset = chain.offsets[joint]
    across = np.delete(offset, axis)
    if abs(across).max() > SAME * abs(offset).max() or not offset[axis] > 0.0:
        shape = ["0", "0", "0"]
        shape[axis] = "length"
        raise ChainError(
            f"{solver} needs an offset [{', '.join(shape)}] (found {offset.tolist()})",
            chain.names[joint],
        )
    return float(offset[axis])


def is_frozen(chain: Chain, joint: int, matrix: Array) -> bool:
    """Whether a joint's frozen rotation is a given one."""
    return bool(abs(chain.frozen[joint] - matrix).max() < SAME)


def require_frozen(chain: Chain, joint: int, matrix: Array, shown: str, solver: str) -> None:
    """Refuse a joint with another frozen rotation.

    Raises:
        ChainError: It is not `matrix`, in words `shown`.
    """
    if not is_frozen(chain, joint, matrix):
        raise ChainError(f"{solver} needs `frozen: {shown}`", chain.names[joint])
