"""The plug-in is found by limbik, and its strategy works there."""
# ruff: noqa: D103 (the names of the tests say what they claim)

from math import acos

import numpy as np
import pytest
from limbik_spiral import Spiral, limbik_initial_bends, spiral

import limbik
from limbik.testing import check_strategy


@pytest.mark.parametrize("growth", [0.25, 1.0, 4.0])
def test_strategy_is_accepted_and_computes_the_same_when_compiled(growth: float) -> None:
    (strategy,) = limbik_initial_bends()
    check_strategy("initial_bend", strategy, Spiral(growth))


def test_installed_plugin_is_found_by_name() -> None:
    found = limbik.Registry().find("initial_bend", "spiral")
    assert str(found.plugin).startswith("plug-in 'spiral' (limbik-spiral ")


def test_growth_1_is_an_arc_symmetric_about_its_middle() -> None:
    angles = np.zeros(4)
    spiral(np.full(4, 0.25), 0.5, np.ones(4), Spiral(1.0), angles)
    assert angles == pytest.approx(acos(0.5) * np.array([0.75, 0.25, -0.25, -0.75]))


def test_larger_growth_keeps_the_first_bones_together() -> None:
    angles = np.zeros(4)
    spiral(np.full(4, 0.25), 0.5, np.ones(4), Spiral(4.0), angles)
    steps = -np.diff(angles)
    assert (np.diff(steps) > 0.0).all()
