"""Goals: any part of a set is the same whoever makes it."""

from typing import Literal

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.core.rotation import hpb_to_matrix
from limbik.plugins.experiments.goalsets import BLOCK, Grid, Reach, along, middle_of, seed_of
from limbik.tests.limbs import arm, ball

By = Literal["joints", "ball"]
SHIFTED = Chain(
    [Joint("a"), Joint("b", (0.0, 0.0, 3.0)), Joint("c", (0.0, 0.0, 1.0))],
    (5.0, 6.0, 7.0),
    (0.3, 0.2, 0.1),
)


@pytest.mark.parametrize("by", ["joints", "ball"])
@pytest.mark.parametrize(
    ("start", "stop"), [(0, 1), (5, 9), (BLOCK - 1, BLOCK + 1), (BLOCK, 2 * BLOCK), (0, 2500)]
)
def test_a_part_of_a_draw_is_the_same_as_in_the_whole(by: By, start: int, stop: int) -> None:
    whole = Reach(seed_of(7, "reach", 0), by, 0, 3 * BLOCK)

    part = whole.part(start, stop)

    assert len(part) == stop - start
    chain = arm()
    np.testing.assert_array_equal(part.positions(chain), whole.positions(chain)[start:stop])


@pytest.mark.parametrize("other", [seed_of(8, "r", 0), seed_of(7, "s", 0), seed_of(7, "r", 1)])
def test_another_seed_name_or_repeat_draws_other_goals(other: tuple[int, int, int]) -> None:
    first = Reach(seed_of(7, "r", 0), "ball", 0, 50).positions(arm())

    second = Reach(other, "ball", 0, 50).positions(arm())

    assert np.abs(first - second).min() > 0.0


def test_goals_drawn_by_joints_lie_within_the_limits() -> None:
    """With one bone and a pitch of 0..90° all goals lie in that quarter, evenly in the angle."""
    quarter = (0.0, np.pi / 2)
    joints = [
        Joint("a", heading=(0.0, 0.0), pitch=quarter, bank=(0.0, 0.0)),
        Joint("b", (0.0, 0.0, 2.0)),
    ]

    goals = Reach(seed_of(1, "r", 0), "joints", 0, 4000).positions(Chain(joints))

    end = hpb_to_matrix([0.0, np.pi / 4, 0.0]) @ [0.0, 0.0, 2.0]
    np.testing.assert_allclose(np.linalg.norm(goals, axis=1), 2.0, atol=1e-12)
    assert np.abs(goals[:, 0]).max() < 1e-12
    angles = np.arctan2(np.abs(goals[:, 1]), goals[:, 2])
    assert 0.0 <= angles.min() < 0.01
    assert 0.01 > np.pi / 2 - angles.max() >= 0.0
    assert (np.sign(goals[:, 1]) == np.sign(end[1])).mean() > 0.999
    np.testing.assert_allclose(angles.mean(), np.pi / 4, atol=0.03)


def test_goals_in_the_ball_fill_it_evenly_but_for_the_hole() -> None:
    """Bones of 3 and 1: distances 2 to 4 from joint 0, as many in equal volumes."""
    goals = Reach(seed_of(1, "r", 0), "ball", 0, 20_000).positions(SHIFTED) - middle_of(SHIFTED)

    far = np.linalg.norm(goals, axis=1)
    assert 2.0 <= far.min() < far.max() <= 4.0
    np.testing.assert_allclose((far < 3.0).mean(), (27 - 8) / (64 - 8), atol=0.02)
    np.testing.assert_allclose(goals.mean(axis=0), 0.0, atol=0.05)
    np.testing.assert_allclose((goals**2).mean(axis=0), (far**2).mean() / 3.0, rtol=0.03)


def test_a_grid_goes_from_corner_to_corner_in_chain_lengths() -> None:
    grid = Grid((3, 1, 2), (-1.0, -1.0, 0.0), (1.0, 1.0, 0.5), 0, 6)

    goals = grid.positions(SHIFTED) - middle_of(SHIFTED)

    expected = [(x, 0.0, z) for x in (-4.0, 0.0, 4.0) for z in (0.0, 2.0)]
    np.testing.assert_allclose(goals, expected, atol=1e-12)
    part = grid.part(2, 5).positions(SHIFTED) - middle_of(SHIFTED)
    np.testing.assert_allclose(part, expected[2:5], atol=1e-12)


def test_a_path_goes_through_its_corners_at_a_steady_rate() -> None:
    path = along([[0.0, 0.0, 0.0], [0.0, 0.0, 0.6], [0.0, 0.2, 0.6]], 9)

    goals = path.positions(ball(10.0))

    np.testing.assert_allclose(np.linalg.norm(np.diff(goals, axis=0), axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(goals[[0, 6, 8]], [(0, 0, 0), (0, 0, 6), (0, 2, 6)], atol=1e-12)
