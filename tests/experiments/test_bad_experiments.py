"""A catalogue of malformed experiments: each gives exactly these faults, and writes nothing."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from limbik.core.errors import InputError
from limbik.core.registry import Registry
from limbik.tests.experiments.helpers import EXPERIMENT, LEG, read, write_files

CATALOGUE: list[dict[str, Any]] = yaml.safe_load(
    Path(__file__).with_name("bad_experiments.yaml").read_text(encoding="utf-8")
)


def names(slot: str) -> str:
    return ", ".join(Registry(third_party=False).strategies(slot))


@pytest.mark.parametrize("case", CATALOGUE, ids=lambda case: case["case"])
def test_a_bad_experiment_gives_these_faults(case: dict[str, Any], tmp_path: Path) -> None:
    text = EXPERIMENT
    for old, new in {case.get("replace", ""): case.get("by", ""), **case.get("also", {})}.items():
        assert old in text
        text = text.replace(old, new) if old else text
    file = write_files(tmp_path, text)

    with pytest.raises(InputError) as caught:
        read(file, *case.get("set", ()))

    expected = [
        fault.replace("trial.yaml", str(file))
        .replace("FOLDER", str(tmp_path))
        .replace("BENDS", names("initial_bend"))
        .replace("SOLVERS", names("solver"))
        .replace("FINISHES", names("finish"))
        for fault in case["faults"]
    ]
    found = [str(fault) for fault in caught.value.faults]
    if expected[0].endswith("LAMBDA"):  # the solver's own words
        assert found[0].startswith(expected[0].removesuffix("LAMBDA"))
        return
    assert found == expected
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "arm.yaml",
        "leg.yaml",
        "trial.yaml",
    ]


def test_a_fault_in_a_scene_is_told_at_its_place_in_the_scene(tmp_path: Path) -> None:
    file = write_files(tmp_path, EXPERIMENT.replace("[arm.yaml]", "[leg.yaml]"))
    (tmp_path / "leg.yaml").write_text(LEG.replace("hip", "1hip!"), encoding="utf-8")

    with pytest.raises(InputError) as caught:
        read(file)

    assert str(caught.value.faults[0]).startswith(f"{tmp_path / 'leg.yaml'}:4:14: error[name]")


def test_all_faults_are_told_at_once(tmp_path: Path) -> None:
    text = EXPERIMENT.replace("gain,", "gian,").replace("[none, newton]", "[none, newtn]")
    file = write_files(tmp_path, text.replace("[arm.yaml]", "[amr.yaml]"))

    with pytest.raises(InputError) as caught:
        read(file)

    assert [fault.line for fault in caught.value.faults] == [4, 9, 13]
