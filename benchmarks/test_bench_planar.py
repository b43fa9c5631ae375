"""Times of the 2D solver beside the 3D one on the same joints.

pytest benchmarks/test_bench_planar.py --benchmark-enable
"""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D

POLE = (10.0, 80.0, 15.0)


def limb(joints: int, limited: bool) -> Chain:
    """A straight limb of bones of 20 to 35."""
    span = (-140.0, 0.0) if limited else None
    return Chain(
        [
            Joint.degrees(
                f"j{k}", (0.0, 0.0, 20.0 + 5 * (k % 4) if k else 0.0), pitch=span if k else None
            )
            for k in range(joints)
        ]
    )


def goals(chain: Chain, count: int) -> Any:
    """Goals all round, from 30 % to 90 % of the reach."""
    chance = np.random.default_rng(7)
    ways = chance.normal(size=(count, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    return ways * chance.uniform(0.3, 0.9, (count, 1)) * chain.length


def solver(kind: str, chain: Chain) -> Solver:
    return Solver2D(chain, pole=POLE) if kind == "2d" else Solver(chain)


@pytest.mark.parametrize("limited", [False, True], ids=["free", "limited"])
@pytest.mark.parametrize("joints", [3, 4, 8, 24])
@pytest.mark.parametrize("kind", ["2d", "3d"])
def test_solve_many(benchmark: Any, kind: str, joints: int, limited: bool) -> None:
    chain = limb(joints, limited)
    ready, points = solver(kind, chain), goals(chain, 1000)
    ready.solve_many(points[:2])

    found = benchmark(ready.solve_many, points, threads=1)
    assert np.isfinite(found.angles).all()


@pytest.mark.parametrize("kind", ["2d", "3d"])
def test_one_solve_from_python(benchmark: Any, kind: str) -> None:
    chain = limb(4, False)
    ready, point = solver(kind, chain), goals(chain, 1)[0]
    ready.solve(point)

    found = benchmark(ready.solve, point)
    assert np.isfinite(found.angles).all()
