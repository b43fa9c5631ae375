"""A scene's trajectory: every kind of point and step is read, and a fault points at its line."""

from pathlib import Path

import numpy as np
import pytest

from limbik.core.errors import SceneError
from limbik.core.registry import Registry
from limbik.core.scene import Scene, scene_from
from limbik.core.yamlfile import read_yaml
from limbik.plugins.paths.scene_program import scene_trajectory
from limbik.trajectory import Trajectory

pytest.importorskip("scipy")
REGISTRY = Registry(third_party=False)
HEAD = """\
limbik: 1
chain:
  joints:
    - {name: hip}
    - {name: knee, offset: [0, 0, 3]}
    - {name: foot, offset: [0, 0, 3]}
goals:
  - {name: a, position: [0, 0, 4]}
  - {name: b, position: [1, 0, 4]}
trajectory:
"""
BODY = """\
  limits: {speed: 0.5, acceleration: 1}
  start: a
  program:
    - line: {to: b}
"""


def scene(body: str = BODY) -> Scene:
    return scene_from(read_yaml(HEAD + body, "s.yaml"), Path("/nowhere"), REGISTRY)


def planned(body: str = BODY) -> Trajectory:
    return scene_trajectory(scene(body))


def faults(body: str) -> list[str]:
    with pytest.raises(SceneError) as caught:
        planned(body)
    return str(caught.value).splitlines()


def with_steps(*steps: str) -> str:
    return BODY + "".join(f"    - {step}\n" for step in steps)


def test_points_without_a_position_are_the_goals_of_their_names() -> None:
    found = planned("  points: {b: {euler: [90, 0, 0], convention: hpb}}\n" + BODY)

    np.testing.assert_allclose(found.key_points[1].position, [1, 0, 4])
    np.testing.assert_allclose(found.key_points[1].rotation[:, 2], [-1, 0, 0], atol=1e-12)


@pytest.mark.parametrize(
    ("point", "place", "forward"),
    [
        ("{position: [1, 2, 3]}", [1, 2, 3], [0, 0, 1]),
        ("{position: [1, 2, 3], quaternion: [0, 1, 0, 0]}", [1, 2, 3], [0, 0, -1]),
        ("{position: [1, 2, 3], euler: [0, 90, 0], convention: ZYX}", [1, 2, 3], [1, 0, 0]),
        (
            "{matrix: [[1, 0, 0, 1], [0, 0, -1, 2], [0, 1, 0, 3], [0, 0, 0, 1]]}",
            [1, 2, 3],
            [0, -1, 0],
        ),
        ("{joints: {hip: [0, 90, 0]}}", [0, 6, 0], [0, 1, 0]),
    ],
)
def test_a_pose_may_be_given_in_every_way(
    point: str, place: list[float], forward: list[float]
) -> None:
    found = planned(f"  points: {{p: {point}}}\n" + BODY.replace("to: b", "to: p")).key_points[1]

    np.testing.assert_allclose(found.position, place, atol=1e-12)
    np.testing.assert_allclose(found.rotation[:, 2], forward, atol=1e-12)


def test_a_right_handed_point_enters_with_y_and_z_exchanged() -> None:
    point = "{position: [1, 2, 3], euler: [0, 0, 90], convention: xyz}"
    body = f"  frame: right-handed\n  points: {{p: {point}}}\n" + BODY.replace("to: b", "to: p")
    found = planned(body).key_points[1]

    np.testing.assert_allclose(found.position, [1, 3, 2])
    np.testing.assert_allclose(found.rotation[:, 0], [0, 0, 1], atol=1e-12)  # its y is our z


def test_every_kind_of_step_is_planned() -> None:
    points = (
        "  points: {c: {position: [1, 1, 4]}, d: {position: [2, 1, 5]}, e: {position: [3, 0, 5]},"
    )
    points += " t: {position: [3, 0, 5], euler: [50, 0, 0], convention: hpb}}\n"
    body = points + with_steps(
        "blend: {before: 0.2, tangent: sum, speed: min}",
        "line: {to: c, limits: {speed: 0.3}}",
        "stop: {}",
        "spline: {through: [d, e], parameter: chord, limits: {ramp_times: [0.5, 0.4]}}",
        "stop: {pause: 1}",
        "turn: {to: t, limits: {rotation_speed: 90, rotation_acceleration: 90}}",
        "line: {to: d}",
        "overlap: {time: 0.1}",
        "arc: {via: c, to: b, smooth: 0.2}",
        "overlap: {full: true}",
        "arc_about: {center: [0, 0, 4], axis: [0, 1, 0], angle: 90}",
    )
    found = planned(body)

    shapes = [span.name for piece in found.pieces for span in piece.spans]
    assert shapes == ["line", "corner", "line", "spline", "turn", "line", "arc", "arc"]
    assert found.pieces[2].profile.peak == pytest.approx((np.radians(50) * np.pi / 2) ** 0.5)
    np.testing.assert_allclose(found.key_points[-1].position, [0, 0, 3], atol=1e-9)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            BODY.replace("to: b", "to: bee"),
            "s.yaml:14:18: error[unknown-point]: trajectory.program[0].line.to: "
            "no point or goal is called 'bee'",
        ),
        (
            with_steps("blend: {before: 7}", "line: {to: a}"),
            "s.yaml:15:14: error[blend]: trajectory.program[1].blend: the blend is longer before "
            "the key point than the segment: 7, at most 1 fits",
        ),
        (
            with_steps("overlap: {time: 7}", "line: {to: a}"),
            "s.yaml:15:16: error[overlap]: trajectory.program[1].overlap: the overlap of 7 s",
        ),
        (
            with_steps("line: {to: b}", "line: {to: b}", "arc: {via: a, to: b}"),
            "s.yaml:17:12: error[arc]: trajectory.program[3].arc: two of the three",
        ),
        (
            BODY.replace("speed: 0.5, ", ""),
            "s.yaml:11:11: error[missing-key]: trajectory.limits: the trajectory's limits need",
        ),
        (
            BODY.replace("line: {to: b}", "line: {to: b, sped: 1}"),
            "s.yaml:14:21: error[unknown-key]: trajectory.program[0].line.sped",
        ),
        (
            "  points: {p: {joints: {kne: [0, 0, 0]}}}\n" + BODY.replace("to: b", "to: p"),
            "s.yaml:11:30: error[unknown-joint]: trajectory.points.p.joints.kne: no joint is",
        ),
        (
            "  points: {p: {}}\n" + BODY.replace("to: b", "to: p"),
            "s.yaml:11:15: error[missing-key]: trajectory.points.p: it needs a position",
        ),
        (
            "  points: {b: {euler: [0, 0, 0], convention: XYQ}}\n" + BODY,
            "s.yaml:11:15: error[key-point]: trajectory.points.b: unknown Euler convention 'XYQ'",
        ),
    ],
)
def test_a_fault_points_at_its_line(body: str, expected: str) -> None:
    (line,) = faults(body)
    assert line.startswith(expected)


@pytest.mark.parametrize(
    ("step", "words"),
    [
        ("{line: {to: b}, stop: {}}", "a step has exactly one of line, turn"),
        ("{}", "a step has exactly one of line, turn"),
    ],
)
def test_a_step_has_exactly_one_key(step: str, words: str) -> None:
    assert words in faults(with_steps(step))[0]


@pytest.mark.parametrize(
    ("point", "words"),
    [
        ("{euler: [0, 0, 0]}", "euler and convention go together"),
        ("{quaternion: [1, 0, 0, 0], joints: {hip: [0, 0, 0]}}", "one orientation, not"),
        ("{position: [0, 0, 0], joints: {hip: [0, 0, 0]}}", "give the position already"),
    ],
)
def test_a_point_that_says_two_things_is_refused(point: str, words: str) -> None:
    assert words in faults(f"  points: {{p: {point}}}\n" + BODY)[0]


def test_a_scene_without_a_trajectory_says_so() -> None:
    text = HEAD.replace("trajectory:\n", "")
    sound = scene_from(read_yaml(text, "s.yaml"), Path("/nowhere"), REGISTRY)
    with pytest.raises(SceneError, match="key 'trajectory' is missing"):
        scene_trajectory(sound)
