"""Who may import whom, how large a file may be, and what a light import leaves alone."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MOST_LINES = 400
FOLDERS = ("core", "plugins", "tests", "benchmarks", "examples")
FILES = sorted(
    {path for top in FOLDERS for path in (ROOT / top).rglob("*.py")} | {*ROOT.glob("*.py")}
)
COMPILERS = {"numba", "llvmlite"}
KERNEL_IMPORTS = {"math", "typing", "enum", "collections", "numpy"}
KERNEL_ROOMS = (
    "limbik.core.kernels",
    "limbik.core.jit",
    "limbik.core.slots",
    "limbik.core.callers",
    "limbik.core.rotation",
)
HEAVY = ("numba", "llvmlite", "scipy", "matplotlib")


def imports(path: Path) -> set[str]:
    """Full names of all a file imports, wherever in the file it does."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: relative import"
            found.update(f"{node.module}.{alias.name}" for alias in node.names)
    return found


def inside(*folders: str) -> list[Path]:
    """Files under folders of the root."""
    return [path for path in FILES if path.is_relative_to(ROOT.joinpath(*folders))]


def within(name: str, rooms: tuple[str, ...]) -> bool:
    """Tell whether an import is one of some modules or something in them."""
    return any(name == room or name.startswith(f"{room}.") for room in rooms)


def exists(module: str) -> bool:
    """Tell whether a module of limbik is there."""
    file = ROOT.joinpath(*module.split(".")[1:])
    return file.with_suffix(".py").exists() or (file / "__init__.py").exists()


def named(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("path", FILES, ids=named)
def test_no_file_is_longer_than_400_lines_or_imports_relatively(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= MOST_LINES
    imports(path)


@pytest.mark.parametrize("path", [*inside("core"), *inside("plugins")], ids=named)
def test_only_one_module_imports_numba(path: Path) -> None:
    if path != ROOT / "core" / "compiler.py":
        assert not {name for name in imports(path) if name.split(".")[0] in COMPILERS}


@pytest.mark.parametrize("path", inside("core", "kernels"), ids=named)
def test_kernels_import_only_arithmetic_and_the_jit(path: Path) -> None:
    strange = {
        name
        for name in imports(path)
        if name.split(".")[0] not in KERNEL_IMPORTS and not within(name, KERNEL_ROOMS)
    }
    assert not strange


@pytest.mark.parametrize("path", inside("core"), ids=named)
def test_core_imports_no_outer_room(path: Path) -> None:
    outer = ("limbik.plugins", "limbik.cli", "limbik.tests", "typer")
    assert not {name for name in imports(path) if within(name, outer)}


@pytest.mark.parametrize("path", inside("plugins"), ids=named)
def test_plugins_import_no_command_line(path: Path) -> None:
    assert not {name for name in imports(path) if within(name, ("limbik.cli",))}


@pytest.mark.parametrize("path", [*inside("core"), *inside("plugins"), ROOT / "cli.py"], ids=named)
def test_nothing_shipped_imports_the_tests(path: Path) -> None:
    assert not {name for name in imports(path) if within(name, ("limbik.tests", "pytest"))}


LIGHT = [
    "limbik",
    "limbik.core.errors",
    *filter(
        exists,
        [
            "limbik.cli",
            "limbik.core.chain",
            "limbik.core.settings",
            "limbik.core.scene",
            "limbik.core.registry",
            "limbik.core.strategy",
            "limbik.core.validation",
            "limbik.core.yamlfile",
        ],
    ),
]


def loaded_with(module: str, candidates: tuple[str, ...], folder: Path) -> list[str]:
    """Import a module in a fresh interpreter and list which of the candidates came along."""
    code = f"import sys, {module}; print(*[n for n in {candidates!r} if n in sys.modules])"
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return run.stdout.split()


@pytest.mark.parametrize("module", LIGHT)
def test_a_light_import_loads_nothing_heavy(module: str, tmp_path: Path) -> None:
    """A compiler costs a second; checking a scene or asking for help must not pay it."""
    assert loaded_with(module, HEAVY, tmp_path) == []


@pytest.mark.parametrize("module", ["limbik", "limbik.core.errors"])
def test_the_package_and_its_errors_need_only_the_standard_library(
    module: str, tmp_path: Path
) -> None:
    third_party = ("numpy", "pydantic", "yaml", "pluggy", "typer", "rich", "platformdirs", *HEAVY)
    assert loaded_with(module, third_party, tmp_path) == []


def test_the_light_import_test_can_fail(tmp_path: Path) -> None:
    """The list of loaded modules is not empty when something heavy is imported."""
    assert loaded_with("numpy", ("numpy", "numba"), tmp_path) == ["numpy"]
