"""The repository root is the package `limbik`: what that needs, and that the wheel is right."""

import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
INSIDE = ("core", "plugins")
LITTER = shutil.ignore_patterns(
    ".git", ".typing", ".venv", ".*_cache", "build", "dist", "*.egg-info", "__pycache__"
)


def modules_in_the_tree() -> set[str]:
    """Every module file the wheel must hold, relative to the root."""
    inner = {path for top in INSIDE for path in (ROOT / top).rglob("*.py")}
    top_level = set(ROOT.glob("*.py"))
    configs = {
        path
        for end in ("yaml", "csv", "urdf", "bvh")
        for path in (ROOT / "configs").rglob(f"*.{end}")
    }
    files = inner | top_level | configs | {ROOT / "py.typed"}
    return {path.relative_to(ROOT).as_posix() for path in files if path.exists()}


def test_every_package_is_listed() -> None:
    """A folder with an `__init__.py` that is not listed would be missing from the wheel."""
    found = {"limbik"} | {
        ".".join(("limbik", *init.parent.relative_to(ROOT).parts))
        for top in INSIDE
        for init in (ROOT / top).rglob("__init__.py")
    }
    assert set(PROJECT["tool"]["setuptools"]["packages"]) == found


def test_every_folder_of_modules_is_a_package() -> None:
    """A folder of modules without `__init__.py` works in the checkout and not in the wheel."""
    folders = {path.parent for top in INSIDE for path in (ROOT / top).rglob("*.py")}
    assert not [folder for folder in folders if not (folder / "__init__.py").exists()]


def test_no_conftest_in_the_root() -> None:
    """Pytest would import one as a module of a package named after the checkout's folder."""
    assert not (ROOT / "conftest.py").exists()
    assert not (ROOT / "tests" / "__init__.py").exists()


def test_every_public_name_loads_from_the_module_it_names() -> None:
    import limbik

    for name in limbik.__all__:
        assert getattr(limbik, name).__module__ == limbik._PUBLIC[name]


def test_no_module_is_loaded_twice() -> None:
    """A second copy under another name would compile and register everything again."""
    import limbik.core.validation  # noqa: F401

    inside = {
        name
        for name, module in list(sys.modules.items())
        if (file := getattr(module, "__file__", None)) and Path(file).is_relative_to(ROOT / "core")
    }
    assert "limbik.core.validation" in inside
    assert all(name.startswith("limbik.core") for name in inside), inside


def test_inner_folders_are_not_importable_by_themselves(tmp_path: Path) -> None:
    """Outside the checkout there is `limbik.core` and no `core`."""
    code = "import importlib.util as u; print([n for n in ('core', 'plugins') if u.find_spec(n)])"
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == "[]"


@pytest.mark.slow
def test_the_wheel_holds_limbik_and_nothing_else(tmp_path: Path) -> None:
    """The wheel, built through the sdist, has every module and config, and no tests."""
    tree = tmp_path / "tree"
    shutil.copytree(ROOT, tree, ignore=LITTER)
    subprocess.run(
        [sys.executable, "-m", "build", "--no-isolation", "-o", tmp_path / "dist", tree],
        check=True,
        capture_output=True,
    )
    (wheel,) = (tmp_path / "dist").glob("*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    held = {name.removeprefix("limbik/") for name in names if ".dist-info/" not in name}
    assert held == modules_in_the_tree()
    assert {name.split("/")[0].split("-")[0] for name in names} == {"limbik"}
