"""Key points and quaternions: every way to give a pose means the same pose."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError
from limbik.core.frames import Z_UP
from limbik.core.rotation import matrix_to_quaternion, quaternion_to_matrix
from limbik.plugins.paths.quaternions import double_slerp, slerp
from limbik.trajectory import (
    KeyPoint,
)

scipy_transform = pytest.importorskip("scipy.spatial.transform")
Rotation, Slerp = scipy_transform.Rotation, scipy_transform.Slerp


def point(x: float, y: float, z: float, *turn: float) -> KeyPoint:
    """A key point turned by ZYX angles in degrees."""
    return KeyPoint.from_euler((x, y, z), np.radians(turn or (0.0, 0.0, 0.0)))


A, B, C = point(0, 0, 0), point(1, 0, 0, 90, 0, 0), point(1, 1, 0, 90, 0, 60)
D, E = point(2, 1.2, 0.4, 30, 40, 0), point(2.2, 0, 0.8, 0, 0, 50)


def test_slerp_is_scipys_for_every_sign() -> None:
    random = Rotation.random(40, random_state=3)
    q = random.as_quat()[:, [3, 0, 1, 2]]
    for k in range(0, 40, 2):
        expected = Slerp([0, 1], random[k : k + 2])([0.0, 0.3, 1.0]).as_matrix()
        for sign in (1.0, -1.0):
            found = slerp([0.0, 0.3, 1.0], q[k], sign * q[k + 1])
            np.testing.assert_allclose(quaternion_to_matrix(found), expected, atol=1e-12)


@pytest.mark.parametrize("convention", ["ZYX", "XYZ", "ZXZ", "xyz", "zyx"])
def test_euler_angles_are_read_in_the_convention_named(convention: str) -> None:
    angles = (0.3, -0.7, 1.1)
    found = KeyPoint.from_euler((1, 2, 3), angles, convention)

    expected = Rotation.from_euler(convention, angles).as_matrix()
    np.testing.assert_allclose(found.rotation, expected, atol=1e-12)


def test_a_key_point_is_the_same_by_matrix_quaternion_angles_and_joints() -> None:
    chain = Chain([Joint("a"), Joint("b", offset=(0, 0, 2))])
    angles = np.array([[0.3, -0.4, 0.5], [0.1, 0.2, -0.3]])
    found = KeyPoint.from_joints(chain, angles)

    for other in (
        KeyPoint.from_matrix(found.matrix),
        KeyPoint.from_quaternion(found.position, -found.quaternion),
        KeyPoint.from_rotation(found.position, found.rotation),
        KeyPoint.from_euler(
            found.position, Rotation.from_matrix(found.rotation).as_euler("ZYX"), "ZYX"
        ),
    ):
        np.testing.assert_allclose(other.matrix, found.matrix, atol=1e-12)


def test_right_handed_poses_enter_swapped_and_keep_what_they_do() -> None:
    turned = Rotation.random(random_state=1).as_matrix()
    place = np.array([1.0, 2.0, 3.0])
    found = KeyPoint.from_rotation(place, turned).to_left_handed()

    np.testing.assert_allclose(found.position, [1, 3, 2])
    np.testing.assert_allclose(found.rotation, Z_UP.rotations(turned), atol=1e-12)
    np.testing.assert_allclose(
        found.rotation @ Z_UP.points(place), Z_UP.points(turned @ place), atol=1e-12
    )


@pytest.mark.parametrize(
    ("matrix", "word"),
    [
        (np.diag([1.0, 1.0, -1.0, 1.0]), "mirrors"),
        (np.diag([2.0, 1.0, 1.0, 1.0]), "length 1"),
        (np.diag([1.0, 1.0, 1.0, 2.0]), "last row"),
        (np.full((4, 4), np.nan), "finite"),
        (np.eye(3), "shape"),
    ],
)
def test_a_matrix_that_is_no_pose_is_refused(matrix: Any, word: str) -> None:
    with pytest.raises(InputError, match=word):
        KeyPoint.from_matrix(matrix)


def test_double_slerp_keeps_the_ends_and_misses_the_middle() -> None:
    q = [matrix_to_quaternion(k.rotation) for k in (A, B, C)]
    found = double_slerp(np.array([0.0, 0.5, 1.0]), *q)

    np.testing.assert_allclose(quaternion_to_matrix(found[0]), A.rotation, atol=1e-12)
    np.testing.assert_allclose(quaternion_to_matrix(found[2]), C.rotation, atol=1e-12)
    assert np.abs(quaternion_to_matrix(found[1]) - B.rotation).max() > 0.1
