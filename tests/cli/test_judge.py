"""`limbik judge`: the table, the JSON, the exit status, unknown metrics."""

import json
from collections.abc import Callable
from pathlib import Path

Run = Callable[..., tuple[int, str, str]]

PATH = "\n".join(f"  - {{name: g{k}, position: [5, {10 + k}, 40]}}" for k in range(8))


def judged_scene(scene_text: str, judge: str) -> str:
    return scene_text.partition("goals:")[0] + f"{judge}\ngoals:\n{PATH}\n"


def test_thresholds_that_hold_give_success_and_a_table(
    run: Run, scene_text: str, tmp_path: Path
) -> None:
    scene = judged_scene(scene_text, "judge: {rate: 30, max: {pops: 0, stretch: 1.0e-9}}")
    (tmp_path / "path.yaml").write_text(scene, encoding="utf-8")
    status, out, _ = run("judge", "path.yaml")
    assert status == 0
    assert "2 of 2 thresholds hold" in out
    assert "not judged" in out


def test_a_threshold_that_is_exceeded_gives_1_and_is_named(
    run: Run, scene_text: str, tmp_path: Path
) -> None:
    scene = judged_scene(scene_text, "judge: {max: {gain: 0.001}}")
    (tmp_path / "path.yaml").write_text(scene, encoding="utf-8")
    status, out, _ = run("judge", "path.yaml", "--json")
    record = json.loads(out)
    failed = [metric["name"] for metric in record["metrics"] if metric["verdict"] == "failed"]
    assert (status, record["status"], failed) == (1, "failed", ["gain"])


def test_a_rate_in_the_scene_scales_the_accelerations(
    run: Run, scene_text: str, tmp_path: Path
) -> None:
    found = []
    for rate in (30, 60):
        scene = judged_scene(scene_text, f"judge: {{rate: {rate}}}")
        (tmp_path / "path.yaml").write_text(scene, encoding="utf-8")
        metrics = json.loads(run("judge", "path.yaml", "--json")[1])["metrics"]
        found.append({metric["name"]: metric["value"] for metric in metrics}["acceleration"])
    assert abs(found[1] / found[0] - 4.0) < 1e-6


def test_an_unknown_metric_is_shown_with_its_place(
    run: Run, scene_text: str, tmp_path: Path
) -> None:
    scene = judged_scene(scene_text, "judge:\n  max: {curls: 1}")
    (tmp_path / "path.yaml").write_text(scene, encoding="utf-8")
    status, _, err = run("judge", "path.yaml")
    assert status == 2
    assert "unknown-metric" in err
    assert "curl" in err
    assert "path.yaml:" in err
