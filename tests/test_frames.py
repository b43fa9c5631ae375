"""The change of axes: exact both ways, and a hinge keeps its number."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from limbik.core.frames import Y_UP, Z_UP, Axes, hpb_of, mirror_hpb, rpy_to_matrix, turn_about
from limbik.core.rotation import hpb_to_matrix

ANGLE = st.floats(-7.0, 7.0)
UNIT = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
BOTH = pytest.mark.parametrize("axes", [Z_UP, Y_UP], ids=["z up", "y up"])


def test_ahead_stays_ahead_and_up_becomes_y() -> None:
    np.testing.assert_array_equal(Z_UP.points([1.0, 2.0, 3.0]), [1.0, 3.0, 2.0])
    np.testing.assert_array_equal(Y_UP.points([1.0, 2.0, 3.0]), [-1.0, 2.0, 3.0])


@BOTH
@given(points=st.lists(UNIT, min_size=1, max_size=4), hpb=st.tuples(ANGLE, ANGLE, ANGLE))
def test_twice_gives_the_bits_back(
    axes: Axes, points: list[tuple[float, ...]], hpb: tuple[float, ...]
) -> None:
    matrix = hpb_to_matrix(hpb)
    np.testing.assert_array_equal(axes.points(axes.points(points)), points)
    np.testing.assert_array_equal(axes.rotations(axes.rotations(matrix)), matrix)


@BOTH
@given(axis=UNIT, angle=ANGLE, point=UNIT)
def test_a_turned_point_is_the_changed_point_turned(
    axes: Axes, axis: tuple[float, ...], angle: float, point: tuple[float, ...]
) -> None:
    turn = turn_about(np.array(axis) / np.linalg.norm(axis), angle)
    np.testing.assert_allclose(
        axes.rotations(turn) @ axes.points(point), axes.points(turn @ point), atol=1e-14
    )


@BOTH
@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_hinge_keeps_its_number(axes: Axes, which: int) -> None:
    """A right-handed hinge that becomes limbik's Y, X or Z axis is its heading, pitch or bank."""
    limbik_axis = np.eye(3)[(1, 0, 2)[which]]
    hpb = np.zeros(3)
    hpb[which] = 0.7
    turned = axes.rotations(turn_about(axes.points(limbik_axis), 0.7))
    np.testing.assert_allclose(turned, hpb_to_matrix(hpb), atol=1e-15)


def test_roll_pitch_yaw_turn_about_fixed_axes_in_that_order() -> None:
    roll, pitch, yaw = (turn_about(np.eye(3)[k], a) for k, a in enumerate((0.3, -0.5, 0.9)))
    np.testing.assert_allclose(rpy_to_matrix([0.3, -0.5, 0.9]), yaw @ pitch @ roll, atol=1e-15)


@given(heading=ANGLE, pitch=ANGLE, bank=ANGLE)
@example(heading=0.3, pitch=1.57079632, bank=-0.8)
@example(heading=0.3, pitch=-np.pi / 2, bank=-0.8)
@example(heading=0.3, pitch=np.pi / 2 - 1e-12, bank=2.0)
def test_angles_give_their_matrix_back_even_where_two_axes_meet(
    heading: float, pitch: float, bank: float
) -> None:
    matrix = hpb_to_matrix([heading, pitch, bank])
    np.testing.assert_allclose(hpb_to_matrix(hpb_of(matrix)), matrix, atol=2e-15)


@given(hpb=st.tuples(ANGLE, ANGLE, ANGLE))
def test_mirrored_angles_give_the_mirrored_rotation(hpb: tuple[float, ...]) -> None:
    np.testing.assert_allclose(
        hpb_to_matrix(mirror_hpb(hpb)), Y_UP.rotations(hpb_to_matrix(hpb)), atol=1e-15
    )
