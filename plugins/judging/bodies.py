"""Judge a scene with several chains: each for itself, as the chains before it left its base.

A chain is judged as if its base stood where it is in the first frame and its goals moved past it,
which is what the chain itself sees of a moving base.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from limbik.core.body import BodySolution, chain_solutions, solve_body
from limbik.core.bodyscene import BodyScene, Part
from limbik.core.chain import vector
from limbik.core.errors import SceneError
from limbik.core.pole import Pole
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.scene import Scene
from limbik.core.skeleton import WORLD
from limbik.core.solution import Solution
from limbik.plugins.judging.report import Verdict, judge

_STILL = 1e-9  # share of the chain's length a pole may move about


def judge_body(scene: BodyScene, registry: Registry | None = None) -> dict[str, list[Verdict]]:
    """Solve all frames and measure each chain's motion.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new one if absent.

    Raises:
        SceneError: A `judge` section names a metric that does not exist, or a chain has a pole that
            its base moves against.
    """
    found = solve_body(scene, registry)
    solutions = chain_solutions(found)
    return {
        part.name: judge(_alone(part, found, solutions[part.name]), registry)
        for part in scene.parts
    }


def _alone(part: Part, found: Sequence[BodySolution], solutions: Sequence[Solution]) -> Scene:
    """Return the scene of one chain, seen from its base."""
    goals = np.array([_seen(s, s.goal, solutions[0]) for s in solutions])
    chain = part.scene.chain.moved(
        np.array(solutions[0].chain.base_position), solutions[0].chain.base_rotation
    )
    pole = part.scene.pole
    if pole is not None:
        pole = _pole(part, pole, found, solutions)
    turns = None
    if part.scene.goal_turns is not None:
        axes = np.array([s.chain.base_rotation for s in solutions])
        turned = hpb_to_matrix([body.goal_turns[part.name] for body in found])
        turns = matrix_to_hpb(axes[0] @ axes.swapaxes(-1, -2) @ turned)
    return replace(part.scene, chain=chain, goals=goals, pole=pole, goal_turns=turns)


def _seen(solution: Solution, place: Array, first: Solution) -> Array:
    """Return a world position where it would be, were the base where it first was."""
    chain = solution.chain
    from_base = chain.base_rotation.T @ (place - np.array(chain.base_position))
    return np.asarray(first.chain.base_position + first.chain.base_rotation @ from_base)


def _pole(
    part: Part, pole: Pole, found: Sequence[BodySolution], solutions: Sequence[Solution]
) -> Pole:
    places = []
    for body, solution in zip(found, solutions, strict=True):
        place = np.array(pole.position)
        if part.frame != WORLD:
            place = body.positions[part.frame] + body.rotations[part.frame] @ place
        places.append(_seen(solution, place, solutions[0]))
    if np.ptp(places, axis=0).max() > _STILL * part.scene.chain.length:
        message = "limbik judge needs a pole that stands still before the chain's base"
        raise SceneError([part.scene.document.fault("solver", message, ("pole",))])
    return pole.model_copy(update={"position": vector(places[0])})
