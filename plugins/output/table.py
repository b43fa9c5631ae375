"""Tables for people, by rich: plain text off a terminal, no colours with NO_COLOR."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from limbik.core.scene import Scene
from limbik.core.solution import Solution
from limbik.plugins.output.listing import range_text
from limbik.plugins.output.records import status_label

_WIDE = 10_000  # columns off a terminal: a table in a file is never folded


def print_solutions(scene: Scene, solutions: Sequence[Solution]) -> None:
    """Print goal, status, distance, rounds and the angles of the joints that move [deg]."""
    moving = _moving(scene)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    table.add_column("goal")
    table.add_column("status")
    table.add_column("distance", justify="right")
    table.add_column("rounds", justify="right")
    for joint in moving:
        table.add_column(f"{scene.chain.names[joint]} h/p/b", justify="right")
    for name, solution in zip(scene.goal_names, solutions, strict=True):
        angles = np.degrees(solution.angles)
        table.add_row(
            Text(name),
            Text(status_label(solution), style="green" if solution.reached else "red"),
            f"{float(solution.distance):.2g}",
            str(solution.iterations),
            *(" ".join(_degrees(angle) for angle in angles[joint]) for joint in moving),
        )
    console = _console()
    console.print(table)
    reached = sum(bool(solution.reached) for solution in solutions)
    console.print(f"{reached} of {len(solutions)} goals reached")


def _moving(scene: Scene) -> list[int]:
    """Joints worth a column: those that can turn, without the end, whose angles move nothing."""
    spans = scene.chain.high - scene.chain.low
    return [joint for joint in range(len(scene.chain) - 1) if spans[joint].max() > 0.0]


def _degrees(angle: float) -> str:
    return f"{angle + 0.0:.1f}".replace("-0.0", "0.0") if abs(angle) < 0.05 else f"{angle:.1f}"


def print_plugins(record: dict[str, Any]) -> None:
    """Print plug-ins, then every slot's strategies with their parameters.

    Args:
        record: As `limbik.plugins.output.listing.plugin_record` gives it.
    """
    console = _console()
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for title in ("plug-in", "version", "origin", "status"):
        table.add_column(title)
    for plugin in record["plugins"]:
        style = {"loaded": "green", "broken": "red"}.get(plugin["status"], "yellow")
        status = Text(plugin["status"], style=style)
        cells = (plugin["name"], plugin["version"], plugin["origin"])
        table.add_row(*map(Text, cells), status)
    console.print(table)
    for failure in (line for plugin in record["plugins"] for line in plugin["failures"]):
        console.print(Text(f"not loaded: {failure}", "red"))
    for slot, strategies in record["slots"].items():
        console.print(Text(f"\n{slot}", "bold"))
        for strategy in strategies:
            _print_strategy(console, strategy)


def _print_strategy(console: Console, strategy: dict[str, Any]) -> None:
    head = Text("  ").append(strategy["name"], "cyan")
    console.print(head.append(f"  ({strategy['plugin']})  {strategy['description']}"))
    for parameter in strategy["parameters"]:
        default = "required" if parameter["required"] else f"= {parameter['default']}"
        parts = [f"      {parameter['name']}: {parameter['type']} {default}"]
        parts += [part for part in (range_text(parameter), parameter["description"]) if part]
        console.print(Text("; ".join(parts), "dim"))


class _Console(Console):
    def on_broken_pipe(self) -> None:
        """Leave a closed pipe to the caller, who ends quietly."""
        raise BrokenPipeError


def _console() -> Console:
    console = _Console(highlight=False)
    return console if console.is_terminal else _Console(highlight=False, width=_WIDE)
