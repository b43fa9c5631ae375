"""The example of a third party's plug-in, installed the way a user would, is found and solves."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "limbik-spiral"
LITTER = shutil.ignore_patterns("build", "*.egg-info", "__pycache__", ".*_cache")
SCENE = """\
limbik: 1
chain:
  joints:
    - {name: a}
    - {name: b, offset: [0, 0, 20]}
    - {name: c, offset: [0, 0, 20]}
    - {name: d, offset: [0, 0, 20]}
options: {max_iterations: 100, initial_bend: {use: spiral, growth: 3}}
goals:
  - {name: near, position: [5, 10, 40]}
"""
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Python of a fresh environment with the example installed, and nothing fetched for it.

    The packages of the present environment are seen through a `.pth` file.
    """
    pytest.importorskip("setuptools", minversion="77")
    place = tmp_path_factory.mktemp("fresh")
    venv.create(place / "env", with_pip=True)
    paths = {"base": str(place / "env"), "platbase": str(place / "env")}
    packages = Path(sysconfig.get_path("purelib", vars=paths))
    present = [path for path in sys.path if path.endswith("-packages")]
    # First in the path: a fresh environment may come with a setuptools that is too old.
    lines = [
        f"import site, sys; sys.path.insert(0, {path!r}); site.addsitedir({path!r})"
        for path in present
    ]
    (packages / "present.pth").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shutil.copytree(EXAMPLE, place / "example", ignore=LITTER)
    fresh = Path(sysconfig.get_path("scripts", vars=paths)) / Path(sys.executable).name
    options = ["--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check"]
    done = subprocess.run(
        [fresh, "-m", "pip", "install", "-q", *options, place / "example"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return fresh


def run(python: Path, folder: Path, *arguments: str) -> tuple[int, Any, str]:
    """Run limbik in the fresh environment; give exit status, JSON and stderr."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [python, "-m", "limbik", *arguments, "--json"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return done.returncode, json.loads(done.stdout), done.stderr


def test_the_plug_in_is_listed_with_its_version_and_parameters(
    python: Path, tmp_path: Path
) -> None:
    _, record, _ = run(python, tmp_path, "plugins")
    (plugin,) = [p for p in record["plugins"] if p["name"] == "spiral"]
    (strategy,) = [s for s in record["slots"]["initial_bend"] if s["name"] == "spiral"]

    assert (plugin["distribution"], plugin["version"]) == ("limbik-spiral", "0.1.0")
    assert plugin["status"] == "loaded"
    assert [p["name"] for p in strategy["parameters"]] == ["growth"]


def test_a_scene_solves_with_it_and_its_parameter_counts(python: Path, tmp_path: Path) -> None:
    bends = []
    for growth in ("3", "0.5"):
        (tmp_path / "scene.yaml").write_text(SCENE.replace("growth: 3", f"growth: {growth}"))
        status, record, err = run(python, tmp_path, "solve", "scene.yaml", "--trace")
        stages = {stage["name"]: stage for stage in record["goals"][0]["stages"]}
        bends.append(np.array(stages["bend"]["positions"]))
        assert status == 0, err

    assert np.abs(bends[0] - bends[1]).max() > 1.0


def test_a_bad_parameter_of_it_is_a_fault_with_its_line(python: Path, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.replace("growth: 3", "growth: 9"))
    status, record, _ = run(python, tmp_path, "check", "scene.yaml")

    assert status == 2
    assert record["errors"][0]["key"] == "options.initial_bend.growth"
    assert (record["errors"][0]["line"], record["errors"][0]["column"]) == (8, 68)


def test_a_blocked_plug_in_is_not_used(
    python: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LIMBIK_BLOCK", "spiral")
    (tmp_path / "scene.yaml").write_text(SCENE)
    status, record, _ = run(python, tmp_path, "check", "scene.yaml")

    assert status == 2
    assert record["errors"][0]["code"] == "unknown-strategy"
