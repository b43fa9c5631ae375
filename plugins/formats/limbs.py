"""Limbs of a model's skeleton: chains whose angles give the turns of the model's own joints."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Self

from limbik.core.chain import Chain
from limbik.core.formats import Values
from limbik.core.rotation import Array
from limbik.core.skeleton import Limb, Skeleton, standing
from limbik.plugins.formats.joining import FIXED, Joined, ModelJoint, joined


@dataclass(frozen=True, eq=False)
class ModelLimb(Limb):
    """A limb with the way back to the model's joint values."""

    join: Joined = field(kw_only=True)
    unit: str = field(kw_only=True)

    def turning_end(self) -> Self:
        """Return the limb for a solver that turns the end, unless the model holds it fixed."""
        if self.join.slots[-1] == FIXED:
            return self
        return replace(self, turns_end=True, written=len(self.at))

    def values(self, angles: Array) -> Values | None:
        """Return the model's hinge values, where the model has some."""
        if not self.unit:
            return None
        names, rows = self.join.hinge_values(angles)
        return Values(names, self.unit, rows)


def model_limb(
    skeleton: Skeleton,
    models: Sequence[ModelJoint],
    at: Sequence[int],
    notes: tuple[str, ...] = (),
    unit: str = "",
) -> ModelLimb:
    """Make a limb of a model's joints, base first; the end keeps its turn, see `turning_end`.

    Args:
        skeleton: Where the limb belongs.
        models: n joints, the first without an offset.
        at: Index in the skeleton of each.
        notes: As in the limb.
        unit: Of the model's values; empty if it has none of its own.

    Raises:
        ChainError: They make no chain.
    """
    join = joined(models)
    before = skeleton.motion.zero[list(at)] @ join.frames @ join.shifted
    after = join.frames.transpose(0, 2, 1)
    chain = Chain(join.joints)
    limb = ModelLimb(
        chain,
        notes,
        at=tuple(at),
        before=before,
        after=after,
        written=len(at) - 1,
        join=join,
        unit=unit,
    )
    found = standing(skeleton, limb)
    assert isinstance(found, ModelLimb)
    return found
