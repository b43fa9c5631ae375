"""Scenes with several chains on the command line."""

import csv
import json
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import jsonschema
import pytest
import yaml

from limbik.core.registry import Registry
from limbik.core.schema import scene_schema

Run = Callable[..., tuple[int, str, str]]
BODY = """\
limbik: 1
skeleton:
  joints:
    - {name: hips}
    - {name: chest, parent: hips, offset: [0, 0, 25]}
    - {name: shoulder, parent: chest, offset: [0, 9, 9]}
    - {name: elbow, parent: shoulder, offset: [0, 0, 30]}
    - {name: hand, parent: elbow, offset: [0, 0, 26]}
chains:
  - {name: spine, base: hips, end: chest, goals: [{position: [0, 9, 23.3238075793812]}]}
  - name: arm
    base: shoulder
    end: hand
    options: {off_axis: true}
    goals: [{name: near, position: [0, 20, 60]}, {name: far, position: [0, 30, 70]}]
"""


@pytest.fixture
def body(tmp_path: Path) -> str:
    """A spine and an arm."""
    (tmp_path / "body.yaml").write_text(BODY, encoding="utf-8")
    return "body.yaml"


def test_solve_prints_one_table_a_chain_in_order(run: Run, body: str) -> None:
    status, out, _ = run("solve", body)
    assert status == 0
    assert out.index("spine") < out.index("arm") < out.index("near") < out.index("far")
    assert out.count("2 of 2 goals reached") == 2


def test_a_missed_goal_of_any_chain_ends_with_1(run: Run, body: str) -> None:
    Path(body).write_text(BODY.replace("[0, 30, 70]", "[0, 30, 700]"))
    status, out, _ = run("solve", body)
    assert status == 1
    assert "1 of 2 goals reached" in out


def test_json_has_the_chains_and_the_whole_skeleton(run: Run, body: str) -> None:
    status, out, _ = run("solve", body, "--json", "--trace")
    record = json.loads(out)
    assert (status, record["status"]) == (0, "ok")
    assert [chain["name"] for chain in record["chains"]] == ["spine", "arm"]
    assert record["skeleton"]["parents"] == [-1, 0, 1, 2, 3]
    hand = record["frames"][1]["positions"][record["skeleton"]["joints"].index("hand")]
    assert hand == pytest.approx([0, 30, 70], abs=0.01)
    assert record["chains"][1]["goals"][1]["stages"][0]["name"] == "initial"


def test_csv_has_one_line_a_frame(run: Run, body: str) -> None:
    run("solve", body, "--csv", "body.csv")
    rows = list(csv.DictReader(Path("body.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == ["near", "far"]
    assert [row["arm: status"] for row in rows] == ["reached", "reached"]
    assert rows[0]["spine: hips pitch"] == rows[1]["spine: hips pitch"]


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_plot_draws_the_body(run: Run, body: str, ending: str) -> None:
    if find_spec("matplotlib") is None:
        pytest.skip("matplotlib is not installed")
    status, _, _ = run("solve", body, "--plot", f"body.{ending}")
    assert status == 0
    assert Path(f"body.{ending}").stat().st_size > 10_000
    if ending == "svg":
        text = Path("body.svg").read_text()
        run("solve", body, "--plot", "body.svg")
        assert Path("body.svg").read_text() == text


@pytest.mark.parametrize("ending", ["csv", "json", "npz", "bvh", "glb"])
def test_bake_writes_every_format(run: Run, body: str, ending: str) -> None:
    status, out, _ = run("bake", body, "-o", f"motion.{ending}", "--mirrored")
    assert status == 0
    assert out.count("2 of 2 frames reached") == 2
    assert Path(f"motion.{ending}").stat().st_size > 100


def test_bake_as_json_has_the_metrics_of_each_chain(run: Run, body: str) -> None:
    _, out, _ = run("bake", body, "-o", "motion.csv", "--json", "--follow")
    metrics = json.loads(out)["metrics"]
    assert {name: of["frames"] for name, of in metrics.items()} == {"spine": 2, "arm": 2}


def test_judge_measures_each_chain(run: Run, body: str) -> None:
    judged = BODY.replace(
        "    options: {off_axis", "    judge: {max: {gain: 0}}\n    options: {off_axis"
    )
    Path(body).write_text(judged)
    status, out, _ = run("judge", body, "--json")
    record = json.loads(out)
    assert (status, record["status"]) == (1, "failed")
    assert [chain["name"] for chain in record["chains"]] == ["spine", "arm"]
    assert run("judge", body)[1].count("thresholds hold") == 2


def test_check_counts_chains_and_frames(run: Run, body: str) -> None:
    assert run("check", body)[1] == "body.yaml: ok, 5 joints in 2 chains, 2 frames\n"
    (scene,) = json.loads(run("check", body, "--json")[1])["scenes"]
    assert [chain["name"] for chain in scene["chains"]] == ["spine", "arm"]


@pytest.mark.parametrize(
    "command",
    [("trajectory",), ("compare", "--solvers", "3d,fabrik")],
    ids=["trajectory", "compare"],
)
def test_commands_of_one_chain_refuse_a_body(run: Run, body: str, command: tuple[str, ...]) -> None:
    name, *options = command
    status, out, err = run(name, body, *options)
    assert (status, out) == (2, "")
    assert err.startswith("body.yaml:9:1: error[chains]: chains: this scene has several chains")


def test_servo_refuses_a_body(run: Run, body: str) -> None:
    status, _, err = run("solve", body, "--servo", "ax-12")
    assert status == 2
    assert "--servo: needs a scene with one chain" in err


def test_the_schema_takes_bodies_and_refuses_what_the_models_refuse() -> None:
    validator = jsonschema.Draft202012Validator(scene_schema(Registry(third_party=False)))
    assert validator.is_valid(yaml.safe_load(BODY))
    for old, new in (
        ("limbik: 1", "limbik: 2"),
        ("skeleton:", "skeletton:"),
        ("base: hips", "bass: hips"),
        ("parent: hips", "parent: 3"),
        ("{off_axis: true}", "{of_axis: true}"),
        ("{off_axis: true}", "{bend_vector: manuel}"),
        (
            "    goals: [{name: near, position: [0, 20, 60]}, {name: far, position: [0, 30, 70]}]",
            "",
        ),
        ("    end: hand", "    end: hand\n    axes: x-up"),
    ):
        assert BODY.count(old) == 1
        assert not validator.is_valid(yaml.safe_load(BODY.replace(old, new))), new
    clip = {"bvh": "w.bvh", "frames": [0, 9]}
    legs = [{"name": "leg", "base": "a", "end": "b"}]
    assert validator.is_valid({"limbik": 1, "skeleton": clip, "chains": legs})
