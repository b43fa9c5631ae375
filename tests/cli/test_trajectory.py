"""`limbik trajectory`: the report, the files and what ends it."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

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
