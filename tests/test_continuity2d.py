"""How far joints turn in 2D when the goal moves by one degree, away from singular places."""

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.motion import turn_between
from limbik.core.rotation import hpb_to_matrix
from limbik.core.solver2d import Solver2D
from limbik.tests.limbs import REGISTRY, Array

COUNT = 3000


def limb(limited: bool) -> Chain:
    """A straight limb of four joints."""
    span = (-140.0, 0.0) if limited else None
    joints = [Joint.degrees("j0")]
    joints += [Joint.degrees(f"j{k}", (0, 0, 20.0 + 5 * k), pitch=span) for k in range(1, 4)]
    return Chain(joints)


def ways(chance: np.random.Generator) -> Array:
    found = chance.normal(size=(COUNT, 3))
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def angle(a: Array, b: Array) -> Array:
    """Between unit vectors [deg]."""
    return np.asarray(np.degrees(np.arccos(np.clip((a * b).sum(axis=-1), -1.0, 1.0))))


@pytest.mark.parametrize("limited", [False, True], ids=["unlimited", "limited"])
@pytest.mark.parametrize(
    ("axis", "from_pole", "from_rest"),
    [("y+", 15.0, 180.0), ("x-", 15.0, 180.0), ("free", 42.0, 120.0)],
)
def test_one_degree_turns_no_joint_by_more_than_five(
    axis: str, from_pole: float, from_rest: float, limited: bool
) -> None:
    """Singular are the pole's line, where the plane spins; for the free axis also what lies behind.

    There the shortest turn from the resting line has no one axis, and near the pole's line both
    add up.
    """
    chain, chance = limb(limited), np.random.default_rng(3)
    first, side, pole = ways(chance), ways(chance), ways(chance)
    side -= first * (side * first).sum(axis=1, keepdims=True)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    second = np.cos(np.radians(1.0)) * first + np.sin(np.radians(1.0)) * side
    far = chance.uniform(0.3, 0.9, (COUNT, 1)) * chain.length

    solver = Solver2D(chain, registry=REGISTRY, pole=(0.0, 80.0, 0.0), reference_axis=axis)
    one, two = (solver.solve_many(way * far, poles=80.0 * pole) for way in (first, second))
    turns = np.degrees(turn_between(hpb_to_matrix(one.angles), hpb_to_matrix(two.angles)))

    off = angle(first, pole)
    regular = (np.minimum(off, 180.0 - off) > from_pole) & (angle(first, np.eye(3)[2]) < from_rest)
    assert regular.sum() > COUNT / 3
    assert turns[regular].max() <= 5.0
