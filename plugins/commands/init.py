"""The command `limbik init`."""

from pathlib import Path
from typing import Annotated

import typer

from limbik.plugins.output.failures import reported
from limbik.plugins.output.templates import TEMPLATES, write_template


def init(
    name: Annotated[Path, typer.Argument(help="File to write; .yaml is added if missing.")],
    template: Annotated[str, typer.Option(help=f"One of {', '.join(TEMPLATES)}.")] = "arm",
) -> None:
    """Write a commented scene that runs; an existing file is never overwritten.

    limbik init my-arm

    limbik init walk.yaml --template leg
    """
    with reported():
        path = write_template(name, template)
        typer.echo(f"wrote {path}; try: limbik solve {path}")
