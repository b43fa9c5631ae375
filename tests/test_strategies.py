"""The built-in strategies compute what the document and the readings say, compiled or not."""

from math import acos, asin, cos, degrees, pi, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from limbik.core.binding import Bound
from limbik.core.errors import InputError
from limbik.core.registry import Registry
from limbik.core.slots import SLOTS
from limbik.core.strategy import flatten, unflatten
from limbik.testing import check_strategy, run_native

REGISTRY = Registry(third_party=False)
ALL = [(slot, name) for slot in SLOTS for name in REGISTRY.strategies(slot)]
Array = NDArray[np.float64]


def call(bound: Bound, *arguments: Any) -> list[Any]:
    """Run a strategy in the interpreter on copies of its arguments, the parameters left out."""
    given = [np.array(a, float) if isinstance(a, list | np.ndarray) else a for a in arguments]
    place = SLOTS[bound.slot].names.index("params")
    given.insert(place, unflatten(bound.strategy.params, bound.values))
    bound.strategy.function()(*given)
    return given


def bend(ratio: float, weights: list[float]) -> Array:
    bound = REGISTRY.bind("initial_bend", "nth-root")
    count = len(weights)
    result: Array = call(bound, [1 / count] * count, ratio, weights, [np.nan] * count)[-1]
    return result


def vector(choice: Any, **changes: Any) -> Array:
    """Run a bend-vector mode for a root that stands as the IK space, aiming along Z."""
    arguments = {
        "frame": np.eye(3),
        "aim": [0.0, 0.0, 1.0],
        "end_offset": [0.0, 0.0, 0.0],
        "to_world": np.eye(3),
        "bank": 0.0,
        "previous": [0.0, 0.0, 0.0],
    }
    bound = REGISTRY.bind("bend_vector", choice)
    result: Array = call(bound, *(arguments | changes).values(), [np.nan] * 3)[-1]
    return result


def limits(name: str, root: int, low: list[list[float]], **more: Any) -> tuple[Array, Array]:
    arguments = {"has_previous": 0, "previous": np.zeros((len(low), 3))} | more
    bound = REGISTRY.bind("root_control", name)
    low_high = (np.radians(low), -np.radians(low))
    result = call(bound, root, *arguments.values(), *low_high)
    return np.degrees(result[-2]), np.degrees(result[-1])


def delta(choice: Any, target: list[float], current: list[float], **more: Any) -> list[float]:
    arguments = {"pitch": radians(30.0), "in_ccd": 1, "delta": [0.1, 0.2, 0.3]} | more
    bound = REGISTRY.bind("bank_suppression", choice)
    pitch, in_ccd, change = arguments.values()
    result: list[float] = call(bound, target, current, pitch, in_ccd, change)[-1].tolist()
    return result


@pytest.mark.parametrize(("slot", "name"), ALL)
def test_compiled_and_interpreted_results_agree(slot: str, name: str) -> None:
    check_strategy(slot, REGISTRY.find(slot, name).strategy)


@pytest.mark.parametrize(
    ("slot", "choice"),
    [
        ("bend_vector", {"use": "manual", "angle": 33.0, "exclude_bank": True}),
        ("bend_vector", {"use": "auto", "angle": 10.0, "sensitivity": 0.001, "strength": 0.7}),
        ("bend_vector", {"use": "global", "direction": [0.3, -2.0, 0.1]}),
        ("bank_suppression", {"use": "threshold", "heading_correction": True, "all_stages": True}),
    ],
)
def test_compiled_and_interpreted_results_agree_with_parameters(slot: str, choice: Any) -> None:
    bound = REGISTRY.bind(slot, choice)
    check_strategy(slot, bound.strategy, bound.params)


def test_nth_root_goes_from_the_bend_angle_to_its_opposite() -> None:
    angles = bend(0.5, [1.0, 1.0, 1.0, 1.0])
    assert angles[0] == pytest.approx(acos(0.5))
    assert angles[-1] == pytest.approx(-acos(0.5))
    root = 3 ** (1 / 3)
    assert angles[1:3] == pytest.approx(acos(0.5) * np.array([2 - root, 2 - root**2]))


def test_nth_root_of_two_equal_bones_reaches_the_goal_exactly() -> None:
    angles = bend(0.6, [1.0, 1.0])
    assert np.mean(np.cos(angles)) == pytest.approx(0.6)
    assert np.mean(np.sin(angles)) == pytest.approx(0.0, abs=1e-15)


def test_nth_root_scales_each_bone_by_its_weight() -> None:
    assert bend(0.5, [0.5, -2.0]) == pytest.approx([acos(0.5) / 2, 2 * acos(0.5)])


@pytest.mark.parametrize(("ratio", "angle"), [(1.0, 0.0), (7.0, 0.0), (0.0, pi / 2)])
def test_nth_root_is_straight_out_of_reach_and_square_at_the_root(
    ratio: float, angle: float
) -> None:
    assert bend(ratio, [1.0, 1.0]) == pytest.approx([angle, -angle])


def test_nth_root_leaves_a_single_bone_on_the_line() -> None:
    assert bend(0.5, [1.0]).tolist() == [0.0]


def test_manual_turns_y_toward_x_as_the_bank_of_the_readings_does() -> None:
    assert vector("manual").tolist() == [0.0, 1.0, 0.0]
    turned = vector({"use": "manual", "angle": 90.0})
    assert turned == pytest.approx([1.0, 0.0, 0.0])


def test_manual_follows_the_frame_of_the_root() -> None:
    frame = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    turned = vector({"use": "manual", "angle": 30.0}, frame=frame)
    assert turned == pytest.approx(frame @ [sin(radians(30)), cos(radians(30)), 0.0])


def test_manual_excludes_the_bank_only_when_told() -> None:
    kept = vector({"use": "manual", "angle": 40.0}, bank=radians(15.0))
    assert kept == pytest.approx([sin(radians(40)), cos(radians(40)), 0.0])
    less = vector({"use": "manual", "angle": 40.0, "exclude_bank": True}, bank=radians(15.0))
    assert less == pytest.approx([sin(radians(25)), cos(radians(25)), 0.0])


def auto(**params: Any) -> dict[str, Any]:
    return {"use": "auto", "strength": 1.0, **params}


def test_auto_at_full_strength_points_to_the_miss_across_the_aim() -> None:
    found = vector(auto(), end_offset=[3.0, 4.0, 12.0])
    assert found == pytest.approx([0.6, 0.8, 0.0])


@given(strength=st.floats(0.01, 1.0), at=st.floats(-179.0, 179.0))
@settings(deadline=None)
def test_auto_turns_by_strength_times_the_angle(strength: float, at: float) -> None:
    miss = [sin(radians(at)), cos(radians(at)), 0.0]
    found = vector(auto(strength=strength), end_offset=miss)
    wanted = radians(strength * at)
    assert found == pytest.approx([sin(wanted), cos(wanted), 0.0], abs=2e-6)


@pytest.mark.parametrize(("miss", "found"), [(0.49, 1.0), (0.51, 0.0)])
def test_auto_ignores_a_miss_shorter_than_the_sensitivity(miss: float, found: float) -> None:
    choice = auto(sensitivity=0.5)
    assert vector(choice, end_offset=[miss, 0.0, 9.0])[1] == pytest.approx(found, abs=1e-15)


def test_auto_with_sensitivity_0_is_off() -> None:
    found = vector(auto(sensitivity=0.0, angle=30.0), end_offset=[5.0, 0.0, 0.0])
    assert found == pytest.approx([0.5, sqrt(0.75), 0.0])


def test_auto_turns_about_the_aim_when_the_miss_is_opposite() -> None:
    found = vector(auto(strength=0.5), end_offset=[0.0, -2.0, 0.0])
    assert abs(found[0]) == pytest.approx(1.0)
    assert found[1:] == pytest.approx([0.0, 0.0], abs=1e-15)


@pytest.mark.parametrize("value", [-0.1, 0.0009, 10.1])
def test_auto_refuses_a_sensitivity_out_of_range(value: float) -> None:
    with pytest.raises(InputError):
        REGISTRY.bind("bend_vector", auto(sensitivity=value))


def test_global_is_brought_from_the_world_into_ik_space() -> None:
    axes = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    found = vector({"use": "global", "direction": [1.0, 2.0, 3.0]}, to_world=axes)
    assert axes @ found == pytest.approx([1.0, 2.0, 3.0])


def test_root_control_none_changes_no_limit() -> None:
    low, high = limits("none", 0, [[-170.0, -100.0, -5.0]])
    assert (low.tolist(), high.tolist()) == ([[-170.0, -100.0, -5.0]], [[170.0, 100.0, 5.0]])


def test_suppress_flip_caps_the_pitch_of_the_root_only() -> None:
    low, high = limits("suppress-flip", 1, [[-170.0] * 3, [-170.0] * 3])
    assert high == pytest.approx(np.array([[170.0] * 3, [170.0, 90.0, 170.0]]))
    assert low == pytest.approx(-high)


@pytest.mark.parametrize(("low", "high", "wanted"), [(-30, 120, (-30, 90)), (100, 120, (100, 120))])
def test_suppress_flip_stays_inside_the_joints_own_limits(
    low: float, high: float, wanted: tuple[float, float]
) -> None:
    bound = REGISTRY.bind("root_control", "suppress-flip")
    bottom, top = np.full((1, 3), radians(low)), np.full((1, 3), radians(high))
    result = call(bound, 0, 0, np.zeros((1, 3)), bottom, top)
    assert np.degrees([result[-2][0, 1], result[-1][0, 1]]) == pytest.approx(wanted)


def test_prefer_flip_holds_base_to_root_heading_at_the_previous_pose() -> None:
    previous = np.radians([[10.0, 20.0, 30.0], [40.0, 50.0, 60.0], [70.0, 80.0, 90.0]])
    low, high = limits("prefer-flip", 1, [[-170.0] * 3] * 3, has_previous=1, previous=previous)
    assert low[0] == pytest.approx([10.0, 20.0, 30.0])
    assert high[0] == pytest.approx([10.0, 20.0, 30.0])
    assert (low[1], high[1]) == (
        pytest.approx([40.0, -170.0, -170.0]),
        pytest.approx([40.0, 170.0, 170.0]),
    )
    assert low[2] == pytest.approx([-170.0] * 3)


def test_prefer_flip_holds_inside_the_limits() -> None:
    previous = np.radians([[50.0, 0.0, 0.0]])
    low, high = limits("prefer-flip", 0, [[-20.0, -20.0, -20.0]], has_previous=1, previous=previous)
    assert (low[0, 0], high[0, 0]) == (pytest.approx(20.0), pytest.approx(20.0))


def test_prefer_flip_without_a_previous_pose_holds_nothing() -> None:
    low, _ = limits("prefer-flip", 0, [[-20.0, -20.0, -20.0]])
    assert low == pytest.approx(np.array([[-20.0, -20.0, -20.0]]))


AHEAD = [0.0, 0.0, 1.0]
ASIDE = [1.0, 0.0, 0.0]
NEAR = [sin(radians(1.4)), 0.0, cos(radians(1.4))]


def test_bank_suppression_none_lets_the_bank_pass() -> None:
    assert delta("none", AHEAD, AHEAD) == [0.1, 0.2, 0.3]


@pytest.mark.parametrize(
    ("target", "current", "bank"),
    [(AHEAD, ASIDE, 0.0), (ASIDE, AHEAD, 0.0), (ASIDE, ASIDE, 0.3), ([0.0, 0.0, -1.0], ASIDE, 0.3)],
)
def test_threshold_drops_the_bank_where_either_vector_is_near_z(
    target: list[float], current: list[float], bank: float
) -> None:
    assert delta("threshold", target, current) == [0.1, 0.2, bank]


@pytest.mark.parametrize(("angle", "bank"), [(0.0, 0.3), (1.3, 0.3), (1.5, 0.0), (2.0, 0.0)])
def test_threshold_angle_is_in_degrees(angle: float, bank: float) -> None:
    assert delta({"use": "threshold", "angle": angle}, NEAR, ASIDE)[2] == bank


def test_threshold_gives_the_share_of_the_bank_to_the_heading() -> None:
    choice = {"use": "threshold", "heading_correction": True}
    assert delta(choice, AHEAD, ASIDE) == pytest.approx([0.1 + 0.5 * 0.3, 0.2, 0.0])
    assert delta(choice, ASIDE, ASIDE) == [0.1, 0.2, 0.3]


@pytest.mark.parametrize(("all_stages", "bank"), [(False, 0.3), (True, 0.0)])
def test_threshold_works_before_ccd_only_with_all_stages(all_stages: bool, bank: float) -> None:
    choice = {"use": "threshold", "all_stages": all_stages}
    assert delta(choice, AHEAD, AHEAD, in_ccd=0)[2] == bank


@pytest.mark.parametrize("angle", [-0.1, 2.1])
def test_threshold_refuses_an_angle_out_of_range(angle: float) -> None:
    with pytest.raises(InputError, match="angle"):
        REGISTRY.bind("bank_suppression", {"use": "threshold", "angle": angle})


@given(ratio=st.floats(0.0, 2.0), count=st.integers(1, 12))
@settings(deadline=None, max_examples=60)
def test_nth_root_is_the_same_compiled_for_any_limb(ratio: float, count: int) -> None:
    bound = REGISTRY.bind("initial_bend", "nth-root")
    weights = np.linspace(0.5, 1.5, count)
    arguments = (np.full(count, 1 / count), ratio, weights, None, np.full(count, np.nan))
    native = run_native("initial_bend", bound.strategy, bound.params, arguments)[-1]
    assert np.all(np.isfinite(native))
    assert native == pytest.approx(bend(ratio, weights.tolist()), abs=1e-13)


def test_angle_of_manual_is_read_back_from_its_vector() -> None:
    for angle in (-170.0, -45.0, 10.0, 80.0):
        found = vector({"use": "manual", "angle": angle})
        assert degrees(np.arctan2(found[0], found[1])) == pytest.approx(angle)
    assert degrees(asin(vector({"use": "manual", "angle": 10.0})[0])) == pytest.approx(10.0)


def test_flat_parameters_come_back_in_radians() -> None:
    bound = REGISTRY.bind("bend_vector", {"use": "manual", "angle": 90.0, "exclude_bank": True})
    back = unflatten(bound.strategy.params, flatten(bound.params))
    assert (back.angle, back.exclude_bank) == (pi / 2, True)
