"""What cannot be planned is refused, with the largest value that would fit."""

import re
from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.plugins.paths.ramps import Rates, profile
from limbik.trajectory import (
    Arc,
    ArcAbout,
    Blend,
    KeyPoint,
    Limits,
    Line,
    Overlap,
    Spline,
    Stop,
    Turn,
    plan,
)

pytest.importorskip("scipy")
LIMITS = Limits(0.5, 1.0)


def point(x: float, y: float, z: float, *turn: float) -> KeyPoint:
    """A key point turned by ZYX angles in degrees."""
    return KeyPoint.from_euler((x, y, z), np.radians(turn or (0.0, 0.0, 0.0)))


A, B, C = point(0, 0, 0), point(1, 0, 0, 90, 0, 0), point(1, 1, 0, 90, 0, 60)
D, E = point(2, 1.2, 0.4, 30, 40, 0), point(2.2, 0, 0.8, 0, 0, 50)


def fits(error: InputError) -> float:
    """The largest value that fits, as an error states it."""
    found = re.search(r"at most ([\d.e+-]+)", str(error))
    assert found, str(error)
    return float(found[1])


@pytest.mark.parametrize(
    "make",
    [
        lambda v: [Line(B), Blend(v, 0.1), Line(C)],
        lambda v: [Line(B), Blend(0.1, v), Arc(C, D)],
        lambda v: [Line(B), Blend(0.1, 0.6), Line(C), Blend(v, 0.1), Line(D)],
        lambda v: [Line(B), Overlap(v), Line(C)],
        lambda v: [Line(B), Overlap(1.0), Line(C), Overlap(v), Line(D)],
        lambda v: [Line(B), Blend(v, 0.1), Spline([C, D, E], smooth=0.3)],
        lambda v: [Spline([B, C, D], smooth=0.3), Blend(v, 0.1), Line(E)],
    ],
    ids=["blend", "blend after", "two blends", "overlap", "two overlaps", "line", "smoothed"],
)
def test_an_error_states_the_largest_value_that_would_fit(make: Any) -> None:
    with pytest.raises(InputError) as caught:
        plan(A, make(9.0), LIMITS)
    largest = fits(caught.value)

    plan(A, make(largest * (1 - 1e-5)), LIMITS)
    with pytest.raises(InputError):
        plan(A, make(largest * 1.01), LIMITS)


def test_a_speed_that_can_never_be_reached_is_refused_with_the_one_that_can() -> None:
    for start, end in ((0.9, 0.0), (0.0, 0.9)):
        for jerk in (np.inf, 10.0):
            rates = Rates(1.0, 1.0, 1.0, jerk)
            with pytest.raises(InputError) as caught:
                profile(0.01, rates, start, end)
            largest = fits(caught.value) * (1 - 1e-5)
            profile(0.01, rates, min(start, largest), min(end, largest))
    with pytest.raises(InputError, match="at most 1"):
        profile(10.0, Rates(1.0, 1.0, 1.0), 1.5, 0.0)


@pytest.mark.parametrize(
    ("steps", "word"),
    [
        ([Arc(B, point(0.5, 0, 0))], "on one line"),
        ([Arc(B, B)], "coincide"),
        ([Spline([B])], "three key points"),
        ([Spline([B, B, C])], "one place"),
        ([Spline([B, C], smooth=0.6)], "at most 0.5"),
        ([Line(B), Blend(0.1), Line(A)], "turns back"),
        ([Line(B), Overlap(0.1, cut=0.1), Line(C)], "exactly one"),
        ([Line(B), Stop(), Blend(0.1), Line(C)], "one at a time"),
        ([Line(B), Stop()], "ends with one"),
        ([Turn(B)], "is 1 away"),
        ([ArcAbout((0, 0, 1), (0, 0, 1), 1.0)], "its own axis"),
        ([Line(B, Limits(0.0, 1.0))], "above 0"),
        ([Line(B, Limits(1.0))], "acceleration or ramp_times"),
    ],
)
def test_impossible_programs_are_refused_in_words(steps: Any, word: str) -> None:
    with pytest.raises(InputError, match=word):
        plan(A, steps, LIMITS)
