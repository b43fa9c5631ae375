"""Rotations: numpy face and kernels agree with each other and with what rotations are."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.chain import vector
from limbik.core.goalturn import carried
from limbik.core.kernels import re_aim
from limbik.core.kernels import rotation as kernels
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb, nearest_form, other_form, wrap

ANGLE = st.one_of(
    st.floats(-7.0, 7.0), st.sampled_from([0.0, pi, -pi, pi / 2, -pi / 2, pi / 2 - 1e-8, 1e-12])
)
HPB = st.tuples(ANGLE, ANGLE, ANGLE)
PART = st.one_of(st.floats(-10.0, 10.0), st.sampled_from([0.0, 1.0, -1.0, 1e-9]))
VECTOR = st.tuples(PART, PART, PART)


def rx(a: float) -> Array:
    return np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])


def ry(a: float) -> Array:
    return np.array([[np.cos(a), 0, -np.sin(a)], [0, 1, 0], [np.sin(a), 0, np.cos(a)]])


def rz(a: float) -> Array:
    return np.array([[np.cos(a), np.sin(a), 0], [-np.sin(a), np.cos(a), 0], [0, 0, 1]])


@given(hpb=HPB)
def test_a_rotation_is_heading_times_pitch_times_bank(hpb: tuple[float, float, float]) -> None:
    h, p, b = hpb
    np.testing.assert_allclose(hpb_to_matrix(hpb), ry(h) @ rx(p) @ rz(b), atol=1e-14)


@given(hpb=HPB)
def test_matrices_are_rotations(hpb: tuple[float, float, float]) -> None:
    m = hpb_to_matrix(hpb)
    np.testing.assert_allclose(m @ m.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(m) == pytest.approx(1.0)


@given(hpb=HPB)
def test_angles_of_a_matrix_give_the_matrix_back(hpb: tuple[float, float, float]) -> None:
    """Near a pitch of ±90° a matrix holds its angles to half the digits only."""
    m = hpb_to_matrix(hpb)
    back = matrix_to_hpb(m)
    np.testing.assert_allclose(hpb_to_matrix(back), m, atol=1e-8)
    assert abs(back[1]) <= pi / 2 + 1e-15


@given(hpb=HPB)
def test_other_form_is_the_same_rotation(hpb: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(hpb_to_matrix(other_form(hpb)), hpb_to_matrix(hpb), atol=1e-13)


@given(angle=ANGLE)
def test_wrap_gives_the_same_direction_above_minus_180_up_to_180(angle: float) -> None:
    for turned in (float(wrap(angle)), kernels.wrap_angle(angle)):
        assert -pi < turned <= pi
        assert np.cos(turned) == pytest.approx(np.cos(angle), abs=1e-14)
        assert np.sin(turned) == pytest.approx(np.sin(angle), abs=1e-14)


@pytest.mark.parametrize(("angle", "wrapped"), [(pi, pi), (-pi, pi), (3 * pi, pi), (0.5, 0.5)])
def test_half_turns_wrap_to_plus_180(angle: float, wrapped: float) -> None:
    assert float(wrap(angle)) == pytest.approx(wrapped)
    assert kernels.wrap_angle(angle) == pytest.approx(wrapped)


@given(hpb=HPB, reference=HPB)
def test_nearest_form_keeps_the_rotation_and_is_nearest(
    hpb: tuple[float, float, float], reference: tuple[float, float, float]
) -> None:
    near = nearest_form(hpb, reference)
    np.testing.assert_allclose(hpb_to_matrix(near), hpb_to_matrix(hpb), atol=1e-12)
    turns = 2 * pi * np.stack(np.meshgrid(*[range(-3, 4)] * 3), -1).reshape(-1, 3)
    forms = np.concatenate([np.add(hpb, turns), other_form(hpb) + turns])
    best = np.linalg.norm(forms - reference, axis=1).min()
    assert np.linalg.norm(near - reference) == pytest.approx(best, abs=1e-9)


@given(hpb=HPB, reference=HPB)
def test_kernels_compute_what_the_numpy_face_does(
    hpb: tuple[float, float, float], reference: tuple[float, float, float]
) -> None:
    m = kernels.hpb_to_matrix(hpb)
    np.testing.assert_allclose(m, hpb_to_matrix(hpb), atol=1e-15)
    np.testing.assert_allclose(hpb_to_matrix(kernels.matrix_to_hpb(m, reference[2])), m, atol=1e-8)
    ours = kernels.nearest_form(hpb, reference)
    theirs = nearest_form(hpb, reference)
    assert np.linalg.norm(np.subtract(ours, reference)) == pytest.approx(
        np.linalg.norm(theirs - reference), abs=1e-12
    )
    np.testing.assert_allclose(
        hpb_to_matrix(kernels.other_form(hpb)), hpb_to_matrix(hpb), atol=1e-13
    )


@given(HPB, HPB)
def test_a_turn_given_in_axes_is_carried_by_them(
    axes: tuple[float, float, float], turn: tuple[float, float, float]
) -> None:
    frame = hpb_to_matrix(axes)
    found = carried(frame, np.array(turn))
    np.testing.assert_allclose(hpb_to_matrix(found), frame @ hpb_to_matrix(turn), atol=1e-8)
    assert np.isnan(carried(frame, np.full(3, np.nan))).all()


@pytest.mark.parametrize("pitch", [pi / 2, -pi / 2])
@pytest.mark.parametrize("bank", [0.0, 0.4, -2.0])
def test_upright_angles_keep_the_bank_they_are_given(pitch: float, bank: float) -> None:
    """3D A-62: heading and bank turn about one axis there."""
    m = hpb_to_matrix((0.3, pitch, 0.9))
    found = kernels.matrix_to_hpb(m.tolist(), bank)
    assert found[2] == bank
    np.testing.assert_allclose(hpb_to_matrix(found), m, atol=1e-12)


@given(axis=VECTOR, v=VECTOR, angle=ANGLE)
def test_turning_keeps_length_and_the_angle_to_the_axis(
    axis: tuple[float, float, float], v: tuple[float, float, float], angle: float
) -> None:
    unit = kernels.unit(axis)
    if not kernels.has_direction(unit):
        unit = (0.0, 0.0, 1.0)
    turned = np.array(kernels.turned(v, unit, angle))
    assert np.linalg.norm(turned) == pytest.approx(np.linalg.norm(v), abs=1e-12)
    assert turned @ unit == pytest.approx(np.dot(v, unit), abs=1e-12)
    matrix = np.array(kernels.turn_about(unit, angle))
    np.testing.assert_allclose(matrix @ v, turned, atol=1e-12)


@given(a=VECTOR, b=VECTOR)
def test_turning_about_their_cross_product_carries_one_vector_to_the_other(
    a: tuple[float, float, float], b: tuple[float, float, float]
) -> None:
    one, other = kernels.unit(a), kernels.unit(b)
    axis = kernels.unit(kernels.cross(one, other))
    if not kernels.has_direction(axis):
        return
    angle = kernels.angle_between(one, other)
    np.testing.assert_allclose(kernels.turned(one, axis, angle), other, atol=1e-9)


@given(v=VECTOR, direction=VECTOR)
def test_across_is_a_unit_vector_at_a_right_angle_or_zero(
    v: tuple[float, float, float], direction: tuple[float, float, float]
) -> None:
    unit = kernels.unit(direction)
    side = np.array(kernels.across(v, unit))
    if kernels.has_direction(unit) and side.any():
        assert np.linalg.norm(side) == pytest.approx(1.0)
        assert abs(side @ unit) < 1e-12


@pytest.mark.parametrize("small", [1e-3, 1e-8, 1e-12])
def test_small_angles_between_vectors_keep_their_digits(small: float) -> None:
    """An arc cosine would give 0 below 1e-8 (3D A-32)."""
    found = kernels.angle_between((1.0, 0.0, 0.0), (np.cos(small), np.sin(small), 0.0))
    assert found == pytest.approx(small, rel=1e-9)


BOUND = st.one_of(st.floats(-3.1, 3.1), st.sampled_from([0.0, -pi, pi]))


@given(st.data(), VECTOR, VECTOR)
def test_re_aim_stays_in_the_limits_and_never_makes_the_angle_larger(
    data: st.DataObject, v: tuple[float, float, float], w: tuple[float, float, float]
) -> None:
    """3D A-51: what a per-axis clamp cannot promise."""
    pairs = [sorted((data.draw(BOUND), data.draw(BOUND))) for _ in range(3)]
    low, high = vector([pair[0] for pair in pairs]), vector([pair[1] for pair in pairs])
    angles = vector([data.draw(st.floats(*pair)) for pair in pairs])
    operating, aim = kernels.unit(v), kernels.unit(w)
    found, turn = re_aim.re_aim(angles, low, high, operating, aim)
    np.testing.assert_allclose(turn, hpb_to_matrix(found), atol=1e-15)
    before = np.array(aim) @ hpb_to_matrix(angles) @ operating
    after = np.array(aim) @ hpb_to_matrix(found) @ operating
    assert after >= before - 1e-12
    assert (np.array(found) >= low).all()
    assert (np.array(found) <= high).all()


@given(best=st.floats(-3.14, 3.14), current=st.floats(-3.0, 3.0), pair=st.tuples(BOUND, BOUND))
def test_nearest_in_range_is_nearest_on_the_circle(
    best: float, current: float, pair: tuple[float, float]
) -> None:
    low, high = sorted(pair)
    found = re_aim.nearest_in_range(best, current, low, high)
    grid = np.linspace(low, high, 500)
    assert low <= found <= high
    assert abs(float(wrap(found - best))) <= np.abs(wrap(grid - best)).min() + 1e-8
