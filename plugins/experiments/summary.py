"""Sum up a run from its parts: numbers by trial, and where in space goals were reached."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.core.goals import PLACE
from limbik.core.rotation import Array
from limbik.core.solution import Status
from limbik.plugins.experiments.folder import read_manifest
from limbik.plugins.experiments.plan import PATHS, SOLVES
from limbik.plugins.experiments.table import FAILED, decode, require_reader
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.output.plot import seen_axes

CELLS = 48  # of the map of the reach, along each side
SURE = 1.959964  # standard deviations of a 95 % interval


@dataclass
class Row:
    """What became of one variant on one chain and one set of goals, all draws of it together.

    Attributes:
        chain: Name of the chain.
        goals: Name of the goal set.
        label: Strategy and what is swept.
        strategy: Name of the strategy.
        length: Of the chain [length].
        is_path: Whether the goals are a path.
        count: Goals solved so far.
        reached: How many were reached.
        failed: How many failed.
        misses: Distances of goals over the chain's length [%].
        rounds: Sum of the rounds.
        microseconds: Sum of the times of all solves [µs].
        metrics: Values of each metric, one a draw; NaN where one says nothing.
        steps: Goals along x, y and z where they are a grid.
        map: Goals and goals reached by cell of the group's view, (2, cells, cells).
    """

    chain: str
    goals: str
    label: str
    strategy: str
    length: float
    is_path: bool
    steps: tuple[int, int, int] | None = None
    count: int = 0
    reached: int = 0
    failed: int = 0
    misses: list[Array] = field(default_factory=list)
    rounds: int = 0
    microseconds: float = 0.0
    metrics: dict[str, list[float]] = field(default_factory=dict)
    map: Array = field(default_factory=lambda: np.zeros((2, 0, 0)))

    @property
    def share(self) -> float:
        """Share of goals reached."""
        return self.reached / self.count if self.count else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Where the share lies with 95 % certainty, after Wilson (1927)."""
        n, square = max(self.count, 1), SURE**2
        middle = (self.share + square / (2 * n)) / (1 + square / n)
        spread = self.share * (1 - self.share) / n + square / (4 * n * n)
        half = SURE * sqrt(spread) / (1 + square / n)
        return max(middle - half, 0.0), min(middle + half, 1.0)

    @cached_property
    def miss(self) -> tuple[float, float, float]:
        """Median, 95th percentile and largest miss [% of the chain's length]."""
        found = np.concatenate(self.misses) if self.misses else np.zeros(0)
        found = found[np.isfinite(found)]
        if not len(found):
            return float("nan"), float("nan"), float("nan")
        half, most, largest = np.percentile(found, (50, 95, 100)).tolist()
        return half, most, largest

    @property
    def mean_rounds(self) -> float:
        """Mean of the rounds of a solve."""
        return self.rounds / max(self.count, 1)

    @property
    def time(self) -> float:
        """Mean time of a solve [µs]."""
        return self.microseconds / self.count if self.count else float("nan")

    def metric(self, name: str) -> float:
        """Return the mean of a metric over the draws; NaN where it says nothing."""
        values = [value for value in self.metrics.get(name, []) if value == value]
        return float(np.mean(values)) if values else float("nan")


@dataclass(frozen=True)
class View:
    """How the goals of a group are looked at: along the axis they spread least.

    Attributes:
        axes: The other two, the upright one second if it is among them.
        low: Corner of the map, (2,) [length].
        high: The other corner.
        cells: Cells along both.
    """

    axes: tuple[int, int]
    low: Array
    high: Array
    cells: tuple[int, int]

    def cell(self, part: dict[str, Array]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the cells of goals, two indices (m,) each."""
        at = np.stack([part[PLACE[axis]] for axis in self.axes], axis=1)
        share = (at - self.low) / (self.high - self.low)
        found = np.clip(share * self.cells, 0, np.array(self.cells) - 1).astype(np.int64)
        return found[:, 0], found[:, 1]


@dataclass(frozen=True)
class Summary:
    """What a run came to so far.

    Attributes:
        folder: Its folder.
        manifest: What it is.
        rows: One for each variant on each chain and goal set, in the order of the file.
        parts: Parts there are, and parts there will be.
        views: How the goals of a chain and goal set are looked at.
    """

    folder: Path
    manifest: dict[str, Any]
    rows: list[Row]
    parts: tuple[int, int]
    views: dict[tuple[str, str], View]

    @property
    def metrics(self) -> list[str]:
        """Names of the metrics that were measured."""
        return list(self.manifest["metrics"])

    def groups(self) -> Iterator[tuple[str, str, list[Row]]]:
        """Give chain, goal set and rows that belong together: the same goals for all."""
        for chain, goals in dict.fromkeys((row.chain, row.goals) for row in self.rows):
            yield chain, goals, [r for r in self.rows if (r.chain, r.goals) == (chain, goals)]


def metric_title(name: str) -> str:
    """Return a metric's name with its unit, if it has one."""
    unit = BY_NAME[name].unit if name in BY_NAME else ""
    return f"{name} [{unit}]" if unit else name


def summarise(folder: Path) -> Summary:
    """Read a run, finished or not.

    Raises:
        InputError: There is none in the folder.
        EnvironmentProblem: A part cannot be read.
    """
    manifest = read_manifest(folder)
    require_reader(manifest["form"], folder)
    rows: dict[tuple[str, ...], Row] = {}
    by_trial: list[Row] = []
    for trial in manifest["trials"]:
        tried = (trial["strategy"], json.dumps(trial["params"], sort_keys=True))
        key = (trial["chain"], trial["goals"], *tried)
        new = Row(*key[:2], trial["label"], trial["strategy"], trial["length"], trial["path"])
        new.steps = trial["steps"] and tuple(trial["steps"])
        by_trial.append(rows.setdefault(key, new))
    solves, paths = (parts_of(folder, manifest, table) for table in (SOLVES, PATHS))
    views = _views(solves, by_trial)
    for path in solves:
        _add_solves(path, by_trial, views)
    for path in paths:
        _add_metrics(path, by_trial, manifest["metrics"])
    planned = sum(manifest["batches"].values())
    return Summary(
        folder, manifest, list(rows.values()), (len(solves) + len(paths), planned), views
    )


def parts_of(folder: Path, manifest: dict[str, Any], table: str) -> list[Path]:
    """Return the finished parts of a table, in order."""
    return sorted((folder / table).glob(f"part-*.{manifest['form']}"))


def _views(parts: Sequence[Path], by_trial: Sequence[Row]) -> dict[tuple[str, str], View]:
    """Choose views that show all goals of each chain and goal set."""
    bounds: dict[tuple[str, str], tuple[Array, Array]] = {}
    steps = {}
    for path in parts:
        part = decode(path, ("trial", *PLACE))
        points = np.stack([part[axis] for axis in PLACE], axis=1)
        for trial in np.unique(part["trial"]).tolist():
            own = points[part["trial"] == trial]
            low, high = own.min(axis=0), own.max(axis=0)
            row = by_trial[trial]
            group = (row.chain, row.goals)
            before = bounds.get(group, (low, high))
            bounds[group] = np.minimum(before[0], low), np.maximum(before[1], high)
            steps[group] = row.steps
    return {group: _view(*bounds[group], steps[group]) for group in bounds}


def _view(low: Array, high: Array, steps: tuple[int, int, int] | None) -> View:
    axes = seen_axes(high - low)
    low, high = low[list(axes)], high[list(axes)]
    if steps is not None and max(steps[axis] for axis in axes) <= 2 * CELLS:
        cells = np.array([steps[axis] for axis in axes])  # a cell a goal, the goal in its middle
        half = 0.5 * (high - low) / np.maximum(cells - 1, 1)
        half[half == 0.0] = 0.5
        return View(axes, low - half, high + half, (int(cells[0]), int(cells[1])))
    middle, half = 0.5 * (low + high), 0.5 * max(float((high - low).max()), 1e-9)
    return View(axes, middle - half, middle + half, (CELLS, CELLS))


def _add_solves(path: Path, by_trial: Sequence[Row], views: dict[tuple[str, str], View]) -> None:
    columns = ("trial", *PLACE, "status", "iterations", "distance", "us")
    part = decode(path, columns)
    for trial in np.unique(part["trial"]).tolist():
        own = {name: part[name][part["trial"] == trial] for name in columns}
        row = by_trial[trial]
        view = views[row.chain, row.goals]
        reached = own["status"] == Status.REACHED
        row.count += len(reached)
        row.reached += int(reached.sum())
        row.failed += int((own["status"] == FAILED).sum())
        row.misses.append(100.0 * own["distance"] / row.length)
        row.rounds += int(np.maximum(own["iterations"], 0).sum())
        row.microseconds += float(own["us"].sum())
        if not row.map.size:
            row.map = np.zeros((2, *view.cells))
        first, second = view.cell(own)
        np.add.at(row.map[0], (first, second), 1.0)
        np.add.at(row.map[1], (first[reached], second[reached]), 1.0)


def _add_metrics(path: Path, by_trial: Sequence[Row], metrics: Sequence[str]) -> None:
    part = decode(path, ("trial", *metrics))
    for index, trial in enumerate(part["trial"].tolist()):
        for name in metrics:
            by_trial[trial].metrics.setdefault(name, []).append(float(part[name][index]))
