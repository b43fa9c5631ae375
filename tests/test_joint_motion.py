"""Joint motion: every sample is solved and checked, failures have a time and a place."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError
from limbik.core.solver import Solver
from limbik.trajectory import (
    KeyPoint,
    Limits,
    Line,
    joint_motion,
    plan,
)

pytest.importorskip("scipy")
LIMITS = Limits(0.5, 1.0)


def point(x: float, y: float, z: float, *turn: float) -> KeyPoint:
    """A key point turned by ZYX angles in degrees."""
    return KeyPoint.from_euler((x, y, z), np.radians(turn or (0.0, 0.0, 0.0)))


def leg() -> Chain:
    return Chain(
        [
            Joint.degrees("hip", pitch=(-120, 120), heading=(0, 0), bank=(0, 0)),
            Joint.degrees("knee", offset=(0, 0, 1), pitch=(-150, 0), heading=(0, 0), bank=(0, 0)),
            Joint.degrees("foot", offset=(0, 0, 1)),
        ]
    )


def motion_of(start: KeyPoint, end: KeyPoint, **options: Any) -> Any:
    samples = plan(start, [Line(end)], LIMITS).sample(0.02)
    return joint_motion(samples, Solver(leg(), max_iterations=200, tolerance=1e-4), **options)


def test_joint_motion_puts_the_end_on_every_sample_within_limits() -> None:
    found = motion_of(point(0, 0.2, 1.2), point(0, -0.3, 1.5))

    assert found.failures == ()
    assert (
        np.linalg.norm(found.solution.positions[:, -1] - found.samples.positions, axis=1).max()
        < 1e-4
    )


def test_what_is_out_of_reach_is_listed_with_time_and_place() -> None:
    (failure,) = motion_of(point(0, 0, 1.5), point(0, 0, 2.5)).failures

    assert failure.kind == "out-of-reach"
    assert failure.position[2] == pytest.approx(2.5)
    assert 1.0 < failure.start < failure.end == pytest.approx(2.5)
    assert "out of reach" in str(failure)


def test_a_joint_that_is_too_fast_is_named_with_both_speeds() -> None:
    way = point(0, 0.2, 1.2), point(0, -0.3, 1.5)
    fastest = np.abs(motion_of(*way).speeds).max(axis=0)[1, 1]
    failures = motion_of(*way, speed_limits={"knee": 0.5 * fastest}).failures

    assert {(failure.kind, failure.joint) for failure in failures} == {("speed", "knee pitch")}
    assert max(failure.worst for failure in failures) == pytest.approx(fastest)
    assert motion_of(*way, speed_limits={"knee": 1.01 * fastest}).failures == ()
    with pytest.raises(InputError, match="no joint is called 'ankle'"):
        motion_of(*way, speed_limits={"ankle": 1.0})
