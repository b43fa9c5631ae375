"""The status is what branch and bound proves; `benchmarks/robustness.py` asks 5,400 cases."""

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.tests.decided import Decision, audit, decide

REGISTRY = Registry(third_party=False)
FIXED = (0.0, 0.0)


def hinge(low: float, high: float) -> Chain:
    """Two bones of length 1 in a plane, the second turned about the end of the first."""
    return Chain(
        [
            Joint.degrees("a", heading=FIXED, pitch=(-180, 180), bank=FIXED),
            Joint.degrees("b", (0, 0, 1), heading=FIXED, pitch=(low, high), bank=FIXED),
            Joint.degrees("end", (0, 0, 1), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def at(radius: float) -> list[float]:
    """45 degrees to the side pitch turns to."""
    return [0.0, -radius * np.sqrt(0.5), radius * np.sqrt(0.5)]


def test_branch_and_bound_finds_what_geometry_says() -> None:
    """An elbow of 60..120 degrees gives distances of 1 to the root of 3."""
    chain = hinge(60.0, 120.0)
    goals = np.array([at(radius) for radius in (0.95, 1.05, 1.68, 1.80)])
    found = decide(chain, goals, np.full(4, 0.01))
    near = [Decision.FAR, Decision.NEAR, Decision.NEAR, Decision.FAR]
    assert found.tolist() == near
    assert decide(chain, goals[:1], np.array([0.06])).tolist() == [Decision.NEAR]


@pytest.mark.parametrize("joints", [2, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_the_status_is_what_branch_and_bound_proves(joints: int, seed: int) -> None:
    tally = audit(joints, 20, 100 * joints + seed, REGISTRY)
    assert tally["cases"] == 60
    assert tally["reached"] >= 20
    assert tally["false"] == 0
    assert tally["behind"] == 0
    assert tally["open"] <= 3


def test_staying_in_a_fold_is_no_proof_and_the_nearest_is_told() -> None:
    """The knee must bend the other way, past the hip's range, than CCD has bent it."""
    chain = Chain(
        [
            Joint.degrees("hip", heading=FIXED, pitch=(-20, 60), bank=FIXED),
            Joint.degrees("knee", (0, 0, 1), heading=FIXED, pitch=(-100, 150), bank=FIXED),
            Joint.degrees("foot", (0, 0, 1), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )
    goal = (0.0, 0.73, 0.7)
    home = Solver(chain, registry=REGISTRY, finish={"use": "newton", "fold": "home"}).solve(goal)

    assert Solver(chain, registry=REGISTRY).solve(goal).status == Status.REACHED
    assert home.status == Status.STOPPED
    assert home.nearest is not None
    assert home.nearest < 1e-6 < 0.1 < home.distance


def test_without_retries_nothing_is_proved() -> None:
    chain = hinge(60.0, 120.0)
    bare = Solver(chain, registry=REGISTRY, finish={"use": "newton", "retries": 0})
    assert bare.solve(at(0.5)).status == Status.STOPPED
    assert Solver(chain, registry=REGISTRY).solve(at(0.5)).status == Status.BLOCKED


def test_the_nearest_of_a_reached_goal_is_its_distance() -> None:
    chain = hinge(0.0, 120.0)
    many = Solver(chain, registry=REGISTRY).solve_many([at(1.5), at(0.1), at(2.5)])
    assert np.asarray(many.nearest).shape == (3,)
    assert (np.asarray(many.nearest) <= np.asarray(many.distance)).all()
    single = many.single(1)
    assert single.nearest == pytest.approx(0.9, abs=0.02)
    assert Solver(chain, registry=REGISTRY, finish="none").solve(at(1.5)).nearest is not None
