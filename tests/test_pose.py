"""Forward kinematics: world of a joint = parent world x frozen x its angles."""

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import hpb_to_matrix
from limbik.tests.limbs import arm, ball


@pytest.mark.parametrize(
    ("angles", "end"),
    [
        ((0, 0, 0), (0, 0, 10)),
        ((90, 0, 0), (-10, 0, 0)),  # heading turns Z toward -X
        ((0, 90, 0), (0, 10, 0)),  # pitch turns Z up
        ((0, 0, 90), (0, 0, 10)),  # bank turns about Z
        ((90, 90, 0), (0, 10, 0)),
    ],
)
def test_angles_turn_the_way_the_conventions_say(
    angles: tuple[float, ...], end: tuple[float, ...]
) -> None:
    positions, _ = forward_kinematics(ball(10.0), np.radians([angles, (0, 0, 0)]))
    np.testing.assert_allclose(positions[-1], end, atol=1e-12)


def test_a_frozen_rotation_comes_before_the_angles() -> None:
    frozen, angles = (0.3, -0.4, 0.5), (0.2, 0.1, -0.6)
    chain = Chain(
        [Joint("a", (1, 2, 3), frozen), Joint("b", (0, 0, 10))], (5, 0, 0), (0.1, 0.2, 0.3)
    )
    positions, rotations = forward_kinematics(chain, [angles, (0, 0, 0)])
    base = hpb_to_matrix((0.1, 0.2, 0.3))
    turned = base @ hpb_to_matrix(frozen) @ hpb_to_matrix(angles)
    np.testing.assert_allclose(rotations[0], turned, atol=1e-15)
    np.testing.assert_allclose(positions[0], base @ [1, 2, 3] + [5, 0, 0], atol=1e-12)
    np.testing.assert_allclose(positions[1], positions[0] + turned @ [0, 0, 10], atol=1e-12)


def test_many_poses_at_once_are_the_poses_one_by_one() -> None:
    poses = np.random.default_rng(2).uniform(-1, 1, (3, 5, 4, 3))
    positions, rotations = forward_kinematics(arm(), poses)
    assert positions.shape == (3, 5, 4, 3)
    assert rotations.shape == (3, 5, 4, 3, 3)
    single, turned = forward_kinematics(arm(), poses[2, 4])
    np.testing.assert_allclose(positions[2, 4], single, atol=1e-12)
    np.testing.assert_allclose(rotations[2, 4], turned, atol=1e-14)


@pytest.mark.parametrize("shape", [(3, 3), (4, 2), (4,)])
def test_angles_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"angles must end in shape \(4, 3\), these have"):
        forward_kinematics(arm(), np.zeros(shape))
