"""The choice among a goal's solutions: nearest to a pose, or farthest from limits (F-01)."""

from math import acos, atan2, cos, hypot, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError, InputError
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import scene_from
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml
from limbik.tests.limbs import ARM_OPTIONS, REGISTRY, arm, reachable

LONG, SHORT = 1.0, 0.7
SHOULDER, ELBOW = (-170.0, 150.0), (-160.0, 120.0)


def hinges() -> Chain:
    """Two hinges in one plane, with limits to both sides."""
    none = (0.0, 0.0)
    return Chain(
        [
            Joint.degrees("shoulder", heading=none, pitch=SHOULDER, bank=none),
            Joint.degrees("elbow", (0, 0, LONG), heading=none, pitch=ELBOW, bank=none),
            Joint.degrees("hand", (0, 0, SHORT), heading=none, pitch=none, bank=none),
        ]
    )


def run(chain: Chain, **options: Any) -> Solver:
    return Solver(chain, registry=REGISTRY, **options)


def both(y: float, z: float) -> list[Array]:
    """Shoulder and elbow of the two ways to a goal, by the law of cosines, inside the limits."""
    reach = hypot(y, z)
    bend = acos((reach**2 - LONG**2 - SHORT**2) / (2.0 * LONG * SHORT))
    found = []
    for elbow in (bend, -bend):
        shoulder = atan2(y, z) - atan2(SHORT * sin(elbow), LONG + SHORT * cos(elbow))
        angles = np.array([(shoulder + pi) % (2.0 * pi) - pi, elbow])
        low, high = np.radians([SHOULDER, ELBOW]).T
        if (angles > low + 1e-3).all() and (angles < high - 1e-3).all():
            found.append(angles)
    return found


PLACES = st.tuples(st.floats(0.45, 1.6), st.floats(-pi, pi))
WEIGHTS = st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0))


def turns(first: Array, second: Array) -> Array:
    """Angles between the joints' rotations [rad]."""
    return np.abs((first - second + pi) % (2.0 * pi) - pi)


@settings(max_examples=100, deadline=None)
@given(PLACES, st.tuples(st.floats(-160, 140), st.floats(-150, 110)), WEIGHTS)
def test_of_two_ways_the_nearer_to_the_pose_is_taken(
    place: tuple[float, float], pose: tuple[float, float], weights: tuple[float, float]
) -> None:
    y, z = place[0] * sin(place[1]), place[0] * cos(place[1])
    ways = both(y, z)
    costs = [float(turns(way, np.radians(pose)) ** 2 @ weights) for way in ways]
    assume(len(ways) == 2 and abs(costs[0] - costs[1]) > 1e-6)
    solver = run(
        hinges(),
        choose={
            "pose": {"shoulder": (0.0, pose[0], 0.0), "elbow": (0.0, pose[1], 0.0)},
            "weights": {"shoulder": weights[0], "elbow": weights[1]},
        },
    )
    found = solver.solve((0.0, y, z))
    assert found.status == Status.REACHED
    np.testing.assert_allclose(found.angles[:2, 1], ways[int(np.argmin(costs))], atol=1e-6)


@settings(max_examples=100, deadline=None)
@given(PLACES, WEIGHTS)
def test_of_two_ways_the_farther_from_limits_is_taken(
    place: tuple[float, float], weights: tuple[float, float]
) -> None:
    y, z = place[0] * sin(place[1]), place[0] * cos(place[1])
    low, high = np.radians([SHOULDER, ELBOW]).T
    ways = both(y, z)
    left = [float((np.minimum(way - low, high - way) / weights).min()) for way in ways]
    assume(len(ways) == 2 and abs(left[0] - left[1]) > 1e-6)
    named = {"shoulder": weights[0], "elbow": weights[1]}
    found = run(hinges(), choose={"by": "margin", "weights": named}).solve((0.0, y, z))
    np.testing.assert_allclose(found.angles[:2, 1], ways[int(np.argmax(left))], atol=1e-6)


def far(chain: Chain, angles: Array, pose: Array) -> Array:
    """Sum of the joints' squared turns away from a pose, (m,) [rad²]."""
    apart = np.swapaxes(hpb_to_matrix(pose), -1, -2) @ hpb_to_matrix(angles)
    cosine = 0.5 * (np.trace(apart, axis1=-2, axis2=-1) - 1.0)
    return np.asarray((np.arccos(np.clip(cosine, -1.0, 1.0)) ** 2).sum(axis=-1))


def test_the_choice_is_never_worse_and_mostly_better_than_no_choice() -> None:
    chain, goals = arm(), reachable(arm(), 200, 3)
    plain = run(chain, **ARM_OPTIONS).solve_many(goals)
    near = run(chain, choose={}, **ARM_OPTIONS).solve_many(goals)
    wide = run(chain, choose={"by": "margin"}, **ARM_OPTIONS).solve_many(goals)
    turning = chain.high - chain.low > 1e-6
    for found in (near, wide):
        np.testing.assert_array_equal(found.status, plain.status)
        assert (found.angles >= chain.low).all()
        assert (found.angles <= chain.high).all()
    rest = np.clip(chain.rest, chain.low, chain.high)
    gain = far(chain, plain.angles, rest) - far(chain, near.angles, rest)
    assert gain.min() > -1e-8
    assert np.mean(gain > 0.01) > 0.5

    def left(angles: Array) -> Array:
        gap = np.minimum(angles - chain.low, chain.high - angles)
        return np.asarray(gap[:, turning].min(axis=1))

    more = left(wide.angles) - left(plain.angles)
    assert more.min() > -1e-8
    assert np.mean(more > np.radians(1.0)) > 0.5


def test_a_limb_with_joints_to_spare_ends_where_no_small_change_is_nearer() -> None:
    """At the nearest pose the turns away from the reference are JᵀL for some L (Lagrange)."""
    chain = Chain([Joint(f"j{k}", (0.0, 0.0, 0.5 if k else 0.0)) for k in range(6)])
    pose = {f"j{k}": (0.0, 25.0, 0.0) for k in range(5)}
    found = run(chain, choose={"pose": pose}).solve((0.3, 0.4, 1.9))
    reference = chain.rest + np.radians([pose.get(name, (0.0,) * 3) for name in chain.names])
    best = far(chain, found.angles, reference)
    generator = np.random.default_rng(4)
    for _ in range(200):
        start = found.angles + generator.normal(size=(6, 3)) * 0.05
        tried = run(chain, start="current", smoothing=1.0).solve(
            found.goal,
            continuity=type(found.continuity).from_pose(start),  # type: ignore[union-attr]
        )
        assert far(chain, tried.angles, reference) > best * 0.98


def test_without_a_pose_the_one_before_counts() -> None:
    solver = run(hinges(), choose={})
    goal, offset = np.array([0.0, 0.9, 0.9]), np.array([0.0, 0.01, 0.02])
    up, down = (
        run(hinges(), choose={"pose": {"elbow": (0.0, side, 0.0)}}).solve(goal)
        for side in (90, -90)
    )
    assert up.angles[1, 1] > 0.0 > down.angles[1, 1]
    for before in (up, down):
        after = solver.solve(goal + offset, continuity=before.continuity)
        assert np.sign(after.angles[1, 1]) == np.sign(before.angles[1, 1])


def test_a_choice_is_the_same_alone_and_among_many() -> None:
    solver = run(arm(), choose={"by": "margin"}, **ARM_OPTIONS)
    goals = reachable(arm(), 20, 5)
    many = solver.solve_many(goals).angles
    for row in (0, 7, 19):
        np.testing.assert_array_equal(solver.solve(goals[row]).angles, many[row])


def test_a_goal_that_is_not_reached_is_left_as_it_is() -> None:
    goal = (0.0, 0.0, 5.0)
    chosen, plain = run(hinges(), choose={}).solve(goal), run(hinges()).solve(goal)
    np.testing.assert_array_equal(chosen.angles, plain.angles)
    assert chosen.status == plain.status == Status.OUT_OF_REACH


def test_the_choice_is_the_last_stage_of_a_trace() -> None:
    found = run(hinges(), choose={"by": "margin"}).solve((0.0, 0.5, 1.0), trace=True)
    assert found.trace is not None
    assert [stage.name for stage in found.trace][-2:] == ["finish", "choice"]
    np.testing.assert_array_equal(found.trace[-1].angles, found.angles)


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ChainError, match=r"choose\.weights: no joint .*'elbo' .*'elbow'"):
        run(hinges(), choose={"weights": {"elbo": 1.0}})
    with pytest.raises(InputError, match="choose needs a finish"):
        run(hinges(), choose={}, finish="none")


SCENE = b"""\
limbik: 1
chain:
  joints:
    - {name: shoulder, heading: 0, pitch: [-170, 150], bank: 0}
    - {name: elbow, offset: [0, 0, 1], heading: 0, pitch: [-160, 120], bank: 0}
    - {name: hand, offset: [0, 0, 0.7], heading: 0, pitch: 0, bank: 0}
options: {choose: {by: nearest, pose: {elbow: [0, SIDE, 0]}, weights: {shoulder: 0}}}
goals: [{position: [0, 0.9, 0.9]}]
"""


@pytest.mark.parametrize("side", [-90, 90])
def test_a_scene_chooses(side: int) -> None:
    text = SCENE.replace(b"SIDE", str(side).encode())
    found = solve_scene(scene_from(read_yaml(text, "elbow.yaml"), Path(), REGISTRY), REGISTRY)
    assert np.sign(found[0].angles[1, 1]) == np.sign(side)
