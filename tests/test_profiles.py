"""Speed profiles keep speed, acceleration and jerk limits, and go the distance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.plugins.paths.ramps import Rates, profile
from limbik.trajectory import (
    Limits,
)

pytest.importorskip("scipy")
LIMITS = Limits(0.5, 1.0)


@given(
    distance=st.floats(0.001, 10.0),
    speed=st.floats(0.01, 5.0),
    up=st.floats(0.1, 10.0),
    down=st.floats(0.1, 10.0),
    jerk=st.floats(0.5, 100.0),
)
def test_a_profile_keeps_its_limits_and_goes_the_distance(
    distance: float, speed: float, up: float, down: float, jerk: float
) -> None:
    found = profile(distance, Rates(speed, up, down, jerk))
    x, v, a = found.at(np.linspace(0.0, found.duration, 500))

    assert sum(phase.distance for phase in found.phases) == pytest.approx(distance, rel=1e-9)
    assert x[-1] == pytest.approx(distance, rel=1e-12)
    assert v.max() <= speed * (1 + 1e-9)
    assert v.min() >= -1e-9 * speed
    assert a.max() <= up * (1 + 1e-9)
    assert a.min() >= -down * (1 + 1e-9)
    assert max(abs(phase.jerk) for phase in found.phases) <= jerk
    steps = [p.acceleration + p.duration * p.jerk for p in found.phases]
    starts = [p.acceleration for p in found.phases[1:]]
    np.testing.assert_allclose(steps[:-1], starts, atol=1e-6 * max(up, down))


def test_a_huge_jerk_gives_the_trapezoid_and_a_small_one_takes_longer() -> None:
    plain = profile(1.0, Rates(0.5, 1.0, 2.0))
    assert profile(1.0, Rates(0.5, 1.0, 2.0, 1e9)).duration == pytest.approx(plain.duration, 1e-6)
    assert profile(1.0, Rates(0.5, 1.0, 2.0, 2.0)).duration > plain.duration + 0.1
