"""Solvers on the command line: side by side, and as servo commands."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]
CONFIGS = Path(__file__).parents[2] / "configs"
PLANAR, ARM = str(CONFIGS / "planar.yaml"), str(CONFIGS / "cosine-arm.yaml")
PROFILE = str(CONFIGS / "servos" / "cosine-arm.yaml")


def test_compare_shows_what_each_solver_reaches(run: Run) -> None:
    status, out, _ = run("compare", PLANAR, "--solvers", "article-fabrik-limit, planar-fabrik")
    assert status == 1  # one of them leaves goals out
    assert "article-fabrik-limit: 7 of 10 goals reached" in out
    assert "planar-fabrik: 10 of 10 goals reached" in out


def test_compare_counts_broken_limits_and_ends_with_0_if_all_is_reached(run: Run) -> None:
    status, out, _ = run("compare", PLANAR, "--solvers", "planar-ccd,planar-fabrik", "--json")
    record = json.loads(out)
    assert (status, record["status"]) == (0, "ok")
    assert list(record["solvers"]) == ["planar-ccd", "planar-fabrik"]
    assert all(goal["broken_limits"] == 0 for goal in record["solvers"]["planar-ccd"])

    _, out, _ = run("compare", PLANAR, "--solvers", "article-ccd", "--json")
    assert any(goal["broken_limits"] for goal in json.loads(out)["solvers"]["article-ccd"])


def test_compare_draws_solvers_goals_and_outcomes(run: Run, tmp_path: Path) -> None:
    mpl = pytest.importorskip("matplotlib")
    with mpl.rc_context({"svg.fonttype": "none"}):
        run("compare", PLANAR, "--solvers", "article-ccd,planar-ccd", "--plot", "c.svg")
    picture = (tmp_path / "c.svg").read_text(encoding="utf-8")
    words = ("article-ccd", "planar-ccd", "goal 1", "1 limit broken", "z to the right", "5 more")
    assert [word for word in words if word not in picture] == []


def test_compare_takes_limbik_s_own_solver_too(run: Run, scene: str) -> None:
    status, out, _ = run("compare", scene, "--solvers", "3d")
    assert status == 0
    assert "3d: 2 of 2 goals reached" in out


def test_compare_names_every_solver_that_does_not_fit(run: Run) -> None:
    status, out, err = run("compare", PLANAR, "--solvers", "cosine-arm,planar-cd")
    assert (status, out) == (2, "")
    assert "--solvers cosine-arm" in err
    assert "did you mean 'planar-ccd'" in err


def test_the_printed_example_comes_out_as_printed_ticks(run: Run, tmp_path: Path) -> None:
    """(70, 70, 130) of the source is (70, 130, 70) here."""
    status, out, _ = run("solve", ARM, "--servo", PROFILE, "--json")
    first = json.loads(out)["goals"][0]["servo"]
    assert status == 0
    assert [command["tick"] for command in first["commands"]] == [665, 623, 284]
    assert 0.0 < first["distance"] < 1.0

    _, out, _ = run("solve", ARM, "--servo", PROFILE)
    line = next(line for line in reversed(out.splitlines()) if "printed example" in line)
    assert line.split()[2:5] == ["665", "623", "284"]


def test_an_angle_past_a_servo_s_range_ends_with_2_and_names_the_joint(
    run: Run, tmp_path: Path
) -> None:
    """Free at the waist and bending one way only, the arm turns past what its servo can."""
    text = Path(ARM).read_text(encoding="utf-8")
    text = text.replace("heading: [-150.1, 149.8]", "heading: [-180, 180]")
    text = text.replace("pitch: [-150.1, 149.8]", "pitch: [0, 149.8]")
    goals = "goals:\n  - {name: behind, position: [-110, 100, 1]}\n"
    (tmp_path / "a.yaml").write_text(text[: text.index("goals:")] + goals, encoding="utf-8")
    status, out, err = run("solve", "a.yaml", "--servo", "ax-12")
    assert (status, out) == (2, "")
    assert "goal 'behind': waist heading is at 179.48°, servo 1 turns -150.15° to 149.85°" in err
