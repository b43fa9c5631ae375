"""Solve the goals of a scene."""

from collections.abc import Iterator, Sequence

import numpy as np

from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.solution import Solution, Status
from limbik.core.solver import Solver
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
    solver = Solver(scene.chain, scene.settings, registry)
    if not trace:
        many = solver.follow if scene.follow else solver.solve_many
        return list(_singles(many(scene.goals, fk_offsets=scene.fk_offsets)))
    solutions: list[Solution] = []
    for goal in scene.goals:
        before = solutions[-1].continuity if scene.follow and solutions else None
        solutions.append(
            solver.solve(goal, fk_offsets=scene.fk_offsets, continuity=before, trace=True)
        )
    return solutions


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
