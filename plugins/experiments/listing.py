"""The runs in a folder, and how far each has come."""

from pathlib import Path
from typing import Any

from limbik.core.errors import Fault, InputError
from limbik.plugins.experiments.folder import MANIFEST, read_manifest
from limbik.plugins.experiments.plan import PATHS, SOLVES
from limbik.plugins.experiments.summary import parts_of
from limbik.plugins.output.table import new_console, new_table


def runs_in(folder: Path) -> list[dict[str, Any]]:
    """Describe the runs in a folder, or the one that the folder itself is.

    Raises:
        InputError: There is no such folder.
    """
    if not folder.is_dir():
        raise InputError(Fault("unreadable", "there is no such folder", file=str(folder)))
    places = [folder] if (folder / MANIFEST).exists() else sorted(folder.iterdir())
    found = []
    for place in places:
        try:
            manifest = read_manifest(place)
        except InputError:
            continue
        made = sum(len(parts_of(place, manifest, table)) for table in (SOLVES, PATHS))
        found.append(
            {
                "folder": str(place),
                "name": manifest["name"],
                "started": manifest["started"],
                "trials": len(manifest["trials"]),
                "solves": sum(trial["count"] for trial in manifest["trials"]),
                "parts": made,
                "planned": sum(manifest["batches"].values()),
                "fingerprint": manifest["fingerprint"],
            }
        )
    return found


def print_runs(folder: Path, runs: list[dict[str, Any]]) -> None:
    """Print one line a run."""
    console = new_console()
    if not runs:
        console.print(f"no runs in {folder}")
        return
    titles = ("folder", "started", "trials", "solves", "parts", "fingerprint")
    table = new_table(*titles, right=("trials", "solves"))
    for run in runs:
        done = "all" if run["parts"] == run["planned"] else f"{run['parts']} of {run['planned']}"
        cells = (run["folder"], run["started"][:16], run["trials"], run["solves"], done)
        table.add_row(*map(str, cells), run["fingerprint"])
    console.print(table)
