"""The report of a run: a table on the terminal, pictures, and one page with all of it."""

from base64 import b64encode
from collections.abc import Sequence
from html import escape
from importlib.util import find_spec
from math import isfinite, nan
from pathlib import Path
from typing import Any

from rich.text import Text

from limbik.plugins.experiments.pictures import Picture, pictures
from limbik.plugins.experiments.summary import Row, Summary, metric_title
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.output.files import write_whole
from limbik.plugins.output.table import new_console, new_table

PAGE = "report.html"
_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2933; max-width: 72rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: 0; } h2 { font-size: 1.15rem; margin: 2.2rem 0 .4rem; }
.faint { color: #7b8794; } .scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .9rem .2rem 0; text-align: right; border-bottom: 1px solid #e4e7eb;
  white-space: nowrap; }
th { font-weight: 600; vertical-align: bottom; }
th:first-child, td:first-child { text-align: left; }
td.best { font-weight: 650; color: #00664f; } img { max-width: 100%; height: auto; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .1rem 1rem; } dd { margin: 0; }
"""


def write_report(summary: Summary) -> list[Path]:
    """Write the page and, where matplotlib is installed, the pictures into the run's folder.

    Raises:
        EnvironmentProblem: The folder is not writable.
    """
    drawn = pictures(summary) if find_spec("matplotlib") else []
    written = []
    for picture in drawn:
        path = summary.folder / f"{picture.name}.png"
        write_whole(path, picture.content)
        written.append(path)
    page = summary.folder / PAGE
    write_whole(page, _page(summary, drawn))
    return [page, *written]


def columns(summary: Summary, rows: Sequence[Row]) -> list[tuple[str, list[float], bool]]:
    """Return title, values and whether more is better for each column of a group's table."""
    found = [
        ("reached [%]", [100.0 * row.share for row in rows], True),
        ("miss p50 [% L]", [row.miss[0] for row in rows], False),
        ("p95", [row.miss[1] for row in rows], False),
        ("max", [row.miss[2] for row in rows], False),
        ("rounds", [row.mean_rounds for row in rows], False),
        ("time [µs]", [row.time for row in rows], False),
    ]
    for name in summary.metrics:
        values = [row.metric(name) for row in rows]
        if any(map(isfinite, values)):
            found.append((metric_title(name), values, False))
    return found


def print_summary(summary: Summary) -> None:
    """Print a table for each chain and goal set."""
    console = new_console()
    for chain, goals, rows in summary.groups():
        console.print(Text(f"{chain}, {goals}: {_goals(rows)}", "bold"))
        table = new_table()
        table.add_column("variant", no_wrap=True)
        shown = columns(summary, rows)
        for title, _, _ in shown:
            table.add_column(title, justify="right")
        for index, row in enumerate(rows):
            cells = [_number(values[index]) for _, values, _ in shown]
            cells[0] += _spread(row)
            table.add_row(Text(row.label), *cells)
        console.print(table)
    made, planned = summary.parts
    if made < planned:
        console.print(f"the run is not finished: {made} of {planned} parts")


def summary_record(summary: Summary, written: Sequence[Path]) -> dict[str, Any]:
    """Describe a summary for machines."""
    return {
        "status": "ok",
        "folder": str(summary.folder),
        "fingerprint": summary.manifest["fingerprint"],
        "parts": summary.parts[0],
        "planned": summary.parts[1],
        "rows": [_record(row, summary.metrics) for row in summary.rows],
        "written": [str(path) for path in written],
    }


def _record(row: Row, metrics: Sequence[str]) -> dict[str, Any]:
    low, high = row.interval
    half, most, largest = row.miss
    return {
        "chain": row.chain,
        "goals": row.goals,
        "strategy": row.strategy,
        "label": row.label,
        "count": row.count,
        "failed": row.failed,
        "reached": row.share,
        "reached_low": low,
        "reached_high": high,
        "miss_p50": half,
        "miss_p95": most,
        "miss_max": largest,
        "rounds": row.mean_rounds,
        "us": row.time,
        "metrics": {name: row.metric(name) for name in metrics},
    }


def _goals(rows: Sequence[Row]) -> str:
    counts = {row.count for row in rows}
    each = f"{min(counts)}" if len(counts) == 1 else f"{min(counts)} to {max(counts)}"
    failed = sum(row.failed for row in rows)
    return f"{each} goals each" + (f", {failed} solves failed" if failed else "")


def _spread(row: Row) -> str:
    low, high = row.interval
    return f" ±{50.0 * (high - low):.2g}" if row.count else ""


def _number(value: float) -> str:
    return f"{value:.4g}" if isfinite(value) else "–"


def _page(summary: Summary, drawn: Sequence[Picture]) -> str:
    manifest = summary.manifest
    made, planned = summary.parts
    facts = {
        "run": f"{made} of {planned} parts, {len(manifest['trials'])} trials, "
        f"{sum(row.count for row in summary.rows)} solves, started {manifest['started']}",
        "fingerprint": f"{manifest['fingerprint']}, seed {manifest['seed']}",
        "made with": ", ".join(f"{name} {of}" for name, of in manifest["versions"].items()),
    }
    listed = "".join(f"<dt>{name}</dt><dd>{escape(text)}</dd>" for name, text in facts.items())
    body = [f"<h1>{escape(manifest['name'])}</h1><dl class='faint'>{listed}</dl>"]
    for chain, goals, rows in summary.groups():
        body.append(f"<h2>{escape(chain)}, {escape(goals)}</h2>")
        body.append(f"<p class='faint'>{escape(_goals(rows))}</p>{_html_table(summary, rows)}")
        for picture in drawn:
            if picture.group == (chain, goals):
                source = b64encode(picture.content).decode()
                alt = escape(f"{chain}, {goals}: {picture.title}", quote=True)
                body.append(f"<p><img alt='{alt}' src='data:image/png;base64,{source}'></p>")
    if not drawn:
        body.append("<p class='faint'>Pictures need matplotlib: pip install 'limbik[plot]'</p>")
    body.append(_legend(summary))
    title = escape(manifest["name"])
    return (
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width'>"
        f"<title>{title}</title><style>{_STYLE}</style></head>\n<body>\n"
        + "\n".join(body)
        + "\n</body></html>\n"
    )


def _html_table(summary: Summary, rows: Sequence[Row]) -> str:
    """Write a group's table; the best value of each column stands out."""
    shown = columns(summary, rows)
    heads = "".join(f"<th>{escape(title)}</th>" for title, _, _ in shown)
    lines = []
    for index, row in enumerate(rows):
        cells = [f"<td>{escape(row.label)}</td>"]
        for number, (_, values, more) in enumerate(shown):
            texts = [_number(value) for value in values]
            best = (max if more else min)(filter(isfinite, values), default=nan)
            stands_out = texts[index] == _number(best) and len(set(texts)) > 1
            mark = " class='best'" if stands_out else ""
            spread = escape(_spread(row)) if number == 0 else ""
            cells.append(f"<td{mark}>{texts[index]}{spread}</td>")
        lines.append(f"<tr>{''.join(cells)}</tr>")
    head = f"<tr><th>variant</th>{heads}</tr>"
    return f"<div class='scroll'><table>{head}{''.join(lines)}</table></div>"


def _legend(summary: Summary) -> str:
    known = [BY_NAME[name] for name in summary.metrics if name in BY_NAME]
    items = "".join(
        f"<dt>{metric.name}</dt><dd>{escape(metric.number)}: {escape(metric.meaning)}</dd>"
        for metric in known
    )
    return (
        "<h2>How to read it</h2><dl>"
        "<dt>reached</dt><dd>goals the end came to within the tolerance; ± half a 95 % interval "
        "after Wilson</dd>"
        "<dt>miss</dt><dd>distance of the end from its goal, in percent of the chain's length L: "
        "median, 95th percentile, largest</dd>"
        "<dt>rounds, time</dt><dd>means over all solves; the time depends on the machine and what "
        f"else it does</dd>{items}</dl>"
    )
