"""The command `limbik inspect`."""

from pathlib import Path
from typing import Annotated

import typer

from limbik.plugins.commands.common import AsJson
from limbik.plugins.output.failures import reported


def inspect(
    file: Annotated[Path, typer.Argument(help="A robot or a motion clip, such as robot.urdf.")],
    as_json: AsJson = False,
) -> None:
    """Show the joints of a robot or a motion clip, and the chains a scene could name.

    limbik inspect robot.urdf

    limbik inspect walk.bvh --json
    """
    with reported(as_json):
        from dataclasses import asdict

        from limbik.core.registry import Registry
        from limbik.plugins.output.baking import inspect_file
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.table import print_inspection

        inspection = inspect_file(file, Registry())
        if as_json:
            typer.echo(to_json({"status": "ok", "file": str(file), **asdict(inspection)}))
        else:
            print_inspection(inspection)
