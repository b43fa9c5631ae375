"""The scenarios of limb motion keep the thresholds written in their scenes."""

from pathlib import Path

import pytest

from limbik.core.registry import Registry
from limbik.core.scene import read_scene
from limbik.plugins.judging.report import are_passed, judge

FOLDER = Path(__file__).parents[1] / "configs" / "scenarios"
SCENES = sorted(FOLDER.glob("*.yaml"))
REGISTRY = Registry(third_party=False)


def test_there_is_a_path_for_every_scene_and_a_scene_for_every_path() -> None:
    paths = {path.stem for path in FOLDER.glob("*.csv")}
    used = {read_scene(scene).document.content["goals"]["csv"] for scene in SCENES}
    assert used == {f"{name}.csv" for name in paths}


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scenario_keeps_its_thresholds(path: Path) -> None:
    verdicts = judge(read_scene(path, REGISTRY), REGISTRY, only_thresholds=True)
    assert len(verdicts) >= 3
    failed = [(v.metric.name, v.value, v.most, v.reason) for v in verdicts if v.word == "failed"]
    assert are_passed(verdicts), failed
