"""Joint motion with pose goals: the orientation is solved too, failures have time and place."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from limbik.core.chain import Chain
from limbik.core.errors import InputError, SceneError
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.scene import Scene, read_scene, scene_from
from limbik.core.solution import Continuity
from limbik.core.yamlfile import read_yaml
from limbik.plugins.output.servo import Profile, Servo
from limbik.plugins.output.servo_motion import servo_motion
from limbik.plugins.paths.scene_program import scene_trajectory
from limbik.plugins.solvers.refine.solver import PoseSolver
from limbik.tests.limbs import POSE_ARM
from limbik.trajectory import KeyPoint, Limits, Line, Samples, Turn, joint_motion, plan

pytest.importorskip("scipy")
CONFIGS = Path(__file__).parents[1] / "configs"
REGISTRY = Registry(third_party=False)
LIMITS = Limits(30.0, 80.0, rotation_speed=2.0, rotation_acceleration=8.0)


def weld() -> Scene:
    return read_scene(CONFIGS / "weld.yaml", REGISTRY)


def bent(chain: Chain, **turns: float) -> KeyPoint:
    """A key point where the arm's own pose is, some joints turned by degrees from rest."""
    return KeyPoint.from_joints(chain, pose(chain, **turns))


def pose(chain: Chain, **turns: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    angles = np.array(chain.rest)
    for name, degrees in turns.items():
        joint = chain.names.index(name)
        angles[joint, 1 if chain.low[joint, 1] < 0.0 else 2] += np.radians(degrees)
    return angles


def straight(start: KeyPoint, end: KeyPoint) -> Samples:
    return plan(start, [Line(end)], LIMITS).sample(0.02)


def test_the_shipped_weld_follows_position_and_orientation() -> None:
    scene = weld()
    samples = scene_trajectory(scene, turning=True).sample(0.02)
    motion = joint_motion(samples, PoseSolver(scene.chain, 1e-4, 1e-6))
    positions, rotations = forward_kinematics(scene.chain, motion.angles)

    assert motion.failures == ()
    assert np.abs(positions[:, -1] - samples.positions).max() < 1e-4
    assert np.abs(rotations[:, -1] - samples.rotations).max() < 1e-6
    assert motion.orientation_error.max() < 1e-6
    assert np.degrees(np.abs(motion.speeds)).max() < 300.0  # and so no jump


def test_a_pose_out_of_reach_is_listed_with_time_place_and_angle() -> None:
    chain = weld().chain
    start = bent(chain)
    far = KeyPoint(start.position + np.array([0.0, 0.0, 60.0]), start.quaternion)
    motion = joint_motion(straight(start, far), PoseSolver(chain))
    kinds = [failure.kind for failure in motion.failures]

    assert kinds[-1] == "out-of-reach"
    last = motion.failures[-1]
    assert last.end == pytest.approx(motion.samples.times[-1])
    assert last.position[2] == pytest.approx(far.position[2])
    assert "out of reach" in str(last)
    assert "turned off by" in str(last)


def test_an_orientation_beyond_the_wrist_fails_though_the_place_is_reached() -> None:
    """Position alone reaches all; with the orientation the wrist is blocked, and it says so."""
    chain = weld().chain
    joints = [replace(j, pitch=(-1.0, 0.2)) if j.name == "wrist" else j for j in chain.joints]
    stiff = Chain(joints)
    start, end = bent(chain), bent(chain, wrist=-60.0)
    turned = KeyPoint(start.position, end.quaternion)
    samples = plan(start, [Turn(turned)], LIMITS).sample(0.02)
    motion = joint_motion(samples, PoseSolver(stiff))
    blocked = [failure for failure in motion.failures if failure.kind == "blocked"]

    assert blocked
    assert blocked[-1].turned > 0.0
    assert blocked[0].start > 0.0


def test_a_change_of_fold_is_a_failure_of_its_own() -> None:
    """The flange turns on past its limit; the arm goes on in another fold, and that is a jump."""
    chain = weld().chain
    begin = pose(chain, forearm=60.0, flange=150.0)
    start = KeyPoint.from_joints(chain, begin)
    on = begin.copy()
    on[5, 2] += np.radians(60.0)
    samples = plan(start, [Turn(KeyPoint.from_joints(chain, on))], LIMITS).sample(0.02)
    motion = joint_motion(samples, PoseSolver(chain), continuity=Continuity.from_pose(begin))
    (jump,) = motion.failures

    assert jump.kind == "jump"
    assert jump.first == jump.last
    assert jump.worst > 1.0
    assert "the arm has to change its fold: " in str(jump)
    np.testing.assert_allclose(motion.angles[0], begin, atol=1e-5)


HEAD = (
    POSE_ARM
    + """\
trajectory:
  limits: {speed: 1, acceleration: 2}
  points:
    a: {position: [0, 3, 4], quaternion: [1, 0, 0, 0]}
    b: {position: [1, 3, 4]}
  start: a
  program: [{line: {to: b}}]
"""
)


def planned(text: str) -> Samples:
    read = scene_from(read_yaml(text, "s.yaml"), Path("/nowhere"), REGISTRY)
    return scene_trajectory(read, turning=True).sample(0.1)


def test_a_point_without_an_orientation_is_refused_where_it_is_solved() -> None:
    with pytest.raises(SceneError, match=r"s\.yaml:15:\d+: error\[missing-key\]: .*'b' needs an o"):
        planned(HEAD)


def test_a_point_has_the_orientation_of_its_goal() -> None:
    text = HEAD.replace("    b: {position: [1, 3, 4]}\n", "")
    goals = "goals: [{name: b, position: [1, 3, 4], rotation: [90, 0, 0]}]\n"
    samples = planned(text + goals)

    np.testing.assert_allclose(samples.positions[-1], [1, 3, 4])
    np.testing.assert_allclose(samples.rotations[-1][:, 2], [-1, 0, 0], atol=1e-12)


def test_servos_get_the_ticks_of_every_sample() -> None:
    chain = weld().chain
    motion = joint_motion(straight(bent(chain), bent(chain, elbow=20.0)), PoseSolver(chain))
    profile = Profile({(1, 1): Servo(id=4), (2, 1): Servo(id=7, direction=-1, offset=90.0)})
    servos = servo_motion(profile, motion)

    assert servos.titles == ["servo 4 shoulder pitch", "servo 7 elbow pitch"]
    degrees = np.degrees(motion.angles[:, [1, 2], 1])
    exact = 512.0 + np.array([1.0, -1.0]) * (degrees + np.array([0.0, 90.0])) * 1023 / 300
    assert np.abs(servos.ticks - exact).max() <= 0.5
    assert 0.0 < servos.distance.max() < 2.0 * 95.0 * np.radians(0.5 * 300 / 1023)


def test_an_angle_no_servo_has_is_refused_with_its_time() -> None:
    chain = weld().chain
    motion = joint_motion(straight(bent(chain), bent(chain, elbow=20.0)), PoseSolver(chain))
    profile = Profile({(2, 1): Servo(id=7, range=150.0)})
    with pytest.raises(InputError, match=r"0 s: elbow pitch is at -90\.00°, servo 7 turns -75"):
        servo_motion(profile, motion)
