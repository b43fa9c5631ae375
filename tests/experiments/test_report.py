"""The report: its numbers, its pictures, and the one page that needs nothing else."""

import json
import re
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.plugins.experiments import report
from limbik.plugins.experiments.pictures import _coarseness, _pooled, best, pictures
from limbik.plugins.experiments.plan import PATHS, SOLVES
from limbik.plugins.experiments.summary import Row, summarise
from limbik.tests.experiments.helpers import run_here, tables


def test_a_row_sums_up_all_draws_of_a_variant(file: Path) -> None:
    run_here(file, "goals.0.repeats=3", "goals.0.count=70")

    summary = summarise(Path("run"))

    found = tables(Path("run"), ("reach_error",))
    solves, paths = found[SOLVES], found[PATHS]
    row = summary.rows[0]
    assert (row.chain, row.goals, row.label) == ("arm", "reach", "nth-root finish=none")
    assert row.count == 210
    own = np.isin(solves["trial"], [0, 4, 8])
    assert row.reached == (solves["status"][own] == 0).sum()
    misses = 100.0 * solves["distance"][own] / 56.0
    np.testing.assert_allclose(row.miss, np.percentile(misses, (50, 95, 100)), rtol=1e-12)
    assert row.rounds == solves["iterations"][own].sum()
    draws = np.isin(paths["trial"], [0, 4, 8])
    np.testing.assert_allclose(row.metric("reach_error"), paths["reach_error"][draws].mean())
    assert row.map[0].sum() == 210
    assert row.map[1].sum() == row.reached
    assert np.isnan(row.metric("gain"))
    assert len(summary.rows) == 8
    assert summary.parts[0] == summary.parts[1]


@pytest.mark.parametrize(
    ("reached", "count", "low", "high"),
    [(0, 10, 0.0, 0.2775), (10, 10, 0.7225, 1.0), (81, 263, 0.2553, 0.3662)],
)
def test_the_interval_is_wilsons(reached: int, count: int, low: float, high: float) -> None:
    """The last from Newcombe (1998), table I: 81 of 263."""
    row = Row("arm", "reach", "a", "a", 1.0, False, count=count, reached=reached)

    np.testing.assert_allclose(row.interval, (low, high), atol=5e-5)


def test_a_grid_has_a_cell_a_goal(file: Path) -> None:
    """The map shows where the arm reaches: cell by cell what the solves say."""
    text = file.read_text(encoding="utf-8")
    grid = "{kind: grid, steps: [7, 9, 1]}"
    text = re.sub(r"\{kind: reach.*\}", grid, text)
    file.write_text(text, encoding="utf-8")
    run_here(file)

    summary = summarise(Path("run"))

    view = summary.views["arm", "grid"]
    assert (view.axes, view.cells) == ((0, 1), (7, 9))
    solves = tables(Path("run"))[SOLVES]
    for number, row in enumerate(summary.rows[:4]):
        np.testing.assert_array_equal(row.map[0], 1.0)
        reached = solves["status"][solves["trial"] == number] == 0
        np.testing.assert_array_equal(row.map[1], reached.reshape(7, 9))


def test_the_report_is_one_page_that_needs_nothing_else(file: Path) -> None:
    pytest.importorskip("matplotlib")
    text = file.read_text(encoding="utf-8").replace("name: nth-root", "name: a + b - c")
    file.write_text(text.replace("name: trial", "name: first trial"), encoding="utf-8")
    run_here(file)
    summary = summarise(Path("run"))

    written = report.write_report(summary)

    names = ["report.html", "arm-reach.png", "arm-reach-map.png", "arm-path.png"]
    assert [path.name for path in written] == names
    page = (Path("run") / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"https?://|<script|<link|src='(?!data:)", page)
    shown = [b64decode(found) for found in re.findall(r"base64,([^']+)'", page)]
    assert shown == [path.read_bytes() for path in written[1:]]
    assert all(picture.startswith(b"\x89PNG") for picture in shown)
    assert page.count("<table>") == 2
    assert "a + b - c finish=newton" in page
    assert summary.manifest["fingerprint"] in page


def test_names_cannot_break_the_page(file: Path) -> None:
    run_here(file)
    summary = summarise(Path("run"))
    summary.rows[0].label = "<script>alert(1)</script>"

    page = report._page(summary, [])

    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_without_matplotlib_the_page_has_its_tables(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_here(file)
    monkeypatch.setattr(report, "find_spec", lambda name: None)

    written = report.write_report(summarise(Path("run")))

    assert [path.name for path in written] == ["report.html"]
    assert "pip install &#x27;limbik[plot]&#x27;" in written[0].read_text(encoding="utf-8") or (
        "pip install 'limbik[plot]'" in written[0].read_text(encoding="utf-8")
    )


def test_a_run_that_is_not_finished_can_be_looked_at(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run_here(file)
    for part in [*sorted(Path("run/solves").iterdir())[2:], *Path("run/paths").iterdir()]:
        part.unlink()

    summary = summarise(Path("run"))
    report.write_report(summary)
    report.print_summary(summary)

    shown = capsys.readouterr().out
    assert "the run is not finished: 2 of 20 parts" in shown
    assert summary.rows[0].count > 0
    assert summary.rows[-1].count == 0
    record = json.dumps(report.summary_record(summary, []))
    assert '"parts": 2' in record


def test_a_run_with_nothing_yet_can_be_looked_at(file: Path) -> None:
    run_here(file)
    for part in [*Path("run/solves").iterdir(), *Path("run/paths").iterdir()]:
        part.unlink()

    assert [path.name for path in report.write_report(summarise(Path("run")))] == ["report.html"]


def test_many_variants_show_the_best_in_their_order() -> None:
    shares = [0.1, 0.9, 0.5, 0.9]
    rows = [
        Row("c", "g", str(k), "s", 1.0, False, count=100, reached=int(100 * share))
        for k, share in enumerate(shares)
    ]
    for row, miss in zip(rows, (1.0, 1.0, 1.0, 0.5), strict=True):
        row.misses.append(np.full(100, miss))

    assert [row.label for row in best(rows, 2)] == ["1", "3"]
    assert [row.label for row in best(rows, 1)] == ["3"]
    assert best(rows, 9) == rows


def test_few_goals_are_seen_in_larger_cells() -> None:
    row = Row("c", "g", "a", "a", 1.0, False)
    row.map = np.ones((2, 48, 48))
    assert _coarseness([row]) == 3
    np.testing.assert_array_equal(_pooled(row.map[0], 3), np.full((16, 16), 9.0))
    row.map *= 6.0
    assert _coarseness([row]) == 1
    row.map /= 600.0
    assert _coarseness([row]) == 4


def test_failed_solves_and_large_differences_can_be_drawn(file: Path) -> None:
    pytest.importorskip("matplotlib")
    run_here(file)
    summary = summarise(Path("run"))
    first, second = summary.rows[:2]
    first.reached, first.failed, first.misses = 0, first.count, [np.full(first.count, np.nan)]
    second.misses = [np.full(second.count, 1e-12)]

    drawn = pictures(summary)

    assert [picture.name for picture in drawn] == ["arm-reach", "arm-reach-map", "arm-path"]


def test_a_folder_without_a_run_is_said_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"this folder holds no run: manifest\.json is missing"):
        summarise(tmp_path)
    (tmp_path / "manifest.json").write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="or damaged"):
        summarise(tmp_path)
