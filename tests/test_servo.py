"""Servo profiles: ticks and back, ranges that are kept, files that say what is wrong."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.errors import InputError, SceneError
from limbik.core.pose import forward_kinematics
from limbik.core.solution import Solution, Status
from limbik.plugins.output.servo import Servo, read_profile

CHAIN = Chain(
    [
        Joint.degrees("waist", pitch=(0, 0), bank=(0, 0)),
        Joint.degrees("elbow", (0, 0, 30), heading=(0, 0), bank=(0, 0)),
        Joint.degrees("wrist", (0, 0, 20)),
    ]
)
PROFILE = """\
servo: 1
joints:
  waist heading: {id: 4}
  elbow pitch: {id: 7, direction: -1, offset: 10, rounding: truncate}
"""


def solution(waist: float, elbow: float) -> Solution:
    """A pose in degrees, with its end as the goal."""
    angles = np.radians([[waist, 0.0, 0.0], [0.0, elbow, 0.0], [0.0, 0.0, 0.0]])
    positions, rotations = forward_kinematics(CHAIN, angles)
    nothing = np.zeros(3)
    return Solution(
        CHAIN, positions[-1], angles, positions, rotations, 0, 0.0, Status.REACHED, nothing, 0.0
    )


@pytest.fixture
def profile_file(tmp_path: Path) -> Path:
    path = tmp_path / "mine.yaml"
    path.write_text(PROFILE, encoding="utf-8")
    return path


def test_the_built_in_profile_numbers_the_axes_that_turn() -> None:
    pose = read_profile("ax-12", CHAIN).quantise(solution(45.0, -30.0))
    told = [(c.joint, c.axis, c.id, c.tick) for c in pose.commands]
    assert told == [("waist", "heading", 1, 665), ("elbow", "pitch", 2, 410)]


def test_a_profile_file_sets_number_direction_offset_and_rounding(profile_file: Path) -> None:
    """The elbow: 512 - (60 + 10) x 3.41 = 273.3."""
    pose = read_profile(profile_file, CHAIN).quantise(solution(0.0, 60.0))
    assert [(c.id, c.tick) for c in pose.commands] == [(4, 512), (7, 273)]


def test_achieved_is_the_pose_of_the_ticks(profile_file: Path) -> None:
    profile = read_profile(profile_file, CHAIN)
    given_pose = solution(33.3, 12.3)
    pose = profile.quantise(given_pose)
    back = profile.angles({c.id: c.tick for c in pose.commands}, CHAIN)
    positions, _ = forward_kinematics(CHAIN, back)

    np.testing.assert_allclose(pose.angles, back)
    np.testing.assert_allclose(pose.position, positions[-1])
    assert 0.0 < pose.distance < 0.5
    assert pose.distance == pytest.approx(np.linalg.norm(positions[-1] - given_pose.goal))


def test_an_angle_out_of_range_names_joint_angle_range_and_goal(profile_file: Path) -> None:
    with pytest.raises(InputError) as caught:
        read_profile(profile_file, CHAIN).quantise(solution(170.0, -165.5), "far left")
    first, second = caught.value.faults
    assert "goal 'far left': waist heading is at 170.00°, servo 4 turns -150.15° to 149.85°" in str(
        first
    )
    assert "elbow pitch is at -165.50°" in str(second)


@given(angle=st.floats(-150.1, 149.8), direction=st.sampled_from([1, -1]))
def test_a_tick_read_back_is_within_half_a_tick(angle: float, direction: int) -> None:
    servo = Servo(id=1, direction=direction)  # type: ignore[arg-type] # 1 or -1
    tick = servo.tick(float(np.radians(direction * angle)))
    assert servo.accepts(tick)
    assert abs(np.degrees(servo.angle(tick)) - direction * angle) <= 0.5 / servo.density + 1e-9


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("waist heading", "waist yaw"), "'waist yaw' must be a joint of the chain and an axis"),
        (("id: 7", "id: 4"), "the servo 4 turns 'waist heading' already"),
        (("direction: -1", "direction: 2"), "direction"),
        (("servo: 1", "servo: 1\nmodel: ax-21"), "did you mean 'ax-12'"),
        (("offset: 10", "ofset: 10"), "did you mean 'offset'"),
    ],
)
def test_a_wrong_profile_is_refused_with_its_line(
    tmp_path: Path, change: tuple[str, str], words: str
) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(PROFILE.replace(*change), encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        read_profile(path, CHAIN)
    assert words in str(caught.value)
    assert caught.value.faults[0].line > 0


def test_an_unknown_built_in_profile_lists_those_there_are() -> None:
    with pytest.raises(InputError, match=r"no servo profile is called 'ax-21'.*ax-12"):
        read_profile("ax-21", CHAIN)


def test_a_tick_the_servo_does_not_have_is_refused() -> None:
    with pytest.raises(InputError, match="servo 2 needs a tick 0 to 1023, found 1024"):
        read_profile("ax-12", CHAIN).angles({1: 0, 2: 1024}, CHAIN)
