"""Bake a scene: solve its goals as the frames of a motion and measure the motion (M-12)."""

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Any, Final

import numpy as np

from limbik.core.body import BodySolver, chain_solutions
from limbik.core.bodyscene import BodyScene
from limbik.core.formats import Bake, BodyBake, Motion
from limbik.core.frames import mirror_hpb
from limbik.core.mirror import mirrored_solution, side_swapped
from limbik.core.motion import motion_metrics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene, require_goals
from limbik.core.skeleton import Limb, Skeleton
from limbik.core.solution import OF_ALL, Solution
from limbik.core.solving import scene_solver, solve_goals, solve_part

BLOCK: Final = 500  # goals solved between two reports of progress
FRAME_TIME: Final = 1.0 / 30.0


def bake_scene(
    scene: Scene,
    registry: Registry | None = None,
    *,
    mirrored: bool = False,
    frame_time: float | None = None,
    progress: Callable[[int], None] | None = None,
) -> Bake:
    """Solve all goals of a scene in order.

    Args:
        scene: The scene; with `follow` each goal is solved from the pose before, else on its own.
        registry: Where the strategies are looked up; a new `Registry()` if absent.
        mirrored: Whether to exchange left and right in the result.
        frame_time: Seconds from goal to goal; that of the scene's clip, or 1/30, if absent.
        progress: Called with the number of goals solved so far.

    Raises:
        PluginError: A strategy failed.
        SceneError: The scene has no goals, only a trajectory.
    """
    require_goals(scene)
    if scene.solver is not None:
        solution = solve_goals(scene)
    else:
        solution = _joined(_blocks(scene, registry, progress))
    if mirrored:
        solution = mirrored_solution(solution)
    seconds = frame_time or (scene.body and scene.body.frame_time) or FRAME_TIME
    metrics = motion_metrics(solution)
    return Bake(scene, solution, seconds, mirrored, metrics.record())


def _blocks(
    scene: Scene, registry: Registry | None, progress: Callable[[int], None] | None
) -> list[Solution]:
    """Solve the goals block by block with limbik's own solver."""
    solver = scene_solver(scene, registry)
    parts: list[Solution] = []
    for start in range(0, len(scene.goals), BLOCK):
        part = slice(start, start + BLOCK)
        before = parts[-1].continuity if parts else None
        parts.append(solve_part(solver, scene, part, before))
        if progress is not None:
            progress(start + len(scene.goals[part]))
    return parts


def bake_body(
    scene: BodyScene,
    registry: Registry | None = None,
    *,
    mirrored: bool = False,
    frame_time: float | None = None,
    progress: Callable[[int], None] | None = None,
) -> BodyBake:
    """Solve all frames of a scene with several chains; as `bake_scene`."""
    solver = BodySolver.of(scene, registry)
    found = []
    for number, body in enumerate(solver.frames(scene.goals), 1):
        found.append(body)
        if progress is not None and (number % BLOCK == 0 or number == len(scene.frame_names)):
            progress(number)
    seconds = frame_time or scene.frame_time or FRAME_TIME
    solutions = {name: stacked(of) for name, of in chain_solutions(found).items()}
    turns = {name: np.stack([body.goal_turns[name] for body in found]) for name in body.goal_turns}
    chains = [(part.limb, solutions[part.name].angles) for part in scene.parts]
    motion = body_motion(scene.skeleton, chains, seconds)
    if mirrored:
        swapped = dict(zip(solutions, side_swapped(list(solutions)), strict=True))
        solutions = {swapped[name]: mirrored_solution(of) for name, of in solutions.items()}
        turns = {swapped[name]: mirror_hpb(of) for name, of in turns.items()}
    metrics = {name: motion_metrics(of).record() for name, of in solutions.items()}
    return BodyBake(scene, solutions, motion, seconds, mirrored, metrics, turns)


def body_motion(
    skeleton: Skeleton, chains: Sequence[tuple[Limb, Array]], frame_time: float
) -> Motion:
    """Return the motion of a whole skeleton, what is of no chain moving as it does by itself.

    Args:
        skeleton: The skeleton.
        chains: Limb and HPB angles, (m, n, 3) [rad], in the order they were solved.
        frame_time: Seconds a frame.
    """
    motion = skeleton.motion
    count = len(chains[0][1])
    offsets, turns = (
        np.broadcast_to(array, (count, *array.shape[1:])).copy()
        for array in (motion.offsets, motion.turns)
    )
    for limb, angles in chains:
        turns[:, list(limb.at[: limb.written])] = limb.turns(angles)
    return replace(motion, offsets=offsets, turns=turns, frame_time=frame_time)


def stacked(solutions: Sequence[Solution]) -> Solution:
    """Put solutions of single goals, of one chain, into one with a leading goal axis."""
    return _gathered(solutions, np.stack)


def _joined(parts: Sequence[Solution]) -> Solution:
    """Put solutions with leading goal axes behind each other."""
    return _gathered(parts, np.concatenate)


def _gathered(parts: Sequence[Solution], gather: Callable[[list[Array]], Array]) -> Solution:
    joined: dict[str, Any] = {
        f.name: gather([getattr(part, f.name) for part in parts])
        for f in fields(parts[-1])
        if f.name not in OF_ALL and getattr(parts[-1], f.name) is not None
    }
    if "notes" in joined:
        joined["notes"] = tuple(joined["notes"].tolist())
    return replace(parts[0], **joined, continuity=parts[-1].continuity)
