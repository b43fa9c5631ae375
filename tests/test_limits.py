"""Limits of joints as a plug-in kind, and the swing-twist cone (M-08)."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError, PluginError
from limbik.core.hooks import hookimpl
from limbik.core.kernels.rotation import hpb_to_matrix as hpb_to_rows
from limbik.core.kernels.rotation import matrix_to_hpb as rows_to_hpb
from limbik.core.kernels.rotation import multiply, turn_by
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.scene import scene_from
from limbik.core.settings import Settings
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.core.solving import solve_scene
from limbik.core.strategy import Strategy, flatten, unflatten
from limbik.core.whole import prepare
from limbik.core.yamlfile import read_yaml
from limbik.tests.limbs import REGISTRY

CONE = {"use": "cone", "swing": (60.0, 35.0), "twist": (-30.0, 45.0)}
ANGLES = st.floats(-np.pi, np.pi)
HALVES = st.one_of(st.floats(0.0, 180.0), st.sampled_from([0.0, 30.0, 180.0]))


def swing_twist(angles: Array) -> tuple[Array, float]:
    """Swing vector and twist by another way than the strategy's: quaternions [rad]."""
    m = hpb_to_matrix(angles)
    w = np.sqrt(max(0.0, 1.0 + np.trace(m))) / 2.0
    if w < 1e-3:
        pytest.skip("a half turn has no one swing")
    x, y, z = (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]) / (4.0 * w)
    size = np.hypot(w, z)
    # q = swing * twist, twist = (w, 0, 0, z) / size
    c, s = w / size, z / size
    across = np.array([x * c - y * s, x * s + y * c])
    half = np.hypot(*across)
    swing = across * (2.0 * np.arctan2(half, size) / half if half > 0.0 else 0.0)
    return swing, -2.0 * np.arctan2(z, w)


def pull(angles: Any, **params: Any) -> tuple[Array, float]:
    """Run the cone in the interpreter: pulled angles [rad] and margin [rad]."""
    bound = REGISTRY.bind("limit", {"use": "cone", **params})
    turn, margin = np.array(angles, float), np.zeros(1)
    values = unflatten(bound.strategy.params, flatten(bound.params))
    bound.strategy.function()(turn, values, margin)
    return turn, float(margin[0])


@settings(max_examples=300, deadline=None)
@given(st.tuples(ANGLES, ANGLES, ANGLES), HALVES, HALVES, st.tuples(ANGLES, ANGLES))
def test_a_turn_is_pulled_inside_once_and_what_is_inside_stays(
    angles: tuple[float, float, float], a: float, b: float, ends: tuple[float, float]
) -> None:
    twist = tuple(np.degrees(sorted(ends)).tolist())
    found, margin = pull(angles, swing=(a, b), twist=twist)
    again, left = pull(found, swing=(a, b), twist=twist)
    np.testing.assert_allclose(hpb_to_matrix(again), hpb_to_matrix(found), atol=1e-9)
    assert left > -1e-9
    if margin > 1e-9:
        np.testing.assert_array_equal(found, angles)


@settings(max_examples=300, deadline=None)
@given(st.tuples(ANGLES, st.floats(-1.5, 1.5), ANGLES))
def test_swing_and_twist_are_those_of_quaternions(angles: tuple[float, float, float]) -> None:
    """The pulled turn has its swing on the nearest of 2000 points of the ellipse, twist clamped."""
    swing, twist = swing_twist(np.array(angles))
    if np.hypot(*swing) > 3.0:
        return
    found, margin = pull(angles, swing=CONE["swing"], twist=CONE["twist"])
    inner, bank = swing_twist(found)
    a, b = np.radians((60.0, 35.0))
    inside = (swing[0] / a) ** 2 + (swing[1] / b) ** 2 <= 1.0
    around = np.linspace(0.0, 2.0 * np.pi, 2000)
    rim = np.stack([a * np.cos(around), b * np.sin(around)], axis=1)
    least = float(np.linalg.norm(rim - swing, axis=1).min())
    low, high = np.radians((-30.0, 45.0))
    assert bank == pytest.approx(np.clip(twist, low, high), abs=1e-6) or abs(twist) > 2.0
    assert np.linalg.norm(inner - swing) <= (1e-7 if inside else least + 1e-6)
    if inside and low < twist < high:
        assert margin == pytest.approx(min(least, twist - low, high - twist), abs=2e-3)


def limb(joints: int, cone: dict[str, Any] = CONE) -> Chain:
    parts = [Joint(f"j{k}", (0, 0, 1.0 if k else 0.0), limit=cone) for k in range(joints - 1)]
    return Chain([*parts, Joint("end", (0.0, 0.0, 1.0))])


def poses(chain: Chain, count: int, seed: int) -> Array:
    """Ends of random poses inside the cones."""
    generator = np.random.default_rng(seed)
    (a, b), (low, high) = (np.radians(CONE[key]) for key in ("swing", "twist"))  # type: ignore[arg-type]
    angles = np.zeros((count, len(chain), 3))
    for row in range(count):
        for joint in range(len(chain) - 1):
            size, around = np.sqrt(generator.uniform()), generator.uniform(0.0, 2.0 * np.pi)
            swing = turn_by((a * size * np.cos(around), b * size * np.sin(around), 0.0))
            bank = hpb_to_rows((0.0, 0.0, generator.uniform(low, high)))
            angles[row, joint] = rows_to_hpb(multiply(swing, bank), 0.0)
    return forward_kinematics(chain, angles)[0][:, -1]


def least_margin(angles: Array) -> float:
    """Least angle left to the cone over poses and joints but the end [rad]."""
    rows = angles[..., :-1, :].reshape(-1, 3)
    return min(pull(row, swing=CONE["swing"], twist=CONE["twist"])[1] for row in rows)


@pytest.mark.parametrize("joints", [3, 4, 7])
def test_reachable_goals_are_reached_inside_the_cones(joints: int) -> None:
    chain = limb(joints)
    goals = poses(chain, 300, joints)
    found = Solver(chain, registry=REGISTRY, tolerance=1e-4 * chain.length).solve_many(goals)
    assert np.mean(found.reached) >= 0.99
    assert least_margin(found.angles) > -1e-9
    free = Chain([Joint(joint.name, joint.offset) for joint in chain.joints])
    without = Solver(free, registry=REGISTRY).solve_many(goals)
    assert least_margin(without.angles) < -0.1


@pytest.mark.parametrize(
    "options",
    [
        {"max_iterations": -2},
        {"max_iterations": -1},
        {"max_iterations": 0},
        {"finish": "none"},
        {"fk_mix": 0.5},
        {"ik": False},
        {"bank_suppression": {"use": "threshold", "angle": 2.0}, "finish": "none"},
        {"start": "current"},
        {"limit_ease": 20.0},
        {"choose": {"by": "margin"}},
        {"choose": {"by": "nearest"}},
    ],
    ids=str,
)
def test_cones_hold_in_every_stage_and_option(options: dict[str, Any]) -> None:
    chain = limb(4)
    offsets = np.zeros((4, 3))
    offsets[1] = np.radians((100.0, 60.0, -90.0))
    solver = Solver(chain, registry=REGISTRY, **options)
    goals = np.concatenate([poses(chain, 20, 5), [[0.0, 0.0, -2.0], [3.0, 0.0, 0.1], [0, 0, 0]]])
    found = solver.solve_many(goals, fk_offsets=offsets)
    assert np.isfinite(found.angles).all()
    assert least_margin(found.angles) > -1e-9


def test_a_goal_behind_is_blocked_and_the_joints_at_their_cones_are_named() -> None:
    found = Solver(limb(3), registry=REGISTRY).solve((0.0, 0.5, -1.6))
    assert found.status == Status.BLOCKED
    assert "j0 cone" in found.limits_touched()
    many = Solver(limb(3), registry=REGISTRY).solve_many([(0.0, 0.5, -1.6)])
    assert many.single(0).limits_touched() == found.limits_touched()


def test_the_choice_by_margin_keeps_clear_of_the_cones() -> None:
    chain = limb(5)
    goals = poses(chain, 40, 9)
    plain = Solver(chain, registry=REGISTRY).solve_many(goals)
    wide = Solver(chain, registry=REGISTRY, choose={"by": "margin"}).solve_many(goals)
    gains = [
        least_margin(after[None]) - least_margin(before[None])
        for after, before in zip(wide.angles, plain.angles, strict=True)
    ]
    assert min(gains) > -1e-8
    assert np.mean(np.array(gains) > np.radians(1.0)) > 0.5


def test_an_end_with_a_cone_follows_its_goal_as_far_as_that() -> None:
    chain = Chain([*limb(3).joints[:-1], Joint("end", (0, 0, 1.0), limit=CONE)])
    turn = np.radians((170.0, 0.0, 0.0))
    solver = Solver(chain, registry=REGISTRY, end_orientation=1.0)
    found = solver.solve((0.5, 0.5, 1.5), goal_turn=turn)
    assert pull(found.angles[-1], swing=CONE["swing"], twist=CONE["twist"])[1] > -1e-9
    wanted = solver.solve((0.5, 0.5, 1.5)).rotations[-1]
    near = solver.solve((0.5, 0.5, 1.5), goal_turn=rows_to_hpb(wanted.tolist(), 0.0))
    np.testing.assert_allclose(near.rotations[-1], wanted, atol=1e-9)


def test_a_mirrored_chain_makes_the_mirrored_pose() -> None:
    chain, goals = limb(4), poses(limb(4), 20, 3)
    mirror = np.array([-1.0, 1.0, 1.0])
    one = Solver(chain, registry=REGISTRY).solve_many(goals)
    other = Solver(chain.mirrored(), registry=REGISTRY).solve_many(goals * mirror)
    np.testing.assert_allclose(other.positions * mirror, one.positions, atol=1e-6)
    assert chain.mirrored().mirrored().joints == chain.joints


class Third:
    """A plug-in by somebody else: a bone that may not be raised above its parent's level."""

    @staticmethod
    @hookimpl
    def limbik_limits() -> list[Strategy]:
        def level(angles, params, margin):  # type: ignore[no-untyped-def]
            margin[0] = -angles[1]
            angles[1] = min(angles[1], 0.0)

        def broken(angles, params, margin):  # type: ignore[no-untyped-def]
            margin[0] = 0.0
            if angles[1] > 0.01 and angles[0] < -0.1:
                angles[0] = np.nan

        return [Strategy("level", level), Strategy("broken", broken)]


def third(name: str) -> Solver:
    registry = Registry(third_party=False)
    registry.register(Third(), "third")
    chain = Chain([Joint("a", limit=name), *limb(3).joints[1:]])
    return Solver(chain, registry=registry)


def test_a_limit_of_a_third_party_holds() -> None:
    found = third("level").solve_many([(0.2, 1.5, 1.0), (0.9, 1.2, -0.4)])
    assert (found.angles[:, 0, 1] <= 1e-9).all()


def test_a_limit_that_gives_no_number_is_named() -> None:
    with pytest.raises(PluginError, match="broken"):
        third("broken").solve((0.9, 0.9, 0.9))


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(ChainError, match="either a limit of its own or a pitch range"):
        Chain([Joint("a", pitch=(0.0, 1.0), limit=CONE), Joint("b", (0, 0, 1))])
    for options in ({"root_control": "suppress-flip"}, {"bank_lock": True}):
        with pytest.raises(ChainError, match="narrows ranges"):
            Solver(limb(3), registry=REGISTRY, **options)
    with pytest.raises(ChainError, match="no limit is called 'kone'"):
        Solver(limb(3, {"use": "kone"}), registry=REGISTRY)
    bound = REGISTRY.bind("solver", "fabrik")
    with pytest.raises(ChainError, match="the solver fabrik does not know it"):
        prepare(bound, limb(3), Settings())


SCENE = b"""\
limbik: 1
chain:
  joints:
    - {name: shoulder, limit: {use: cone, swing: [20, 20], twist: [-10, 10]}}
    - {name: hand, offset: [0, 0, 2]}
goals: [{position: [0, 1.92, 0.56]}]
"""


def test_a_scene_names_a_joints_limit() -> None:
    scene = scene_from(read_yaml(SCENE, "shoulder.yaml"), Path(), REGISTRY)
    (found,) = solve_scene(scene, REGISTRY)
    assert found.status == Status.BLOCKED
    tip = found.positions[-1] / 2.0
    assert np.degrees(np.arccos(tip[2])) == pytest.approx(20.0, abs=1e-6)
    assert found.limits_touched() == ("shoulder cone",)
