"""A catalogue of malformed scenes with several chains: each gives exactly these faults."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from limbik.core.bodyscene import body_from
from limbik.core.errors import SceneError
from limbik.core.registry import Registry
from limbik.core.yamlfile import read_yaml
from limbik.tests.refusals import assert_check_refuses

SOUND = """\
limbik: 1
skeleton:
  joints:
    - {name: hips}
    - {name: chest, parent: hips, offset: [0, 0, 25]}
    - {name: shoulder, parent: chest, offset: [0, 9, 9]}
    - {name: elbow, parent: shoulder, offset: [0, 0, 30], pitch: [-145, 0]}
    - {name: hand, parent: elbow, offset: [0, 0, 26]}
chains:
  - {name: spine, base: hips, end: chest, goals: [{position: [0, 9, 23]}]}
  - name: arm
    base: shoulder
    end: hand
    frame: chest
    options: {off_axis: true}
    goals: [{name: near, position: [0, 20, 40]}, {name: far, position: [0, 20, 50]}]
"""
CATALOGUE: list[dict[str, Any]] = yaml.safe_load(
    Path(__file__).with_name("bad_bodies.yaml").read_text(encoding="utf-8")
)


def spoilt(entry: dict[str, Any]) -> str:
    """The sound scene with the entry's replacement."""
    assert SOUND.count(entry["replace"]) == 1
    return SOUND.replace(entry["replace"], entry["by"])


def test_the_sound_scene_has_no_fault() -> None:
    scene = body_from(read_yaml(SOUND, "body.yaml"), Path(), Registry(third_party=False))

    assert scene.frame_names == ("near", "far")
    assert [part.name for part in scene.parts] == ["spine", "arm"]


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry["scene"])
def test_a_malformed_body_gives_exactly_its_faults(entry: dict[str, Any]) -> None:
    registry = Registry(third_party=False)
    with pytest.raises(SceneError) as caught:
        body_from(read_yaml(spoilt(entry), "body.yaml"), Path("/nowhere"), registry)
    found = [str(fault).removeprefix("body.yaml:") for fault in caught.value.faults]

    assert found == entry["faults"]


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry["scene"])
def test_the_command_line_ends_with_2_and_shows_the_first_fault(
    entry: dict[str, Any],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = tmp_path / "body.yaml"
    assert_check_refuses(scene, spoilt(entry), entry["faults"][0], capsys, monkeypatch)
