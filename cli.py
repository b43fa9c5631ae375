"""The command line: puts the commands of `plugins/commands` together.

Results go to stdout, the rest to stderr. Exit status: 0 all goals reached, 1 some not, 2 bad
input, 3 environment, 4 a plug-in failed, 70 a bug in limbik, 130 interrupted. What is heavy is
imported inside the commands.
"""

import io
import sys
from typing import Annotated

import typer

from limbik import __version__
from limbik.plugins.commands.bake import bake
from limbik.plugins.commands.check import check
from limbik.plugins.commands.compare import compare
from limbik.plugins.commands.experiment import experiment
from limbik.plugins.commands.init import init
from limbik.plugins.commands.inspect import inspect
from limbik.plugins.commands.judge import judge
from limbik.plugins.commands.plugins import plugins
from limbik.plugins.commands.schema import schema
from limbik.plugins.commands.solve import solve
from limbik.plugins.commands.trajectory import trajectory
from limbik.plugins.commands.view import view

app = typer.Typer(
    name="limbik",
    help="Inverse kinematics of limbs, spines and robot arms, from YAML scenes.",
    epilog="Exit status: 0 all goals reached, 1 some not, 2 bad input, 3 environment, "
    "4 a plug-in failed, 70 a bug, 130 interrupted.",
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    add_completion=False,
)
for command in (
    solve,
    compare,
    view,
    trajectory,
    bake,
    inspect,
    schema,
    check,
    init,
    judge,
    plugins,
):
    app.command()(command)
app.add_typer(experiment, name="experiment")


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"limbik {__version__}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def limbik(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Inverse kinematics of limbs, spines and robot arms, from YAML scenes."""
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main() -> None:
    """Run the command line."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal that lacks a character gets a `?`
            stream.reconfigure(errors="replace")
    app()
