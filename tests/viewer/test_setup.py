"""A setup changes as a whole or not at all, and keeps what other solvers need."""

import math
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from limbik.core.errors import InputError, LimbikError
from limbik.core.registry import Registry
from limbik.core.rotation import hpb_to_matrix
from limbik.plugins.viewer.session import Session
from limbik.plugins.viewer.setup import Setup
from limbik.tests.viewer.scenes import Opened


@pytest.fixture
def arm(opened: Opened) -> Setup:
    return opened("arm").chain.setup


def test_a_changed_option_changes_the_solve_and_leaves_the_rest(arm: Setup, opened: Opened) -> None:
    session: Session = opened("arm")
    changed = arm.with_option(("bend_vector",), {"use": "manual", "angle": 0.0})
    goal = session.chain.goal
    assert not np.allclose(arm.solve(goal).angles, changed.solve(goal).angles, atol=0.01)
    assert changed.settings.held == arm.settings.held
    assert changed.settings.tolerance == arm.settings.tolerance


def test_a_nested_option_keeps_its_neighbours(arm: Setup) -> None:
    changed = arm.with_option(("held", "base"), 1)
    assert (changed.settings.held.base, changed.settings.held.end) == (1, 1)
    assert changed.settings.held.bend_end is True


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("tolerance",), math.nan),
        (("tolerance",), 0.0),
        (("smoothing",), math.inf),
        (("held", "base"), 4),
        (("max_iterations",), 2.5),
        (("no_such",), 1),
    ],
)
def test_a_bad_value_is_refused_by_name(arm: Setup, path: tuple[str, ...], value: object) -> None:
    with pytest.raises(InputError, match=path[0]):
        arm.with_option(path, value)


@pytest.mark.parametrize("bad", [[math.nan, 0, 0], [0, math.inf, 0], [1, 2], [0, 0, 1e300]])
def test_numbers_that_are_none_do_not_get_in(arm: Setup, bad: list[float]) -> None:
    for refuse in (arm.with_pole, lambda v: arm.with_fk(0, v), arm.solve):
        with pytest.raises(LimbikError):
            refuse(np.array(bad))


def test_solvers_that_do_not_take_the_chain_are_named_with_their_reason(arm: Setup) -> None:
    fit, why = arm.solvers
    assert {"3d", "2d", "fabrik"} <= set(fit)
    assert "lambda-leg" in why
    assert why["lambda-leg"]


def test_options_by_joint_are_set_one_joint_at_a_time(arm: Setup, opened: Opened) -> None:
    goal = opened("arm").chain.goal + np.array([0.0, -20.0, 15.0])
    setup = arm.with_option(("finish",), {"use": "none"})
    stiff = setup.with_option(("stiffness", "shoulder"), 0.9)
    assert stiff.with_option(("stiffness", "elbow"), 0.5).settings.stiffness == {
        "shoulder": 0.9,
        "elbow": 0.5,
    }
    assert np.abs(stiff.solve(goal).angles - setup.solve(goal).angles).max() > 1e-4
    chosen = arm.with_option(("choose",), {}).with_option(("choose", "pose"), {})
    chosen = chosen.with_option(("choose", "pose", "elbow"), (0.0, 40.0, 0.0))
    assert chosen.settings.choose is not None
    assert chosen.settings.choose.pose == {"elbow": (0.0, 40.0, 0.0)}
    with pytest.raises(LimbikError, match="stiffness"):
        arm.with_option(("stiffness", "shoulder"), 1.0)


def test_a_joint_takes_a_limit_of_its_own_and_its_ranges_again(arm: Setup, opened: Opened) -> None:
    goal = opened("arm").chain.goal
    cone = {"use": "cone", "swing": (20.0, 20.0), "twist": (-10.0, 10.0)}
    limited = arm.with_limit(0, cone)
    assert limited.chain.joints[0].pitch is None
    before = arm.solve(goal)
    after = limited.solve(goal)
    assert "shoulder cone" in after.limits_touched()
    assert np.abs(after.angles - before.angles).max() > 0.01
    back = limited.with_limit(0, None)
    assert back.chain is arm.chain
    np.testing.assert_array_equal(back.solve(goal).angles, before.angles)
    with pytest.raises(LimbikError, match="belongs to the 3D solver"):
        limited.with_strategy("solver", {"use": "fabrik"})
    with pytest.raises(LimbikError, match="swing"):
        arm.with_limit(0, {"use": "cone", "swing": (200.0, 20.0)})


def test_the_end_takes_over_a_goals_turn_as_far_as_it_is_told(arm: Setup, opened: Opened) -> None:
    goal, turn = opened("arm").chain.goal, np.radians([20.0, 10.0, 0.0])
    assert not arm.takes_turn
    free = arm.with_limit(3, {"use": "cone", "swing": (90.0, 90.0)})
    taken = free.with_option(("end_orientation",), 1.0)
    assert taken.takes_turn
    turned = taken.solve(goal, turn).rotations[-1]
    np.testing.assert_allclose(turned, hpb_to_matrix(turn), atol=0.2)
    assert np.abs(free.solve(goal, turn).rotations[-1] - turned).max() > 0.2


def test_going_to_2d_and_back_keeps_the_options_of_3d(arm: Setup, opened: Opened) -> None:
    goal = opened("arm").chain.goal
    flat = arm.with_strategy("solver", {"use": "2d"})
    assert flat.in_plane
    assert flat.scene.pole == flat.pole
    assert {control.path[0] for control in flat.options}.isdisjoint({"clamp", "start"})
    back = flat.with_strategy("solver", {"use": "3d"})
    np.testing.assert_array_equal(back.solve(goal).angles, arm.solve(goal).angles)


def test_the_default_pole_makes_a_plane(arm: Setup, opened: Opened) -> None:
    solution = arm.with_strategy("solver", {"use": "2d"}).solve(opened("arm").chain.goal)
    assert solution.remark == ""


def test_a_strategy_of_a_plugin_appears_with_its_parameters(arm: Setup) -> None:
    registry = Registry(third_party=False)
    registry.register(example_plugin(), "spiral")
    setup = Setup.of(arm.given, registry)
    assert "spiral" in setup.offered("initial_bend")
    changed = setup.with_strategy("initial_bend", setup.fresh("initial_bend", "spiral"))
    assert changed.chosen("initial_bend") == {"use": "spiral", "growth": 2.0}
    (growth,) = setup.parameters("initial_bend", "spiral")
    assert (growth.path, growth.low, growth.high) == (("growth",), 0.25, 4.0)
    with pytest.raises(InputError, match="growth"):
        setup.with_strategy("initial_bend", {"use": "spiral", "growth": 9.0})


def example_plugin() -> ModuleType:
    """The module of the example plug-in, from the sources."""
    file = Path(__file__).parents[2] / "examples" / "limbik-spiral" / "limbik_spiral.py"
    spec = spec_from_file_location("spiral_of_the_example", file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
