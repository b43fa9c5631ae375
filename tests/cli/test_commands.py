"""What each command does when all is well."""

import io
import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import limbik
from limbik.core.pose import forward_kinematics
from limbik.core.scene import read_scene
from limbik.plugins.output.templates import TEMPLATES

Run = Callable[..., tuple[int, str, str]]


def without_compiling(text: str) -> str:
    """Stderr without the line that says that machine code is being compiled."""
    return "".join(line for line in text.splitlines(True) if "compiling" not in line)


def test_version_names_the_package_and_its_version(run: Run) -> None:
    assert run("--version") == (0, f"limbik {limbik.__version__}\n", "")


@pytest.mark.parametrize("arguments", [(), ("--help",), ("-h",)])
def test_help_lists_every_command(run: Run, arguments: tuple[str, ...]) -> None:
    status, out, _ = run(*arguments)

    assert status == 0
    assert [word for word in ("solve", "check", "init", "plugins") if word not in out] == []


@pytest.mark.parametrize("command", ["solve", "check", "init", "plugins"])
def test_every_command_has_help_with_an_example(run: Run, command: str) -> None:
    status, out, _ = run(command, "--help")

    assert status == 0
    assert f"limbik {command}" in out.split("Usage", 1)[1].split("\n", 1)[1]


def test_solve_prints_a_row_for_each_goal_and_ends_with_0(run: Run, scene: str) -> None:
    status, out, err = run("solve", scene)

    assert status == 0
    assert [line.split()[:2] for line in out.splitlines()[2:4]] == [
        ["near", "reached"],
        ["low", "reached"],
    ]
    assert out.splitlines()[-1] == "2 of 2 goals reached"
    assert without_compiling(err) == ""


def test_a_goal_out_of_reach_ends_with_1(run: Run, far: str) -> None:
    status, out, _ = run("solve", far)

    assert status == 1
    assert out.splitlines()[-1] == "1 of 2 goals reached"


def test_json_holds_angles_that_reach_the_goal(run: Run, scene: str) -> None:
    status, out, _ = run("solve", scene, "--json")
    record = json.loads(out)
    chain = read_scene(scene).chain

    assert (status, record["schema"], record["status"]) == (0, 1, "ok")
    assert record["joints"] == ["shoulder", "elbow", "wrist"]
    for goal in record["goals"]:
        positions, _ = forward_kinematics(chain, np.radians(goal["angles"]))
        distance = np.linalg.norm(positions[-1] - goal["position"])
        np.testing.assert_allclose(positions, goal["positions"], atol=1e-9)
        np.testing.assert_allclose(distance, goal["distance"], atol=1e-9)
        assert goal["reached"] is True


def test_json_says_which_goal_was_missed(run: Run, far: str) -> None:
    status, out, _ = run("solve", far, "--json")
    record = json.loads(out)

    assert (status, record["status"]) == (1, "unreached")
    assert [(goal["name"], goal["reached"]) for goal in record["goals"]] == [
        ("near", True),
        ("low", False),
    ]


def test_trace_puts_every_stage_into_the_json(run: Run, scene: str) -> None:
    _, plain, _ = run("solve", scene, "--json")
    _, traced, _ = run("solve", scene, "--json", "--trace")
    stages = json.loads(traced)["goals"][0]["stages"]

    assert "stages" not in json.loads(plain)["goals"][0]
    assert [stage["name"] for stage in stages[:3]] == ["initial", "aim", "bend"]


def test_csv_holds_the_same_numbers_as_json(run: Run, scene: str, tmp_path: Path) -> None:
    _, out, _ = run("solve", scene, "--json", "--csv", "out.csv")
    header, *rows = [
        line.split(",") for line in (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()
    ]

    assert header[:7] == ["name", "x", "y", "z", "status", "distance", "iterations"]
    assert header[7:10] == ["shoulder heading", "shoulder pitch", "shoulder bank"]
    for row, goal in zip(rows, json.loads(out)["goals"], strict=True):
        assert row[0] == goal["name"]
        assert [float(cell) for cell in row[1:4]] == goal["position"]
        assert [float(cell) for cell in row[7:]] == [a for joint in goal["angles"] for a in joint]


def test_a_csv_result_is_a_goal_file_again(
    run: Run, scene: str, tmp_path: Path, scene_text: str
) -> None:
    run("solve", scene, "--csv", "out.csv")
    (tmp_path / "again.yaml").write_text(
        scene_text.split("goals:")[0] + "goals: {csv: out.csv}\n", encoding="utf-8"
    )

    assert run("solve", "again.yaml")[0] == 0


def test_a_scene_may_come_from_standard_input(
    run: Run, monkeypatch: pytest.MonkeyPatch, scene_text: str
) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(scene_text.encode())))
    status, out, _ = run("solve", "-", "--json")

    assert status == 0
    assert json.loads(out)["scene"] == "<stdin>"


def test_check_counts_joints_and_goals(run: Run, scene: str) -> None:
    assert run("check", scene) == (0, "scene.yaml: ok, 3 joints, 2 goals\n", "")
    record = json.loads(run("check", scene, "--json")[1])
    assert record["scenes"] == [
        {"file": "scene.yaml", "joints": ["shoulder", "elbow", "wrist"], "goals": 2}
    ]


def test_check_looks_at_every_scene_and_reports_all_faults(
    run: Run, scene: str, tmp_path: Path
) -> None:
    (tmp_path / "bad.yaml").write_text("- 1\n", encoding="utf-8")
    status, out, err = run("check", "bad.yaml", scene, "none.yaml")

    assert status == 2
    assert out == "scene.yaml: ok, 3 joints, 2 goals\n"
    assert "bad.yaml:1:1: error[type]" in err
    assert "none.yaml: error[unreadable]" in err


@pytest.mark.parametrize("template", TEMPLATES)
def test_init_writes_a_scene_that_is_sound(run: Run, template: str) -> None:
    status, out, _ = run("init", "mine", "--template", template)

    assert (status, out) == (0, "wrote mine.yaml; try: limbik solve mine.yaml\n")
    assert run("check", "mine.yaml")[0] == 0


def test_init_never_overwrites(run: Run, tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text("precious", encoding="utf-8")
    status, _, err = run("init", "mine")

    assert status == 2
    assert "mine.yaml: error[exists]" in err
    assert (tmp_path / "mine.yaml").read_text(encoding="utf-8") == "precious"


def test_init_knows_its_templates(run: Run) -> None:
    status, _, err = run("init", "mine", "--template", "leag")

    assert status == 2
    assert f"no template is called 'leag'; known: {', '.join(TEMPLATES)} (did you mean" in err


def test_plugins_lists_every_strategy_with_parameters(run: Run) -> None:
    status, out, _ = run("plugins")

    assert status == 0
    assert "angle: float = 0.0; -360 to 360; from the root's Y axis about its Z axis [deg]" in out


def test_plugins_as_json_has_ranges_defaults_and_units(run: Run) -> None:
    record = json.loads(run("plugins", "--json")[1])
    manual = next(s for s in record["slots"]["bend_vector"] if s["name"] == "manual")
    angle = next(p for p in manual["parameters"] if p["name"] == "angle")

    assert list(record["slots"]) == [
        "initial_bend",
        "bend_vector",
        "root_control",
        "bank_suppression",
        "finish",
        "limit",
        "solver",
    ]
    assert (angle["default"], angle["ge"], angle["le"], angle["unit"]) == (
        0.0,
        -360.0,
        360.0,
        "degrees",
    )
    assert {plugin["status"] for plugin in record["plugins"] if plugin["distribution"]} >= {
        "loaded"
    }
