"""A catalogue of malformed scenes: each gives exactly these faults, and never a traceback."""

import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from limbik.cli import main
from limbik.core.errors import SceneError
from limbik.core.registry import Registry
from limbik.core.scene import scene_from
from limbik.core.yamlfile import read_yaml
from limbik.tests.refusals import assert_check_refuses

SOUND = """\
limbik: 1
chain:
  joints:
    - {name: shoulder, heading: [-130, 60], pitch: [-85, 85]}
    - {name: elbow, offset: [0, 0, 30], pitch: [0, 145]}
    - {name: wrist, offset: [0, 0, 26]}
options: {tolerance: 0.01}
goals:
  - {name: mouth, position: [1, 2, 40]}
"""
CATALOGUE: list[dict[str, Any]] = yaml.safe_load(
    Path(__file__).with_name("bad_scenes.yaml").read_text(encoding="utf-8")
)
WHOLE_FILES = [
    ("nothing", b"", "1:1: error[empty]: the file is empty"),
    ("only comments", b"# nothing\n", "1:1: error[empty]: the file is empty"),
    ("only a mark", b"---\n", "2:1: error[type]: must be a mapping, not null"),
    ("a list", b"- 1\n", "1:1: error[type]: must be a mapping, not a list of 1"),
    ("text", b"hello\n", "1:1: error[type]: must be a mapping, not text 'hello'"),
    (
        "latin-1",
        SOUND.replace("mouth", "m\xfcnd").encode("latin-1"),
        "9:13: error[encoding]: the byte 0xfc is not UTF-8 (save the file as UTF-8)",
    ),
    (
        "UTF-16",
        SOUND.encode("utf-16"),
        "1:1: error[encoding]: the file is UTF-16, it must be UTF-8",
    ),
    (
        "a NUL",
        SOUND.replace("mouth", "mo\0th").encode(),
        "9:14: error[encoding]: the character U+0000 is not allowed",
    ),
    (
        "an alias bomb",
        b"a: &a [x, x]\nb: &b [*a, *a]\nlimbik: *b\n",
        "1:4: error[alias]: a: anchors and aliases are not allowed: &a",
    ),
    ("10 000 brackets", b"[" * 10_000, "1:21: error[too-deep]: nested deeper than 20"),
    (
        "2 MB",
        b"# " + b"x" * 2_000_000,
        "1:1: error[too-large]: the file has 2000002 bytes, the limit is 1000000",
    ),
    (
        "200 000 values",
        b"limbik: 1\ngoals: [" + b"1," * 200_000 + b"]\n",
        "2:199999: error[too-many]: more than 100000 values and keys",
    ),
]


def faults(source: str | bytes) -> list[str]:
    """Read a scene and give its faults without the file's name."""
    with pytest.raises(SceneError) as caught:
        scene_from(read_yaml(source, "scene.yaml"), Path("/nowhere"), Registry(third_party=False))
    assert all(fault.file == "scene.yaml" for fault in caught.value.faults)
    return [str(fault).removeprefix("scene.yaml:") for fault in caught.value.faults]


def spoilt(entry: dict[str, Any]) -> str:
    """The sound scene with the entry's replacement."""
    assert SOUND.count(entry["replace"]) == 1
    return SOUND.replace(entry["replace"], entry["by"])


def test_the_sound_scene_has_no_fault() -> None:
    scene = scene_from(read_yaml(SOUND, "scene.yaml"), Path(), Registry(third_party=False))

    assert scene.chain.names == ("shoulder", "elbow", "wrist")


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry["scene"])
def test_a_malformed_scene_gives_exactly_its_faults(entry: dict[str, Any]) -> None:
    known = ", ".join(Registry(third_party=False).strategies("initial_bend"))
    expected = [text.replace("KNOWN", known) for text in entry["faults"]]

    assert faults(spoilt(entry)) == expected


@pytest.mark.parametrize(
    ("source", "first"), [w[1:] for w in WHOLE_FILES], ids=[w[0] for w in WHOLE_FILES]
)
def test_a_file_that_is_no_scene_gives_its_fault_first(source: bytes, first: str) -> None:
    assert faults(source)[0] == first


@pytest.mark.parametrize("entry", CATALOGUE, ids=lambda entry: entry["scene"])
def test_the_command_line_ends_with_2_and_points_at_the_first_fault(
    entry: dict[str, Any],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = tmp_path / "scene.yaml"
    assert_check_refuses(scene, spoilt(entry), entry["faults"][0], capsys, monkeypatch)


def test_a_fault_shows_its_line_with_a_mark_under_the_column(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(SOUND.replace("tolerance", "tolerence"), encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["limbik", "check", str(scene)])
    with pytest.raises(SystemExit):
        main()

    lines = capsys.readouterr().err.splitlines()
    assert lines[1:] == ["    options: {tolerence: 0.01}", "              ^"]
