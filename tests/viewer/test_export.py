"""A saved scene reads back and solves to the same pose."""

import numpy as np
import pytest

from limbik.core.body import solve_body
from limbik.core.bodyscene import body_from
from limbik.core.posegoals import PoseSolution
from limbik.core.registry import Registry
from limbik.core.scene import scene_from
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml
from limbik.plugins.viewer.export import scene_text
from limbik.plugins.viewer.session import Session
from limbik.tests.viewer.scenes import CONFIGS, Opened


def again(session: Session, registry: Registry) -> np.ndarray:
    """Angles of the scene that a session saves, solved anew."""
    document = read_yaml(scene_text(session), "saved.yaml")
    scene = scene_from(document, CONFIGS, registry)
    return solve_scene(scene, registry)[0].angles


@pytest.mark.parametrize("name", ["arm", "leg-pole", "planar", "weld", "arm7", "spine"])
def test_a_scene_as_it_was_opened(opened: Opened, registry: Registry, name: str) -> None:
    session = opened(name)
    session.follow = False
    session.move_goal(name, session.chain.goal * 1.01)
    (shown,) = session.solve().values()
    np.testing.assert_array_equal(again(session, registry), shown.angles)


def test_a_scene_with_everything_changed(opened: Opened, registry: Registry) -> None:
    session = opened("arm")
    setup = session.chain.setup
    for path, value in {
        ("bend_vector",): {"use": "auto", "angle": 30.0, "sensitivity": 0.5, "strength": 0.7},
        ("held", "base"): 1,
        ("forbidden_cone",): {"axis": "y-", "half_angle": 20.0},
        ("weight_range",): (-0.2, 0.3),
        ("fk_strength",): 0.5,
        ("max_iterations",): 7,
    }.items():
        setup = setup.with_option(path, value)
    session.change("arm", setup.with_fk(1, np.radians([0.0, 12.5, 3.0])))
    session.move_goal("arm", np.array([11.0, 120.0, 30.0]))
    (shown,) = session.solve().values()
    np.testing.assert_allclose(again(session, registry), shown.angles, atol=1e-12)


def test_a_limit_of_its_own_and_options_by_joint(opened: Opened, registry: Registry) -> None:
    session = opened("arm")
    cone = {"use": "cone", "swing": (50.0, 40.0), "twist": (-20.0, 20.0)}
    setup = session.chain.setup.with_limit(0, cone)
    setup = setup.with_option(("stiffness", "elbow"), 0.5).with_option(("limit_ease",), 10.0)
    setup = setup.with_option(("choose",), {"pose": {"wrist": (0.0, 10.0, 0.0)}})
    setup = setup.with_option(("end_orientation",), 0.5)
    session.change("arm", setup)
    session.turn_goal("arm", np.radians([20.0, 10.0, 0.0]))
    (shown,) = session.solve().values()
    np.testing.assert_allclose(again(session, registry), shown.angles, atol=1e-12)


def test_another_solver_with_a_turned_pole(opened: Opened, registry: Registry) -> None:
    session = opened("arm")
    setup = session.chain.setup.with_strategy("solver", {"use": "2d"})
    setup = setup.with_pole(np.array([40.0, 100.0, -30.0])).with_rotor(
        {"swing": 0.5, "twist": 0.25}
    )
    session.change("arm", setup)
    session.turn_goal("arm", np.radians([20.0, 10.0, 0.0]))
    (shown,) = session.solve().values()
    np.testing.assert_allclose(again(session, registry), shown.angles, atol=1e-12)
    back = session.chain.setup.with_strategy("solver", {"use": "fabrik", "rounds": 30})
    session.change("arm", back)
    assert "pole" not in read_yaml(scene_text(session), "saved").content
    (shown,) = session.solve().values()
    np.testing.assert_array_equal(again(session, registry), shown.angles)


def test_a_body(opened: Opened, registry: Registry) -> None:
    session = opened("body")
    session.select("right arm")
    session.change("right arm", session.chain.setup.with_option(("twist",), 20.0))
    session.move_goal("spine", np.array([0.1, 0.78, 0.1]))
    shown = session.solve()
    document = read_yaml(scene_text(session), "saved.yaml")
    (whole,) = solve_body(body_from(document, CONFIGS, registry), registry)
    for name, one in shown.items():
        np.testing.assert_allclose(whole.solutions[name].angles, one.angles, atol=1e-12)


def test_pose_goals(opened: Opened, registry: Registry) -> None:
    session = opened("arm7-pose")
    session.turn_goal("arm7-pose", np.radians([10.0, 170.0, 5.0]))
    (shown,) = session.solve().values()
    np.testing.assert_allclose(again(session, registry), shown.angles, atol=1e-9)
    assert isinstance(shown.solution, PoseSolution)
    assert shown.solution.rotation_error < 1e-3
