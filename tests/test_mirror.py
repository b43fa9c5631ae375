"""A mirrored solver answers mirrored goals with mirrored poses (M-13, M-14)."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.frames import Y_UP, mirror_hpb
from limbik.core.registry import Registry
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D

REGISTRY = Registry(third_party=False)
GOALS = np.random.default_rng(7).uniform((-20, -15, 20), (25, 20, 50), (40, 3))
ARM = Chain(
    [
        Joint.degrees("shoulder", heading=(-130, 60), pitch=(-85, 85), bank=(-90, 40)),
        Joint.degrees(
            "elbow", (0.0, 0.0, 30.0), (5.0, 2.0, 9.0), heading=(-5, 10), pitch=(-145, 0)
        ),
        Joint.degrees("hand", (0.0, 0.0, 26.0)),
    ],
    (18.0, 5.0, 2.0),
    (0.3, 0.1, -0.2),
)
FREE = Chain([Joint(f"j{k}", (0.0, 0.0, 9.0 * (k > 0))) for k in range(6)], (3.0, 0.0, 1.0))
CASES: list[tuple[Chain, dict[str, Any]]] = [
    (ARM, {}),
    (ARM, {"bend_vector": {"use": "manual", "angle": 40}, "twist": 20}),
    (ARM, {"bend_vector": {"use": "global", "direction": (1, 2, 0.5)}}),
    (FREE, {"bend_vector": {"use": "auto", "angle": -70}}),
    (FREE, {"reference_axis": "x+", "bend_vector": {"use": "manual", "angle": 25}}),
    (FREE, {"forbidden_cone": {"axis": "x-", "half_angle": 30}}),
]


@pytest.mark.parametrize(("chain", "options"), CASES)
def test_a_mirrored_solver_gives_the_mirrored_poses(chain: Chain, options: dict[str, Any]) -> None:
    solver = Solver(chain, None, REGISTRY, max_iterations=60, **options)
    plain = solver.solve_many(GOALS)
    image = solver.mirrored().solve_many(Y_UP.points(GOALS))
    np.testing.assert_allclose(image.positions, Y_UP.points(plain.positions), atol=1e-6)
    np.testing.assert_array_equal(image.status, plain.status)


@pytest.mark.parametrize("given", [{"angle": 40}, {"angle": 40, "exclude_bank": True}])
def test_only_what_has_a_side_changes(given: dict[str, Any]) -> None:
    solver = Solver(ARM, None, REGISTRY, tolerance=0.5, bend_vector={"use": "manual", **given})
    settings = solver.mirrored().settings
    assert settings.bend_vector == {"use": "manual", "exclude_bank": False, **given, "angle": -40}
    assert settings.tolerance == 0.5
    back = solver.mirrored().mirrored()
    np.testing.assert_array_equal(back.solve_many(GOALS).angles, solver.solve_many(GOALS).angles)


@pytest.mark.parametrize("rotor", [None, "arm"])
@pytest.mark.parametrize("bound", [False, True])
def test_a_mirrored_2d_solver_gives_the_mirrored_poses(rotor: Any, bound: bool) -> None:
    from limbik.core.pole import Pole

    joints = [Joint(f"j{k}", (0.0, 0.0, 9.0 * (k > 0)), rest=(0.1, 0.2, 0.0)) for k in range(5)]
    pole = Pole(position=(20.0, 30.0, 10.0), rotor=rotor)
    solver = Solver2D(Chain(joints, (3.0, 0.0, 1.0)), None, REGISTRY, pole=pole, tolerance=1e-3)
    solver = solver.bind() if bound else solver
    plain = solver.solve_many(GOALS)
    image = solver.mirrored().solve_many(Y_UP.points(GOALS))
    np.testing.assert_allclose(image.positions, Y_UP.points(plain.positions), atol=1e-6)
    np.testing.assert_allclose(mirror_hpb(image.angles)[:, 1:], plain.angles[:, 1:], atol=1e-6)
