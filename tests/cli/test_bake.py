"""The commands bake, inspect and schema, as a user calls them."""

import csv
import json
from collections.abc import Callable
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml

from limbik.core.registry import Registry
from limbik.core.schema import scene_schema
from limbik.plugins.output import baking
from limbik.plugins.output.templates import TEMPLATES

Run = Callable[..., tuple[int, str, str]]
CONFIGS = Path(__file__).parents[2] / "configs"
STICK = '<robot name="s"><link name="a"/><link name="b"/>{}</robot>'


@pytest.mark.parametrize("ending", ["csv", "json", "npz", "bvh", "glb"])
def test_bake_writes_by_the_files_ending(run: Run, scene: str, tmp_path: Path, ending: str) -> None:
    status, out, _ = run("bake", scene, "-o", f"motion.{ending}")
    assert status == 0
    assert "2 of 2 frames reached" in out
    assert f"wrote motion.{ending}" in out
    assert (tmp_path / f"motion.{ending}").stat().st_size > 100


def test_bake_ends_with_1_when_a_goal_is_missed_and_writes_all_the_same(
    run: Run, far: str, tmp_path: Path
) -> None:
    status, out, _ = run("bake", far, "-o", "motion.csv", "--json")
    record = json.loads(out)
    assert (status, record["status"]) == (1, "unreached")
    assert (record["metrics"]["reached"], record["metrics"]["frames"]) == (1, 2)
    assert (tmp_path / "motion.csv").exists()


def test_an_unknown_ending_ends_with_2_before_anything_is_solved(run: Run, scene: str) -> None:
    status, _, err = run("bake", scene, "-o", "motion.avi")
    assert status == 2
    assert "files ending in '.avi' cannot be written; known: .bvh, .csv, .glb, .json, .npz" in err


def test_a_failed_write_leaves_nothing_behind(run: Run, scene: str, tmp_path: Path) -> None:
    (tmp_path / "motion.csv").mkdir()
    before = sorted(tmp_path.iterdir())
    status, _, err = run("bake", scene, "-o", "motion.csv")
    assert status == 3
    assert "cannot write motion.csv" in err
    assert sorted(tmp_path.iterdir()) == before


def angles_of(tmp_path: Path) -> list[list[list[float]]]:
    found: list[list[list[float]]] = json.loads((tmp_path / "m.json").read_text())["angles"]
    return found


def test_follow_and_stateless_override_the_scene(run: Run, scene: str, tmp_path: Path) -> None:
    """With aim_from previous the past counts, so the two differ; the first frame does not."""
    text = Path(scene).read_text().replace("{max_iterations: 100}", "{aim_from: previous}")
    Path(scene).write_text(text.replace("limbik: 1", "limbik: 1\nfollow: true"))
    results = {}
    for option in ("", "--follow", "--stateless"):
        run("bake", scene, "-o", "m.json", *([option] if option else []))
        results[option] = angles_of(tmp_path)
    assert results[""] == results["--follow"]
    assert results["--stateless"][0] == results["--follow"][0]
    assert results["--stateless"][1] != results["--follow"][1]


def test_mirrored_changes_the_sign_of_x(run: Run, scene: str, tmp_path: Path) -> None:
    run("bake", scene, "-o", "m.json")
    plain = json.loads((tmp_path / "m.json").read_text())
    run("bake", scene, "-o", "m.json", "--mirrored")
    mirrored = json.loads((tmp_path / "m.json").read_text())
    assert [[-x, y, z] for x, y, z in plain["goals"]] == mirrored["goals"]
    assert mirrored["mirrored"] is True


def test_fps_sets_the_time_of_a_frame(run: Run, scene: str, tmp_path: Path) -> None:
    run("bake", scene, "-o", "m.json", "--fps", "50")
    assert json.loads((tmp_path / "m.json").read_text())["frame_time"] == 0.02


def test_progress_of_a_long_bake_goes_to_stderr_in_lines(
    run: Run, scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(baking, "LONG", 2)
    _, out, err = run("bake", scene, "-o", "m.csv")
    assert "100 % 2/2" in err
    assert "%" not in out
    monkeypatch.setattr(baking, "LONG", 3)
    assert "%" not in run("bake", scene, "-o", "m.csv")[2]


def test_inspect_shows_joints_axes_ranges_and_chains(run: Run) -> None:
    status, out, _ = run("inspect", str(CONFIGS / "arm7.urdf"))
    assert status == 0
    assert "robot 'arm7': 9 links, 8 joints, 7 of them hinges" in out
    assert "-170 to 170°" in out
    assert "base: pedestal, end: flange  7 hinges: shoulder_yaw, shoulder_pitch" in out


def test_inspect_as_json_names_the_chains(run: Run) -> None:
    status, out, _ = run("inspect", str(CONFIGS / "humanoid.urdf"), "--json")
    ends = [end for _, end, _ in json.loads(out)["chains"]]
    assert status == 0
    assert ends == ["head", "left_hand", "left_sole", "right_hand", "right_sole"]


BROKEN = {
    "r.urdf": "<robot",
    "d.urdf": "<!DOCTYPE robot><robot/>",
    "x.urdf": '<robot xmlns:xacro="http://x"><xacro:arm/></robot>',
    "n.urdf": STICK.format('<joint name="j" type="revolute"/>'),
    "e.bvh": "",
    "c.bvh": "HIERARCHY\nROOT a\n{\nOFFSET 0 0",
    "gone.urdf": None,
    "f.fbx": "?",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_ends_with_2_and_its_place(run: Run, tmp_path: Path, name: str) -> None:
    content = BROKEN[name]
    if content is not None:
        (tmp_path / name).write_text(content)
    status, out, err = run("inspect", name)
    assert (status, out) == (2, "")
    assert err.startswith(f"{name}:")
    assert "Traceback" not in err


def test_a_broken_robot_of_a_scene_ends_with_2_and_its_place(run: Run, tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text("<robot>\n  <link/>\n</robot>")
    chain = "limbik: 1\nchain: {urdf: r.urdf, base: a, end: b}\ngoals: [{position: [0, 0, 1]}]\n"
    (tmp_path / "s.yaml").write_text(chain)
    status, out, err = run("check", "s.yaml")
    assert (status, out) == (2, "")
    assert err.startswith("r.urdf:2:3: error[missing-key]: this <link> has no name")


def test_check_tells_what_was_assumed(run: Run) -> None:
    status, out, err = run("check", str(CONFIGS / "arm7.yaml"))
    assert (status, err) == (0, "")
    text = (CONFIGS / "arm7.yaml").read_text().replace("elbow: 60", "elbow: 160")
    Path("arm7.yaml").write_text(text)
    Path("arm7.urdf").write_text((CONFIGS / "arm7.urdf").read_text())
    _, out, err = run("check", "arm7.yaml")
    assert "ok" in out
    assert "note: joint 'elbow': 160° is outside its range; it rests at 120°" in err


def test_schema_is_the_one_of_the_installed_plug_ins(run: Run) -> None:
    status, out, _ = run("schema")
    assert status == 0
    assert json.loads(out) == scene_schema(Registry())


def test_the_schema_itself_is_sound_and_accepts_every_shipped_scene() -> None:
    schema = scene_schema(Registry(third_party=False))
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for path in CONFIGS.glob("*.yaml"):
        validator.validate(yaml.safe_load(path.read_text()))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("limbik: 1", "limbik: 2"),
        ("{max_iterations: 100}", "{max_iterations: 1.5}"),
        ("{max_iterations: 100}", "{smoothign: 0.1}"),
        ("{max_iterations: 100}", "{bend_vector: manuel}"),
        ("{max_iterations: 100}", "{bend_vector: {use: manual, angel: 3}}"),
        ("{max_iterations: 100}", "{bend_vector: {use: manual, angle: 999}}"),
        ("pitch: [-145, 0]", "pitch: [-200, 0]"),
        ("pitch: [-145, 0]", "pitch: [1, 2, 3]"),
        ("position: [5, 10, 40]", "position: [5, 10]"),
        ("goals:", "gaols:"),
    ],
)
def test_the_schema_refuses_what_the_models_refuse(scene_text: str, old: str, new: str) -> None:
    validator = jsonschema.Draft202012Validator(scene_schema(Registry(third_party=False)))
    assert validator.is_valid(yaml.safe_load(scene_text))
    assert old in scene_text
    assert not validator.is_valid(yaml.safe_load(scene_text.replace(old, new)))


def test_the_schema_asks_for_goals_except_of_a_clip() -> None:
    validator = jsonschema.Draft202012Validator(scene_schema(Registry(third_party=False)))
    robot = {"limbik": 1, "chain": {"urdf": "r.urdf", "base": "a", "end": "b"}}
    clip = {"limbik": 1, "chain": {"bvh": "w.bvh", "base": "a", "end": "b"}}
    assert not validator.is_valid(robot)
    assert validator.is_valid({**robot, "goals": [{"position": [0, 0, 1]}]})
    assert validator.is_valid(clip)


@pytest.mark.parametrize("template", TEMPLATES)
def test_init_refers_to_a_schema_beside_it(run: Run, tmp_path: Path, template: str) -> None:
    """A second init leaves the schema alone."""
    run("init", "mine", "--template", template)
    first = (tmp_path / "mine.yaml").read_text().splitlines()[0]
    assert first == "# yaml-language-server: $schema=limbik.schema.json"
    schema = json.loads((tmp_path / "limbik.schema.json").read_text())
    jsonschema.validate(yaml.safe_load((tmp_path / "mine.yaml").read_text()), schema)
    (tmp_path / "limbik.schema.json").write_text("{}")
    assert run("init", "second", "--template", template)[0] == 0
    assert (tmp_path / "limbik.schema.json").read_text() == "{}"


def test_servo_ticks_are_those_of_a_solve(run: Run, tmp_path: Path) -> None:
    scene, profile = CONFIGS / "cosine-arm.yaml", CONFIGS / "servos" / "cosine-arm.yaml"
    solved = json.loads(run("solve", str(scene), "--servo", str(profile), "--json")[1])
    expected = [[each["tick"] for each in goal["servo"]["commands"]] for goal in solved["goals"]]
    for ending in ("csv", "json", "npz"):
        run("bake", str(scene), "--servo", str(profile), "-o", f"ticks.{ending}")
    with (tmp_path / "ticks.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    names = [name for name in rows[0] if name.startswith("servo ")]
    assert names[0] == "servo 1 waist heading"
    assert [[int(row[name]) for name in names] for row in rows] == expected
    record = json.loads((tmp_path / "ticks.json").read_text())
    assert (record["servos"], record["servo_ticks"]) == (names, expected)
    with np.load(tmp_path / "ticks.npz") as file:
        assert file["servos"].tolist() == names
        assert file["servo_ticks"].tolist() == expected


@pytest.mark.parametrize(
    ("scene", "more", "message"),
    [
        ("cosine-arm", ["-o", "t.bvh"], "--servo: bvh files hold no servo ticks"),
        ("cosine-arm", ["-o", "t.csv", "--mirrored"], "--mirrored: the servos are those of"),
        ("body", ["-o", "t.csv"], "--servo: needs a scene with one chain"),
    ],
)
def test_what_has_no_place_for_servo_ticks_is_refused(
    run: Run, tmp_path: Path, scene: str, more: list[str], message: str
) -> None:
    status, _, err = run("bake", str(CONFIGS / f"{scene}.yaml"), "--servo", "ax-12", *more)
    assert status == 2
    assert message in err
    assert not list(tmp_path.glob("t.*"))
