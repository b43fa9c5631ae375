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


def blocked_by_a_fold() -> tuple[Chain, list[float]]:
    """A leg whose knee CCD bends the wrong way, and a goal that it reaches bent the right way."""
    chain = Chain(
        [
            Joint.degrees("hip", heading=FIXED, pitch=(-150, 150), bank=FIXED),
            Joint.degrees("knee", (0, 0, 1), heading=FIXED, pitch=(0, 150), bank=FIXED),
            Joint.degrees("foot", (0, 0, 1), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )
    return chain, [0.0, 1.0, 1.0]


def test_staying_in_a_fold_is_no_proof_and_the_nearest_is_told() -> None:
    """With `fold: home` another fold only tells that the goal is not out of the limits' reach."""
    chain, goal = blocked_by_a_fold()
    wrong_way = {"use": "manual", "angle": 0.0}
    finish = {"use": "newton", "fold": "home"}
    options = {"registry": REGISTRY, "bend_vector": wrong_way, "tolerance": 1e-4}
    for side in (1.0, -1.0):
        at_side = [goal[0], side * goal[1], goal[2]]
        assert Solver(chain, **options).solve(at_side).status == Status.REACHED
        home = Solver(chain, finish=finish, **options).solve(at_side)
        if home.status != Status.REACHED:
            assert home.status == Status.STOPPED
            assert home.nearest is not None
            assert home.nearest < 1e-4 < home.distance


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
