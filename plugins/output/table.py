"""Tables for people, by rich: plain text off a terminal, no colours with NO_COLOR."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from limbik.core.body import BodySolution, chain_solutions
from limbik.core.bodyscene import BodyScene
from limbik.core.formats import Inspection
from limbik.core.posegoals import PoseSolution
from limbik.core.rotation import Array
from limbik.core.scene import Scene
from limbik.core.solution import Solution
from limbik.plugins.output.listing import range_text
from limbik.plugins.output.records import outcome
from limbik.plugins.output.servo import ServoPose

_FIXED_WIDTH = 38  # status, distance, angle, rounds and the gaps between them
_WIDE = 10_000  # columns off a terminal: a table in a file is never folded


def new_table(*titles: str, right: Collection[str] = ()) -> Table:
    """A table without a frame.

    Args:
        titles: Of the columns.
        right: Those of columns of numbers, set to the right.
    """
    table = Table(box=SIMPLE_HEAD, pad_edge=False, show_edge=False)
    for title in titles:
        table.add_column(title, justify="right" if title in right else "left")
    return table


def print_solutions(scene: Scene, solutions: Sequence[Solution]) -> None:
    """Print goal, status, distance, rounds and the angles of the joints that move [deg].

    A terminal gets the joints it has room for; a file or a pipe gets all.
    """
    console = new_console()
    room = console.width - max(map(len, scene.goal_names)) - _FIXED_WIDTH
    joints = _joint_columns(scene, solutions, 1)
    shown, left_out = _fitting(joints, room)
    if left_out:
        joints = _joint_columns(scene, solutions, 0)
        shown, left_out = _fitting(joints, room)
    posed = any(isinstance(solution, PoseSolution) for solution in solutions)
    numbers = ("distance", "off", "rounds") if posed else ("distance", "rounds")
    table = new_table("goal", "status", *numbers, right=numbers)
    for title in shown:
        table.add_column(title, justify="right", no_wrap=True)
    for row, (name, solution) in enumerate(zip(scene.goal_names, solutions, strict=True)):
        table.add_row(
            Text(name),
            Text(outcome(solution), style="green" if solution.reached else "red"),
            f"{float(solution.distance):.2g}",
            *([_turned_off(solution)] if posed else []),
            str(solution.iterations),
            *(joints[title][row] for title in shown),
        )
    console.print(table)
    if left_out:
        console.print(Text(f"{left_out} more joints: see --json or --csv", "dim"))
    reached = sum(bool(solution.reached) for solution in solutions)
    console.print(f"{reached} of {len(solutions)} goals reached")


def _turned_off(solution: Solution) -> str:
    """Return the angle left to a goal's orientation, empty where it has none."""
    if not isinstance(solution, PoseSolution) or np.isnan(solution.goal_rotation).any():
        return ""
    return f"{np.degrees(float(solution.rotation_error)):.2g}°"


def print_body(scene: BodyScene, found: Sequence[BodySolution]) -> None:
    """Print one table a chain, in the order they were solved."""
    for part, solutions in zip(scene.parts, chain_solutions(found).values(), strict=True):
        new_console().print(Text(f"\n{part.name}", "bold"))
        print_solutions(part.scene, solutions)


def _fitting(columns: dict[str, list[str]], room: int) -> tuple[list[str], int]:
    """Titles of the first columns that fit into a width, and how many do not."""
    shown = []
    for title, cells in columns.items():
        room -= max(len(title), *map(len, cells)) + 3
        if room < 0:
            break
        shown.append(title)
    return shown, len(columns) - len(shown)


def _joint_columns(
    scene: Scene, solutions: Sequence[Solution], digits: int
) -> dict[str, list[str]]:
    """Angles of every joint that moves something, a text for each goal, by title."""
    poses = [np.degrees(solution.angles) for solution in solutions]
    return {
        f"{scene.chain.names[joint]} h/p/b": [_hpb(pose[joint], digits) for pose in poses]
        for joint in dict.fromkeys(joint for joint, _ in scene.chain.moving_axes)
    }


def _hpb(angles: Array, digits: int) -> str:
    rounded = np.round(angles, digits) + 0.0  # -0.0 becomes 0.0
    return " ".join(f"{angle:.{digits}f}" for angle in rounded.tolist())


def print_plugins(record: dict[str, Any]) -> None:
    """Print plug-ins, then every slot's strategies with their parameters.

    Args:
        record: As `limbik.plugins.output.listing.plugin_record` gives it.
    """
    console = new_console()
    table = new_table("plug-in", "version", "origin", "status")
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
    for kind, formats in record["formats"].items():
        console.print(Text(f"\n{kind.replace('_', ' ')}", "bold"))
        for found in formats:
            head = Text("  ").append(found["name"], "cyan")
            console.print(head.append(f"  ({' '.join(found['suffixes'])})  {found['description']}"))


def print_inspection(inspection: Inspection) -> None:
    """Print what a file holds: its joints, then chains one could solve."""
    console = new_console()
    console.print(Text(inspection.title, "bold"))
    table = new_table(*inspection.columns)
    for row in inspection.rows:
        table.add_row(*map(Text, row))
    console.print(table)
    console.print(Text("\nchains" if inspection.chains else "\nno chain of hinges", "bold"))
    for base, end, made_of in inspection.chains:
        console.print(Text(f"  base: {base}, end: {end}", "cyan").append(f"  {made_of}", "default"))
    for note in inspection.notes:
        console.print(Text(f"note: {note}", "yellow"))


def print_metrics(metrics: dict[str, Any], chain: str = "") -> None:
    """Print what a baked motion is like, in a few lines; under the chain's name if it has one."""
    console = new_console()
    if chain:
        console.print(Text(chain, "bold"))
    frames, reached = metrics["frames"], metrics["reached"]
    style = "green" if reached == frames else "red"
    worst = f"largest distance {metrics['worst_distance']:.2g}"
    console.print(
        Text(f"{reached} of {frames} frames reached", style).append(f", {worst}", "default")
    )
    if metrics["max_step_joint"]:
        step = f"largest step {metrics['max_step']:.3g}° at {metrics['max_step_joint']}"
        console.print(f"{step}, frame {metrics['max_step_frame']}")
    pops = metrics["pops"]
    listed = ", ".join(map(str, pops[:10])) + (", ..." if len(pops) > 10 else "")
    console.print(f"{len(pops)} pops" + (f" at frames {listed}" if pops else ""))


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


def new_console() -> Console:
    """A console that writes plain, unfolded lines off a terminal."""
    console = _Console(highlight=False)
    return console if console.is_terminal else _Console(highlight=False, width=_WIDE)


def print_comparison(scene: Scene, solutions: Mapping[str, Sequence[Solution]]) -> None:
    """Print one line a solver and goal, then how many goals each reaches."""
    numbers = ("distance", "rounds")
    table = new_table("solver", "goal", "status", *numbers, right=numbers)
    for solver, found in solutions.items():
        for name, solution in zip(scene.goal_names, found, strict=True):
            style = "green" if solution.reached else "red"
            cells = Text(solver), Text(name), Text(outcome(solution), style=style)
            table.add_row(*cells, f"{float(solution.distance):.2g}", str(solution.iterations))
    console = new_console()
    console.print(table)
    for solver, found in solutions.items():
        reached = sum(bool(solution.reached) for solution in found)
        console.print(f"{solver}: {reached} of {len(found)} goals reached")


def print_servos(scene: Scene, poses: Sequence[ServoPose]) -> None:
    """Print one line a goal: each servo's tick, and how far off whole ticks end; or nothing."""
    if not poses:
        return
    ticks = [f"{command.id} {command.joint} {command.axis}" for command in poses[0].commands]
    table = new_table("goal", *ticks, "distance", right=(*ticks, "distance"))
    for name, pose in zip(scene.goal_names, poses, strict=True):
        told = (str(command.tick) for command in pose.commands)
        table.add_row(Text(name), *told, f"{pose.distance:.2g}")
    console = new_console()
    console.print("\nservo ticks")
    console.print(table)
