"""Trajectories: speed is the profile's, limits hold, corners are smooth, errors say what fits."""

from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.plugins.paths.cubic import spline
from limbik.plugins.paths.moves import Junction, Move
from limbik.trajectory import (
    Arc,
    ArcAbout,
    Blend,
    KeyPoint,
    Limits,
    Line,
    Overlap,
    Samples,
    Spline,
    Stop,
    Trajectory,
    Turn,
    plan,
)

pytest.importorskip("scipy")
LIMITS = Limits(0.5, 1.0)
SOFT = Limits(0.5, 1.0, jerk=4.0)


def point(x: float, y: float, z: float, *turn: float) -> KeyPoint:
    """A key point turned by ZYX angles in degrees."""
    return KeyPoint.from_euler((x, y, z), np.radians(turn or (0.0, 0.0, 0.0)))


A, B, C = point(0, 0, 0), point(1, 0, 0, 90, 0, 0), point(1, 1, 0, 90, 0, 60)
D, E = point(2, 1.2, 0.4, 30, 40, 0), point(2.2, 0, 0.8, 0, 0, 50)
SHAPES: dict[str, list[Move | Junction]] = {
    "line": [Line(B)],
    "arc": [Arc(B, C)],
    "long arc": [Arc(point(0.1, 0.05, 0), point(0.05, -0.02, 0))],
    "full circle": [Arc(B, C, full=True)],
    "arc about": [ArcAbout((0.3, 0.2, 0), (0, 1, 1), -5.0)],
    "spline": [Spline([B, C, D, E])],
    "uniform spline": [Spline([B, C, D, E], parameter="uniform", orientation="parameter")],
    "chord spline": [Spline([point(0.01, 0.3, 0), C, D], parameter="chord")],
    "corner": [Line(B), Blend(0.2, 0.3), Line(C)],
    "corner at one speed": [Line(B), Blend(0.3, speed="min"), Arc(C, D), Blend(0.1), Line(E)],
}


def travelled(trajectory: Trajectory, t: np.ndarray[Any, Any], h: float) -> Any:
    """Speeds from positions alone, by differences of fourth order."""
    p = [trajectory.at(t + k * h).positions for k in (-2, -1, 1, 2)]
    return np.linalg.norm((p[0] - 8.0 * p[1] + 8.0 * p[2] - p[3]) / (12.0 * h), axis=1)


def rates_of(trajectory: Trajectory, count: int = 4001) -> Any:
    samples = trajectory.at(np.linspace(0.0, trajectory.duration, count))
    return samples.rotation_speeds()


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("limits", [LIMITS, SOFT], ids=["plain", "jerk"])
def test_the_speed_along_the_path_is_the_profile_within_1e_6(name: str, limits: Limits) -> None:
    found = plan(A, SHAPES[name], limits)
    (piece,) = found.pieces
    t = np.linspace(0.01, found.duration - 0.01, 700)
    h = 1e-4
    bounds = np.array([time for time in piece.profile.times])
    t = t[np.abs(t[:, None] - bounds).min(axis=1) > 3 * h]  # accelerations step at the bounds

    _, expected, _ = piece.profile.at(t)
    np.testing.assert_allclose(travelled(found, t, h), expected, atol=5e-7)
    np.testing.assert_allclose(found.at(t).speeds, expected, atol=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_a_trajectory_begins_and_ends_on_its_key_points(name: str) -> None:
    found = plan(A, SHAPES[name], LIMITS)
    ends = found.at([0.0, found.duration])

    places = [found.key_points[0].position, found.key_points[-1].position]
    np.testing.assert_allclose(ends.positions, places, atol=1e-9)
    turned = [found.key_points[0].rotation, found.key_points[-1].rotation]
    np.testing.assert_allclose(ends.rotations, turned, atol=1e-9)


def test_an_arc_of_three_points_almost_on_a_line_stays_accurate() -> None:
    middle = point(0.5, 2e-6, 0)
    found = plan(A, [Arc(middle, point(1, 0, 0))], LIMITS)
    closest = found.at(np.linspace(0, found.duration, 20001)).positions - middle.position

    assert np.linalg.norm(closest, axis=1).min() < 5e-5
    assert abs(found.pieces[0].legs[0].length - 1.0) < 1e-10
    assert "radius" in found.warnings[0]


def test_the_natural_spline_is_scipys_and_passes_the_points() -> None:
    interpolate = pytest.importorskip("scipy.interpolate")
    places = np.array([k.position for k in (A, B, C, D, E)])
    curve = spline(places, "uniform")
    expected = interpolate.CubicSpline(np.arange(5), places, bc_type="natural")
    s = curve.parameter(x := np.linspace(0.0, curve.knots[-1], 200))

    np.testing.assert_allclose(curve.at(x)[0], expected(s), atol=1e-12)
    np.testing.assert_allclose(curve.at(curve.knots)[0], places, atol=1e-11)


def test_an_uneven_uniform_spline_is_warned_of_and_the_default_is_not() -> None:
    through = [point(10, 0, 0), point(10.5, 0.2, 0), point(20, 0, 0)]
    (warning,) = plan(A, [Spline(through, parameter="uniform")], LIMITS).warnings

    assert "unevenly spaced" in warning
    assert plan(A, [Spline(through)], LIMITS).warnings == ()


def test_ramp_times_keep_accelerations_or_times_on_a_short_way() -> None:
    end = point(0.1, 0, 0)
    found = [
        plan(A, [Line(end)], Limits(0.5, ramp_times=(0.4, 0.6), short=short)).duration
        for short in ("keep-accelerations", "keep-times")
    ]
    assert found == pytest.approx([0.6324555, 1.0])
    assert plan(A, [Line(B)], Limits(0.5, ramp_times=(0.5, 0.5))).duration == pytest.approx(2.5)


def test_rotation_limits_slow_a_short_move_and_are_named() -> None:
    limits = Limits(1.0, 10.0, rotation_speed=1.0, rotation_acceleration=2.0)
    found = plan(A, [Line(point(0.1, 0, 0, 90, 0, 0))], limits)

    assert rates_of(found).max() == pytest.approx(1.0, abs=1e-6)
    named = [stretch.limit for stretch in found.stretches()]
    assert named == ["rotation acceleration", "rotation speed", "rotation deceleration"]


def test_rotation_limits_hold_on_a_spline_with_smoothed_orientation() -> None:
    limits = Limits(2.0, 10.0, rotation_speed=0.5, rotation_acceleration=2.0)
    found = plan(A, [Spline([B, C, D, E], limits, smooth=0.3)])

    assert 0.49 < rates_of(found).max() <= 0.5 * (1 + 1e-3)


def test_a_turn_on_the_spot_stays_there_and_needs_rotation_limits() -> None:
    limits = Limits(0.5, 1.0, rotation_speed=1.0, rotation_acceleration=2.0)
    found = plan(B, [Turn(point(1, 0, 0, 0, 80, 0))], limits)

    assert (found.sample(0.1).positions == B.position).all()
    assert rates_of(found).max() == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(InputError, match="rotation_speed"):
        plan(B, [Turn(point(1, 0, 0, 0, 80, 0))], LIMITS)


def test_a_centripetal_limit_slows_arcs_and_corners() -> None:
    arc = plan(A, [Arc(point(0.1, 0.1, 0), point(0.2, 0, 0))], Limits(5.0, 50.0, centripetal=1.0))
    assert arc.pieces[0].profile.peak ** 2 / 0.1 == pytest.approx(1.0)

    for speed in ("min", "ramp"):
        blend = Blend(0.2, speed=speed, centripetal=0.5)
        found = plan(A, [Line(B), blend, Line(C)], LIMITS)
        (corner,) = (span for span in found.pieces[0].spans if span.name == "corner")
        x = np.linspace(0, corner.high - corner.low, 999)
        bend = corner.source.curve.curvature(x).max()  # type: ignore[union-attr]
        assert corner.phases[0].speed ** 2 * bend == pytest.approx(0.5, rel=1e-4)
        assert corner.phases[0].limit == "centripetal acceleration"


@pytest.mark.parametrize("tangent", ["auto", "sum", "circle", "chord", "parabola", "unit"])
def test_each_tangent_rule_gives_its_own_corner(tangent: Any) -> None:
    """Row A26: lengths of the 90° corner with L1 = L2 = 0.2."""
    lengths = {"auto": 0.3142, "sum": 0.3246, "circle": 0.3142, "chord": 0.3074}
    lengths |= {"parabola": 0.3246, "unit": 0.4551}
    found = plan(A, [Line(B), Blend(0.2, tangent=tangent), Line(C)], LIMITS)
    (corner,) = (span for span in found.pieces[0].spans if span.name == "corner")

    assert corner.high - corner.low == pytest.approx(lengths[tangent], abs=6e-5)


def test_the_default_tangent_changes_to_sum_in_turns_above_150_degrees() -> None:
    back = point(1 - np.cos(0.3), np.sin(0.3), 0)
    found = [
        plan(A, [Line(B), Blend(0.2, tangent=rule), Line(back)], LIMITS).duration
        for rule in ("auto", "sum", "circle")
    ]
    assert found[0] == found[1] != found[2]


@pytest.mark.parametrize("after", [0.2, 0.05])
def test_the_rotation_rate_is_continuous_in_a_corner_unless_linear(after: float) -> None:
    steps = {}
    for way in ("smooth", "linear"):
        blend = Blend(0.2, after, speed="min", orientation=way)
        found = plan(A, [Line(B), blend, Line(C)], LIMITS)
        steps[way] = np.abs(np.diff(rates_of(found, 20001)[200:-200])).max()
    assert steps["smooth"] < 0.01 < 0.1 < steps["linear"]


def test_smoothing_makes_the_rotation_rate_continuous_at_inner_key_points() -> None:
    for drive in ("length", "parameter"):
        jumps = [
            np.abs(np.diff(rates_of(plan(A, [move], LIMITS), 20001)[200:-200])).max()
            for smooth in (0.0, 0.3)
            for move in [Spline([B, C, D], orientation=drive, smooth=smooth)]
        ]
        assert jumps[1] < 0.02 < 0.1 < jumps[0]


def test_ends_passes_the_middle_orientation_by() -> None:
    through, past = (
        plan(A, [Arc(B, point(1, 1, 0), orientation=way)], LIMITS) for way in ("through", "ends")
    )
    assert rates_of(past).max() == pytest.approx(0.0, abs=1e-9)
    assert rates_of(through).max() > 0.5


def test_quaternions_have_no_sign_jumps_whatever_the_signs_given() -> None:
    signs = np.array([1, -1, -1, 1, -1])
    points = [
        KeyPoint(k.position, k.quaternion * s) for k, s in zip((A, B, C, D, E), signs, strict=True)
    ]
    steps: list[Move | Junction] = [Spline(points[1:4]), Stop(), Line(points[4])]
    q = plan(points[0], steps, LIMITS).sample(0.01).quaternions

    assert ((q[1:] * q[:-1]).sum(axis=1) > 0.99).all()


def test_a_half_turn_is_warned_of() -> None:
    (warning,) = plan(A, [Line(point(1, 0, 0, 180, 0, 0))], LIMITS).warnings
    assert "180°" in warning
    assert plan(A, [Line(point(1, 0, 0, 179, 0, 0))], LIMITS).warnings == ()


def test_a_full_overlap_is_the_longest_without_overrun() -> None:
    steps: list[Any] = [Line(B), Overlap(full=True), Line(point(2, 0, 0))]
    (full,) = plan(A, steps, LIMITS).overlaps
    steps[1] = Overlap(full.time * 1.1)
    longer = plan(A, steps, LIMITS)

    assert full.time == pytest.approx(0.5)
    assert full.overrun == 0.0
    assert longer.overlaps[0].overrun == pytest.approx(0.05, rel=0.01)
    assert "longer than the ramps" in longer.warnings[0]


def test_an_overlap_by_cut_passes_the_key_point_at_that_distance() -> None:
    found = plan(A, [Line(B), Overlap(cut=0.02), Line(C)], LIMITS)
    samples = found.at(np.linspace(0, found.duration, 40001))
    gap = np.linalg.norm(samples.positions - B.position, axis=1).min()

    assert gap == pytest.approx(0.02, abs=1e-6)
    assert found.overlaps[0].time == pytest.approx((8 * 0.02 / 2**0.5) ** 0.5, rel=1e-5)


def test_a_pause_holds_the_key_point() -> None:
    plain, paused = (plan(A, [Line(B), Stop(rest), Line(C)], LIMITS) for rest in (0.0, 0.7))
    held = paused.at(np.linspace(2.5, 3.2, 9))

    assert paused.duration == pytest.approx(plain.duration + 0.7)
    np.testing.assert_allclose(held.positions, np.tile(B.position, (9, 1)), atol=1e-12)
    assert held.speeds.max() < 1e-9


def test_samples_end_at_the_end_and_stretched_ones_are_even() -> None:
    found = plan(A, [Line(B)], LIMITS)
    plain, even = found.sample(0.4), found.sample(0.4, stretch=True)

    np.testing.assert_allclose(plain.times, [0, 0.4, 0.8, 1.2, 1.6, 2.0, 2.4, 2.5])
    np.testing.assert_allclose(even.times, np.arange(8) * 0.4)
    np.testing.assert_allclose(even.positions[-1], B.position, atol=1e-12)
    assert even.speeds.max() == pytest.approx(0.5 * 2.5 / 2.8)
    with pytest.raises(InputError, match="at least"):
        found.sample(0.0)


def test_samples_of_a_program_agree_with_those_of_its_times() -> None:
    found = plan(A, [Line(B), Overlap(0.3), Line(C), Blend(0.1), Line(D)], LIMITS)
    samples: Samples = found.sample(0.05)
    single = [found.at([t]).positions[0] for t in samples.times.tolist()]

    np.testing.assert_allclose(samples.positions, single, atol=1e-12)
