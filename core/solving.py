"""Solve the goals of a scene."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.solution import Continuity, Solution, Status
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.core.whole import WholeSolution, prepare


def solve_scene(
    scene: Scene, registry: Registry | None = None, trace: bool = False
) -> list[Solution]:
    """Solve every goal of a scene: on its own, or as a path if the scene says `follow`.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new `Registry()` if absent.
        trace: Whether the solutions keep every stage's pose; slower.

    Returns:
        One solution a goal, in the scene's order.

    Raises:
        PluginError: A strategy failed.
    """
    if scene.solver is not None:
        batch = prepare(scene.solver, scene.chain, scene.settings)
        return list(_singles(batch(scene.goals, scene.follow)))
    solver = scene_solver(scene, registry)
    if not trace:
        found = solve_part(solver, scene, slice(None))
        return [found.single(row) for row in range(len(scene.goals))]
    solutions: list[Solution] = []
    for row, goal in enumerate(scene.goals):
        before = solutions[-1].continuity if scene.follow and solutions else None
        asked: dict[str, Any] = {"fk_offsets": scene.fk_offsets, "continuity": before}
        if scene.goal_turns is not None:
            asked["goal_turn"] = scene.goal_turns[row]
        solutions.append(solver.solve(goal, trace=True, **asked))
    return solutions


def solve_part(
    solver: Solver, scene: Scene, part: slice, continuity: Continuity | None = None
) -> Solution:
    """Solve some goals of a scene at once, as a path if the scene says so.

    Args:
        solver: The scene's.
        scene: The scene.
        part: Which goals.
        continuity: Of the goal before them on a path.

    Returns:
        A solution with a leading goal axis.
    """
    asked: dict[str, Any] = {"fk_offsets": scene.fk_offsets}
    if scene.goal_turns is not None:
        asked["goal_turns"] = scene.goal_turns[part]
    if scene.follow:
        return solver.follow(scene.goals[part], continuity=continuity, **asked)
    return solver.solve_many(scene.goals[part], **asked)


def scene_solver(scene: Scene, registry: Registry | None = None) -> Solver:
    """Return the solver a scene asks for: 2D where it has a pole.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new `Registry()` if absent.

    Raises:
        InputError: The scene binds a rest pose that cannot stay.
    """
    if scene.pole is None:
        return Solver(scene.chain, scene.settings, registry)
    solver = Solver2D(scene.chain, scene.settings, registry, pole=scene.pole)
    return solver.bind() if scene.bind else solver


def are_met(scene: Scene, solutions: Sequence[Solution]) -> bool:
    """Whether every goal is reached; with IK switched off none is pursued."""
    return not scene.settings.ik or all(solution.reached for solution in solutions)


def _singles(many: Solution) -> Iterator[Solution]:
    """Take a solution with a leading goal axis apart."""
    for k in range(len(many.goal)):
        notes = many.notes[k] if isinstance(many, WholeSolution) else ""
        yield WholeSolution(
            many.chain,
            many.goal[k],
            many.angles[k],
            many.positions[k],
            many.rotations[k],
            int(np.asarray(many.iterations)[k]),
            float(np.asarray(many.distance)[k]),
            Status(int(np.asarray(many.status)[k])),
            many.bend_vector[k],
            float(np.asarray(many.bend_angle)[k]),
            notes=notes,
        )
