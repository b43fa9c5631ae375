"""Solvers, chains and solutions go to other processes and come back as they were."""

import copy
import pickle
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik import BodySolver, Chain, Joint, PoseSolver, Solver, Solver2D, read_body
from limbik.core.registry import Registry

ROOT = Path(__file__).parents[1]
GOAL = (20.0, 10.0, 35.0)
ARM = Chain(
    [
        Joint.degrees("shoulder", heading=(-130, 60), pitch=(-85, 85), bank=(-90, 90)),
        Joint.degrees("elbow", offset=(0, 0, 30), heading=(0, 0), pitch=(0, 145), bank=(-80, 80)),
        Joint.degrees("hand", offset=(0, 0, 26), heading=(0, 0), pitch=(0, 0), bank=(0, 0)),
    ]
)
CONES = Chain(
    [
        Joint("hip", limit={"use": "cone", "swing": (60, 35)}),
        Joint("knee", offset=(0.0, 0.0, 30.0)),
        Joint("foot", offset=(0.0, 0.0, 30.0)),
    ]
)
SPATIAL: dict[str, Callable[[], Any]] = {
    "3d": lambda: Solver(ARM),
    "cone": lambda: Solver(CONES),
    "2d": lambda: Solver2D(ARM, pole=(0.0, 10.0, 10.0)),
}
WAYS: tuple[Callable[[Any], Any], ...] = (
    lambda value: pickle.loads(pickle.dumps(value)),
    copy.deepcopy,
    copy.copy,
)


@pytest.mark.parametrize("way", WAYS, ids=["pickle", "deepcopy", "copy"])
@pytest.mark.parametrize("kind", SPATIAL)
def test_a_solver_that_has_solved_comes_back(kind: str, way: Callable[[Any], Any]) -> None:
    solver = SPATIAL[kind]()
    before = solver.solve(GOAL)
    after = way(solver).solve(GOAL)
    assert np.array_equal(before.angles, after.angles)
    again = way(before)
    assert np.array_equal(before.angles, again.angles)
    assert again.limits_touched() == before.limits_touched()


def test_pose_and_body_solvers_are_pickled() -> None:
    axes: dict[str, Any] = {"heading": (0.0, 0.0), "pitch": (-1.5, 1.5), "bank": (-2.0, 2.0)}
    arm = PoseSolver(Chain([Joint(f"j{k}", offset=(0.0, 0.0, 9.0), **axes) for k in range(4)]))
    body = BodySolver.of(read_body(ROOT / "configs" / "body.yaml"))
    goals = {"spine": (0.2, 0.77, 0.0)}
    for way in WAYS[:2]:
        assert np.array_equal(way(arm).solve(GOAL).angles, arm.solve(GOAL).angles)
        assert np.array_equal(way(body).solve(goals).positions, body.solve(goals).positions)


@pytest.mark.parametrize("way", WAYS, ids=["pickle", "deepcopy", "copy"])
def test_a_copied_chain_is_as_frozen_as_the_first(way: Callable[[Any], Any]) -> None:
    chain = way(ARM)
    assert chain.names == ARM.names
    with pytest.raises(ValueError, match="read-only"):
        chain.offsets[0] = 1.0


def test_a_registry_is_pickled_with_what_it_was_told() -> None:
    import limbik.plugins.finish.none as module

    registry = Registry(third_party=False, block=["bend_vector.auto", "finish.none"])
    registry.register(module, "mine")
    found = pickle.loads(pickle.dumps(registry))
    assert "auto" not in found.strategies("bend_vector")
    assert found.find("finish", "none").plugin.name == "mine"


def test_another_process_gives_the_same() -> None:
    solver = Solver(ARM)
    code = (
        "import pickle, sys; solver = pickle.load(sys.stdin.buffer);"
        f"sys.stdout.buffer.write(solver.solve({GOAL}).angles.tobytes())"
    )
    command = [sys.executable, "-c", code]
    run = subprocess.run(command, input=pickle.dumps(solver), capture_output=True, check=True)
    assert run.stdout == solver.solve(GOAL).angles.tobytes()
