"""What an experiment consists of: trials, each one variant on one chain and one set of goals."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.settings import Settings
from limbik.core.slots import SOLVER
from limbik.core.whole import BUILT_IN_3D, OWN_SOLVERS
from limbik.core.yamlfile import Document
from limbik.plugins.experiments.goalsets import Goals, Points
from limbik.plugins.experiments.variants import Choice, Variant


@dataclass(frozen=True)
class GoalSet:
    """A named set of goals.

    Attributes:
        name: The set's name.
        goals: The goals.
        is_path: Whether they are a path at a steady rate.
        follow: Whether each is solved from the pose before it.
        rate: Goals a second [1/s].
        repeat: Number of the draw, from 0.
    """

    name: str
    goals: Goals
    is_path: bool = False
    follow: bool = False
    rate: float = 60.0
    repeat: int = 0


@dataclass(frozen=True)
class Trial:
    """One variant on one chain and one set of goals; plain values that go to other processes.

    Attributes:
        number: From 0, in the order of the file.
        chain: Name of the chain.
        scene: The chain's scene with the variant's options, without goals and solver.
        solver: The whole solver, by name or mapping; None for limbik's own.
        strategy: Name of the strategy.
        params: What is swept, by the option's name.
        label: Strategy and params for people.
        goal_set: The goals.
    """

    number: int
    chain: str
    scene: Scene
    solver: Choice | None
    strategy: str
    params: Mapping[str, Any]
    label: str
    goal_set: GoalSet

    @property
    def count(self) -> int:
        """How many goals there are."""
        return len(self.goal_set.goals)

    @property
    def posed(self) -> int:
        """How many joints all its solves pose, which is what they cost."""
        return self.count * len(self.scene.chain)

    def without_goals(self) -> "Trial":
        """Return the trial with no goals, to be sent elsewhere with some of them."""
        return replace(self, goal_set=replace(self.goal_set, goals=Points(np.zeros((0, 3)))))

    def ready(self, goals: Array, registry: Registry) -> Scene:
        """Return the scene with goals, (m, 3) [length], ready to be solved."""
        solver = None if self.solver is None else registry.bind(SOLVER.name, self.solver)
        return replace(self.scene, goals=goals, solver=solver)


def scene_for(scene: Scene, variant: Variant, settings: Settings) -> tuple[Scene, Choice | None]:
    """Return a scene as a variant wants it, and the whole solver it is solved with.

    The scene keeps nothing that only matters where it was read.
    """
    wanted = variant.solver
    if wanted is None:
        content = scene.document.content
        wanted = content.get(SOLVER.name, BUILT_IN_3D) if scene.pole is None else "2d"
    in_plane = wanted == "2d"
    bare = replace(
        scene,
        settings=settings,
        pole=scene.pole if in_plane else None,
        bind=scene.bind and in_plane,
        goal_names=(),
        goals=np.zeros((0, 3)),
        goal_turns=None,
        follow=False,
        document=Document(scene.document.name, {}, {}, {}),
        judge=None,
        trajectory=None,
        body=None,
        solver=None,
    )
    return bare, None if wanted in OWN_SOLVERS else wanted


def trials(
    ready: Mapping[str, Sequence[tuple[Variant, Scene, Choice | None]]],
    goal_sets: Mapping[str, Sequence[GoalSet]],
) -> Iterator[Trial]:
    """Number the trials: chain by chain, goal set by goal set, variant by variant.

    Args:
        ready: Variants with scene and solver, by the chain's name.
        goal_sets: Goal sets by the chain's name.
    """
    number = 0
    for chain, variants in ready.items():
        for goal_set in goal_sets[chain]:
            for variant, scene, solver in variants:
                yield Trial(
                    number,
                    chain,
                    replace(scene, follow=goal_set.follow),
                    solver,
                    variant.strategy,
                    variant.params,
                    variant.label,
                    goal_set,
                )
                number += 1
