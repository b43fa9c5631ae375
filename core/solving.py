"""Solve the goals of a scene."""

from collections.abc import Sequence
from typing import Any

from limbik.core.posegoals import WholeSolver, solve_turned
from limbik.core.registry import Registry
from limbik.core.scene import Scene, require_goals
from limbik.core.solution import Continuity, Solution
from limbik.core.solveinput import expected
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.core.whole import prepare


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
        SceneError: The scene has no goals, only a trajectory.
    """
    require_goals(expected(scene, Scene, "scene"))
    if scene.solver is not None or not trace:
        found = solve_goals(scene, registry)
        return [found.single(row) for row in range(len(scene.goals))]
    solver = scene_solver(scene, registry)
    solutions: list[Solution] = []
    for row, goal in enumerate(scene.goals):
        before = solutions[-1].continuity if scene.follow and solutions else None
        asked: dict[str, Any] = {"fk_offsets": scene.fk_offsets, "continuity": before}
        if scene.goal_turns is not None:
            asked["goal_turn"] = scene.goal_turns[row]
        solutions.append(solver.solve(goal, trace=True, **asked))
    return solutions


def solve_goals(
    scene: Scene, registry: Registry | None = None, threads: int | None = None
) -> Solution:
    """Solve every goal of a scene as `solve_scene` does, into one solution of arrays.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new `Registry()` if absent.
        threads: How many to use where goals do not follow; None for as many as there are cores.

    Returns:
        A solution with a leading goal axis.

    Raises:
        PluginError: A strategy failed.
    """
    if scene.solver is not None:
        batch = prepare(scene.solver, scene.chain, scene.settings)
        return solve_turned(batch, scene.goals, scene.goal_turns, scene.follow)
    return solve_part(scene_solver(scene, registry), scene, slice(None), threads=threads)


def solve_part(
    solver: Solver,
    scene: Scene,
    part: slice,
    continuity: Continuity | None = None,
    threads: int | None = None,
) -> Solution:
    """Solve some goals of a scene at once, as a path if the scene says so.

    Args:
        solver: The scene's.
        scene: The scene.
        part: Which goals.
        continuity: Of the goal before them on a path.
        threads: As for `solve_goals`.

    Returns:
        A solution with a leading goal axis.
    """
    asked: dict[str, Any] = {"fk_offsets": scene.fk_offsets}
    if scene.goal_turns is not None:
        asked["goal_turns"] = scene.goal_turns[part]
    if scene.follow:
        return solver.follow(scene.goals[part], continuity=continuity, **asked)
    return solver.solve_many(scene.goals[part], threads=threads, **asked)


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


def single_solver(scene: Scene, registry: Registry | None = None) -> Solver | WholeSolver:
    """Return whatever solver a scene asks for, to be called goal by goal; see `scene_solver`."""
    if scene.solver is not None:
        return WholeSolver(scene.solver, scene.chain, scene.settings)
    return scene_solver(scene, registry)


def are_met(scene: Scene, solutions: Sequence[Solution]) -> bool:
    """Whether every goal is reached; with IK switched off none is pursued."""
    return not scene.settings.ik or all(solution.reached for solution in solutions)
