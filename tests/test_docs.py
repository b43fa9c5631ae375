"""What the pages name exists: rows, tests, functions."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = (
    "docs/readings.md",
    "docs/limits.md",
    "docs/experiments.md",
    "docs/pose-goals.md",
    "docs/trajectories.md",
    "docs/viewer.md",
)
NAMED = re.compile(r"`([\w/.-]+\.py)(?:::(\w+))?`")
IDS = (
    [f"A-{k:02}" for k in range(1, 7)]
    + [f"B-{k:02}" for k in range(1, 5)]
    + [f"C-{k:02}" for k in (*range(1, 9), *range(10, 18))]
    + ["C-07A", "C-07B", "C-07C", "C-07D", "C-09A", "C-09B", "C-09C"]
    + [f"E-{k:02}" for k in (1, 4, 5, 6, 7, 8, 9, 12, 13, 14)]
    + ["E-02A", "E-02B", "E-02C", "E-03A", "E-03B", "E-03C"]
    + [f"E-11{letter}" for letter in "ABCDEFGHIJKLM"]
    + [f"K-{k:02}" for k in range(1, 9)]
    + [f"J-{k:02}" for k in range(1, 9)]
    + ["D-09", "F-01", "G-02", "L-06", "M-02", "M-05", "M-08", "M-09", "M-13"]
)


def names_in(path: Path) -> set[str]:
    """Return every function and class a file defines."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    kinds = (ast.FunctionDef, ast.ClassDef)
    return {node.name for node in ast.walk(tree) if isinstance(node, kinds)}


@pytest.mark.parametrize("page", PAGES)
def test_every_file_and_name_of_a_page_exists(page: str) -> None:
    found = NAMED.findall((ROOT / page).read_text(encoding="utf-8"))
    assert found
    for file, name in found:
        assert (ROOT / file).exists(), file
        assert not name or name in names_in(ROOT / file), f"{file}::{name}"


def rows() -> dict[str, str]:
    """Return the rows of all pages by id."""
    text = "\n".join((ROOT / page).read_text(encoding="utf-8") for page in PAGES)
    found = re.findall(r"^\| ([A-Z]-\d\d[A-Z]?) \|(.*)$", text, re.MULTILINE)
    assert len(found) == len(dict(found)), "an id stands twice"
    return dict(found)


@pytest.mark.parametrize("row", IDS)
def test_every_row_has_its_place_and_its_test(row: str) -> None:
    named = NAMED.findall(rows()[row])
    assert len(named) == 2
    assert not named[0][0].startswith("tests/")
    assert named[1][0].startswith("tests/")
    assert named[1][1].startswith("test_")


def test_no_row_is_unknown() -> None:
    assert set(rows()) == set(IDS)


def test_every_benchmark_a_page_names_exists() -> None:
    pages = [*(ROOT / "docs").glob("*.md"), ROOT / "benchmarks" / "README.md"]
    texts = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    commands = set(re.findall(r"python (benchmarks/\w+\.py)", texts))
    assert len(commands) > 5
    assert [command for command in sorted(commands) if not (ROOT / command).exists()] == []
