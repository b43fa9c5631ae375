"""A setup changes as a whole or not at all, and keeps what other solvers need."""

import math
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from limbik.core.errors import InputError, LimbikError
from limbik.core.registry import Registry
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


def test_going_to_2d_and_back_keeps_the_options_of_3d(arm: Setup, opened: Opened) -> None:
    goal = opened("arm").chain.goal
    flat = arm.with_strategy("solver", {"use": "2d"})
    assert flat.in_plane
    assert flat.scene.pole == flat.pole
    assert {control.path[0] for control in flat.options}.isdisjoint({"clamp", "soft_zone"})
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
