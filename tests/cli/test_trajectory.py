"""`limbik trajectory`: the report, the files and what ends it."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from limbik.tests.limbs import POSE_ARM

Run = Callable[..., tuple[int, str, str]]

pytest.importorskip("scipy")
TRAJECTORY = """\
trajectory:
  dt: 0.05
  limits: {speed: 20, acceleration: 40}
  joint_speeds: {shoulder: 200}
  start: near
  program:
    - line: {to: low}
    - blend: {before: 5, speed: min}
    - line: {to: side}
"""


@pytest.fixture
def moving(tmp_path: Path, scene_text: str) -> str:
    """A scene with a motion that can be solved."""
    text = scene_text + "  - {name: side, position: [20, -20, 35]}\n" + TRAJECTORY
    (tmp_path / "moving.yaml").write_text(text, encoding="utf-8")
    return "moving.yaml"


def test_the_report_tells_what_limits_each_stretch(run: Run, moving: str) -> None:
    status, out, _ = run("trajectory", moving)

    assert status == 0
    assert [word for word in ("limited by", "corner", "0 failures") if word not in out] == []


def test_all_files_hold_the_same_motion(run: Run, moving: str, tmp_path: Path) -> None:
    names = ("m.csv", "m.npz", "m.tum", "r.tum")
    files = [f"--{name[2:]}={name}" for name in names[:3]]
    status, out, _ = run("trajectory", moving, "--json", *files)
    run("trajectory", moving, "--tum", "r.tum", "--right-handed")
    record = json.loads(out)
    rows = list(csv.DictReader((tmp_path / "m.csv").read_text(encoding="utf-8").splitlines()))
    arrays = dict(np.load(tmp_path / "m.npz"))
    poses, right = (np.loadtxt(tmp_path / name) for name in names[2:])

    assert (status, record["status"], record["samples"]) == (0, "ok", len(rows))
    x = [float(row["x"]) for row in rows]
    for other in (arrays["positions"][:, 0], poses[:, 1], record["columns"]["x"]):
        np.testing.assert_allclose(other, x, atol=1e-12)
    elbow = [float(row["elbow pitch"]) for row in rows]
    np.testing.assert_allclose(np.degrees(arrays["angles"][:, 1, 1]), elbow, atol=1e-9)
    np.testing.assert_allclose(right[:, [1, 3, 2]], poses[:, 1:4], atol=1e-12)
    np.testing.assert_allclose(arrays["quaternions"], poses[:, [7, 4, 5, 6]], atol=1e-12)
    assert record["duration"] == pytest.approx(arrays["times"][-1])


def test_dt_on_the_command_line_goes_before_the_scenes(run: Run, moving: str) -> None:
    counts = [
        json.loads(run("trajectory", moving, "--json", *more)[1])["samples"]
        for more in ([], ["--dt", "0.025"])
    ]
    assert abs(counts[1] - 2 * counts[0]) <= 2


def test_a_motion_that_fails_ends_with_1_and_says_where(
    run: Run, moving: str, tmp_path: Path
) -> None:
    text = (tmp_path / moving).read_text(encoding="utf-8")
    (tmp_path / "slow.yaml").write_text(text.replace("shoulder: 200", "shoulder: 1"), "utf-8")
    status, out, _ = run("trajectory", "slow.yaml")

    assert status == 1
    assert "failed: " in out
    assert "at most 1°/s" in out


def test_a_picture_names_points_moves_and_joints(run: Run, moving: str, tmp_path: Path) -> None:
    mpl = pytest.importorskip("matplotlib")
    with mpl.rc_context({"svg.fonttype": "none"}):  # text stays text
        status, _, _ = run("trajectory", moving, "--plot", "m.svg")
    picture = (tmp_path / "m.svg").read_text(encoding="utf-8")

    assert status == 0
    words = ("near", "low", "corner", "elbow pitch", "acceleration", "sideways", "every sample")
    assert [word for word in words if word not in picture] == []


def test_a_scene_without_a_trajectory_ends_with_2(run: Run, scene: str) -> None:
    status, out, err = run("trajectory", scene)

    assert (status, out) == (2, "")
    assert "key 'trajectory' is missing" in err


def test_without_scipy_it_ends_with_3_and_names_the_extra(
    run: Run, moving: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    from limbik.plugins.paths import scipy_parts

    text = Path(moving).read_text(encoding="utf-8")
    Path(moving).write_text(text.replace("line: {to: side}", "spline: {through: [side, near]}"))
    scipy_parts.cubic_spline_class.cache_clear()
    monkeypatch.setitem(__import__("sys").modules, "scipy.interpolate", None)
    status, _, err = run("trajectory", moving)

    assert status == 3
    assert "pip install 'limbik[trajectory]'" in err


POSES = (
    POSE_ARM
    + """\
options: {tolerance: 0.0001}
trajectory:
  dt: 0.1
  limits: {speed: 1, acceleration: 2}
  points:
    a: {position: [0, 3, 4], euler: [0, 20, 0], convention: hpb}
    b: {position: [1, 3, 4], euler: [0, 40, 20], convention: hpb}
  start: a
  program: [{line: {to: b}}]
"""
)


def test_without_goals_a_trajectory_solves_position_and_orientation(
    run: Run, tmp_path: Path
) -> None:
    (tmp_path / "poses.yaml").write_text(POSES, encoding="utf-8")
    status, out, _ = run("trajectory", "poses.yaml", "--json", "--npz=p.npz")
    record = json.loads(out)

    assert (status, record["status"], record["orientation_solved"]) == (0, "ok", True)
    assert record["largest_orientation_error"] < 1e-4
    assert np.load(tmp_path / "p.npz")["orientation_error"].max() < 1e-6
    assert run("check", "poses.yaml")[0] == 0
    status, _, err = run("solve", "poses.yaml")
    assert status == 2
    assert "the scene has no goals" in err
    assert "'limbik trajectory'" in err


def test_servo_ticks_go_into_the_files(run: Run, tmp_path: Path) -> None:
    (tmp_path / "poses.yaml").write_text(POSES, encoding="utf-8")
    profile = "servo: 1\njoints:\n  elbow pitch: {id: 5}\n"
    (tmp_path / "servos.yaml").write_text(profile, encoding="utf-8")
    told = ("trajectory", "poses.yaml", "--servo", "servos.yaml")
    status, out, _ = run(*told, "--csv=s.csv", "--npz=s.npz")
    record = json.loads(run(*told, "--json")[1])
    rows = list(csv.DictReader((tmp_path / "s.csv").read_text(encoding="utf-8").splitlines()))
    arrays = dict(np.load(tmp_path / "s.npz"))
    ticks = [int(row["servo 5 elbow pitch"]) for row in rows]

    assert status == 0
    assert "1 servos, off the path by up to" in out
    assert ticks == arrays["servo_ticks"][:, 0].tolist() == record["columns"]["servo 5 elbow pitch"]
    assert arrays["servo_ids"].tolist() == [5]
    elbow = np.array([float(row["elbow pitch"]) for row in rows])
    np.testing.assert_allclose(ticks, 512.0 + elbow * 1023 / 300, atol=0.5)


def test_a_solver_of_positions_alone_is_refused(run: Run, tmp_path: Path) -> None:
    (tmp_path / "f.yaml").write_text(POSES.replace("solver: refine", "solver: fabrik"), "utf-8")
    status, _, err = run("trajectory", "f.yaml")

    assert status == 2
    assert "a trajectory needs 3d or a solver of pose goals, not 'fabrik'" in err


@pytest.mark.parametrize("elbow", [40.0, -40.0])
def test_the_joint_angles_of_the_start_choose_the_fold(
    run: Run, tmp_path: Path, elbow: float
) -> None:
    text = POSES.replace("pitch: [0, 150]", "pitch: [-150, 150]")
    joints = f"a: {{joints: {{shoulder: [0, {-elbow}, 0], elbow: [0, {elbow}, 0]}}}}"
    text = text.replace("a: {position: [0, 3, 4], euler: [0, 20, 0], convention: hpb}", joints)
    (tmp_path / "fold.yaml").write_text(text.replace("[1, 3, 4]", "[0.3, 0, 6]"), encoding="utf-8")
    run("trajectory", "fold.yaml", "--npz=f.npz")
    angles = np.load(tmp_path / "f.npz")["angles"]

    assert np.degrees(angles[0, 1, 1]) == pytest.approx(elbow, abs=1e-4)
    assert (np.sign(angles[:, 1, 1]) == np.sign(elbow)).all()
