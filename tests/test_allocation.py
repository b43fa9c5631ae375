"""A solve leaves nothing behind, and what it allocates does not grow with its goals or rounds."""

import gc
import tracemalloc
from typing import Any

import numpy as np

from limbik.core.solver import Solver
from limbik.tests.limbs import ARM_OPTIONS, arm, reachable, solver


def grown(run: Solver, goal: Any, count: int) -> int:
    """Return by how many bytes the traced memory grows over repeated solves."""
    gc.collect()
    tracemalloc.start()
    try:
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(count):
            run.solve(goal)
        gc.collect()
        return tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()


def test_repeated_solves_keep_no_memory() -> None:
    """3000 solves keep less than a number each; the first call under the tracer is not counted."""
    run = solver(arm(), **ARM_OPTIONS)
    goal = reachable(arm(), 1, 2)[0]
    grown(run, goal, 300)
    assert grown(run, goal, 3000) < 8 * 3000


def peak(run: Solver, goals: Any) -> int:
    """Return the most bytes a call had allocated at once."""
    run.solve_many(goals, threads=1)
    tracemalloc.start()
    try:
        run.solve_many(goals, threads=1)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_many_goals_need_their_results_and_nothing_else() -> None:
    """Angles, positions, rotations and 7 numbers of n joints: 8 (15 n + 7) bytes a goal."""
    run = solver(arm(), **ARM_OPTIONS)
    few, many = reachable(arm(), 100, 2), reachable(arm(), 1100, 2)
    a_goal = (peak(run, many) - peak(run, few)) / 1000
    results = 8 * (15 * len(arm()) + 7)
    assert results * 0.9 < a_goal < results + 8 * 12  # and masks and indices of the statuses


def test_more_rounds_need_no_more_memory() -> None:
    goals = reachable(arm(), 100, 2)
    short = peak(solver(arm(), tolerance=1e-12, max_iterations=1, **ARM_OPTIONS), goals)
    long = peak(solver(arm(), tolerance=1e-12, max_iterations=300, **ARM_OPTIONS), goals)
    assert abs(long - short) < 4096


def test_results_of_one_solve_are_not_overwritten_by_the_next() -> None:
    run = solver(arm(), **ARM_OPTIONS)
    goals = reachable(arm(), 2, 2)
    first = run.solve(goals[0])
    kept = first.angles.copy()
    run.solve(goals[1])
    np.testing.assert_array_equal(first.angles, kept)
