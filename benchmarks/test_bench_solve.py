"""How long solves take; `pytest benchmarks --benchmark-enable --benchmark-only`.

Each benchmark also checks what it measured, so that a wrong answer is not a fast one.
"""

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from limbik.core.body import BodySolver
from limbik.core.bodyscene import read_body
from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.solver import Solver
from limbik.tests.limbs import ARM_OPTIONS, arm, ball, reachable

REGISTRY = Registry(third_party=False)
BASE: dict[str, Any] = {"tolerance": 1e-12, "max_iterations": 20, "finish": "none"}


def bound(chain: Chain, **options: Any) -> Solver:
    return Solver(chain, Settings(**options), REGISTRY)


def goals(count: int) -> Array:
    return reachable(arm(), count, 12)


def test_solve_of_an_arm_with_20_rounds(benchmark: BenchmarkFixture) -> None:
    """From Python, one goal, a tolerance nothing meets: all 20 rounds are run."""
    solver = bound(arm(), **BASE, **ARM_OPTIONS)
    goal = goals(1)[0]
    solution = benchmark(solver.solve, goal)
    assert solution.iterations == 20


def test_solve_of_an_arm_with_the_defaults(benchmark: BenchmarkFixture) -> None:
    solver = bound(arm(), **ARM_OPTIONS)
    solution = benchmark(solver.solve, goals(1)[0])
    assert solution.reached


def test_solve_many_of_10000_goals(benchmark: BenchmarkFixture) -> None:
    """With the defaults, on all cores."""
    solver = bound(arm(), **ARM_OPTIONS)
    wanted = goals(10_000)
    many = benchmark(solver.solve_many, wanted)
    assert np.mean(many.reached) > 0.99


def test_solve_of_a_ball_chain(benchmark: BenchmarkFixture) -> None:
    solver = bound(ball(20.0, 20.0, 20.0), **BASE)
    solution = benchmark(solver.solve, (12.0, 9.0, 30.0))
    assert solution.distance < 1e-7


def test_solve_of_a_body(benchmark: BenchmarkFixture) -> None:
    """From Python, one frame of a humanoid: spine, two arms, two legs, all 33 joints placed."""
    scene = read_body(Path(__file__).parents[1] / "configs" / "body.yaml")
    solver = BodySolver.of(scene)
    wanted = {name: places[0] for name, places in scene.goals.items()}
    found = benchmark(solver.solve, wanted)
    assert found.reached


def test_building_a_chain_and_a_solver(benchmark: BenchmarkFixture) -> None:
    joints = [Joint(f"j{k}", (0.0, 0.0, 1.0)) for k in range(4)]
    solver = benchmark(lambda: bound(Chain(joints), **BASE))
    assert len(solver.chain) == 4


@pytest.mark.parametrize("module", ["limbik", "limbik.core.solver"])
def test_import(benchmark: BenchmarkFixture, module: str) -> None:
    """A fresh interpreter, its own start included."""
    command = [sys.executable, "-c", f"import {module}"]
    done = benchmark(subprocess.run, command, check=True)
    assert done.returncode == 0
