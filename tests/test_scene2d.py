"""Scenes choose the 2D solver, and everything they say of it counts."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.core.registry import Registry
from limbik.core.scene import Scene, scene_from
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver2d import Solver2D
from limbik.core.solving import scene_solver, solve_scene
from limbik.core.yamlfile import read_yaml

REGISTRY = Registry(third_party=False)
SCENE = """\
limbik: 1
solver: 2d
chain:
  joints:
    - {name: hip, rest: [0, 10, 0]}
    - {name: knee, offset: [0, 0, 30], rest: [0, -25, 0], planar: [-135, 0]}
    - {name: ankle, offset: [0, 0, 26]}
pole: {position: [20, 40, 20]}
goals: [{name: a, position: [10, -5, 40]}, {name: b, position: [-10, 5, 45]}]
"""


def scene(text: str) -> Scene:
    return scene_from(read_yaml(text, "scene.yaml"), Path(), REGISTRY)


def solved(text: str, trace: bool = False) -> list[Any]:
    return list(solve_scene(scene(text), REGISTRY, trace))


def test_a_scene_with_solver_2d_is_solved_in_the_plane_of_its_pole() -> None:
    solutions = solved(SCENE)

    for solution in solutions:
        assert isinstance(solution, PlanarSolution)
        assert solution.reached
        np.testing.assert_array_equal(solution.pole, [20.0, 40.0, 20.0])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("planar: [-135, 0]", "planar: [-20, 0]"),
        ("position: [20, 40, 20]", "position: [20, -40, 20]"),
        ("20]}\ngoals", "20], rotor: leg}\ngoals"),
        ("20]}\ngoals", "20], bind: true}\ngoals"),
        ("20]}\ngoals", "20]}\noptions: {twist: 20}\ngoals"),
        ("20]}\ngoals", "20]}\nfk: {knee: [10, 0, 0]}\ngoals"),
    ],
)
def test_each_key_of_the_2d_solver_counts(old: str, new: str) -> None:
    changed, usual = solved(SCENE.replace(old, new)), solved(SCENE)

    assert np.abs(changed[0].rotations - usual[0].rotations).max() > 1e-4


@pytest.mark.parametrize("key", ["swing: 0.2", "twist: 0.5"])
def test_each_share_of_a_rotor_counts(key: str) -> None:
    def poles(rotor: str) -> Any:
        text = SCENE.replace("20]}\ngoals", f"20], rotor: {{{rotor}}}}}\ngoals")
        turned = text.replace("40]}", "40], rotation: [30, 20, 10]}")
        return [solution.pole for solution in solved(turned)]

    assert np.abs(poles(key)[0] - poles("")[0]).max() > 0.1


def test_a_goals_rotation_turns_the_rotor_with_and_without_a_trace() -> None:
    text = SCENE.replace("20]}\ngoals", "20], rotor: leg}\ngoals")
    turned = text.replace("40]}", "40], rotation: [0, 0, 30]}")
    plain, moved, traced = solved(text), solved(turned), solved(turned, trace=True)

    assert np.abs(plain[0].pole - moved[0].pole).max() > 0.1
    np.testing.assert_allclose(plain[1].pole, moved[1].pole)
    for one, other in zip(moved, traced, strict=True):
        np.testing.assert_allclose(one.angles, other.angles, atol=1e-12)


def test_follow_goes_on_from_the_pose_before() -> None:
    goals = "".join(f"  - {{position: [{40 * np.sin(a)}, 0, {40 * np.cos(a)}]}}\n"
                    for a in np.linspace(0, 6, 40))  # fmt: skip
    text = SCENE[: SCENE.index("goals")] + "follow: true\ngoals:\n" + goals
    headings = [solution.angles[0, 0] for solution in solved(text)]

    assert abs(headings[-1]) > np.pi


def test_a_bound_scene_leaves_its_rest_pose() -> None:
    found = scene(SCENE.replace("20]}\ngoals", "20], bind: true}\ngoals"))
    solver = scene_solver(found, REGISTRY)
    assert isinstance(solver, Solver2D)

    for bound in (solver, solver.bind()):  # to bind again changes nothing
        angles = bound.solve(_resting_end(found)).angles
        assert np.abs(angles - found.chain.rest).max() < 1e-9


def _resting_end(found: Scene) -> Any:
    from limbik.core.pose import forward_kinematics

    return forward_kinematics(found.chain, found.chain.rest)[0][-1]


def test_a_scene_that_binds_past_its_limits_is_refused() -> None:
    text = SCENE.replace("[-135, 0]", "[-10, 0]").replace("20]}\ngoals", "20], bind: true}\ngoals")
    with pytest.raises(InputError, match="outside the planar limits"):
        solved(text)
