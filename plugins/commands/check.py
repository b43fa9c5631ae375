"""The command `limbik check`."""

from typing import Annotated

import typer

from limbik.plugins.commands.common import AsJson, say_notes
from limbik.plugins.output.failures import reported


def check(
    scenes: Annotated[list[str], typer.Argument(help="Scene files (YAML), or -.")],
    as_json: AsJson = False,
) -> None:
    """Check scenes without solving them; show every fault with its line.

    limbik check arm.yaml

    limbik check scenes/*.yaml --json
    """
    with reported(as_json):
        from limbik.core.bodyscene import BodyScene, read_any
        from limbik.core.errors import Fault, SceneError
        from limbik.core.registry import Registry
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.records import check_record

        registry = Registry()
        faults: list[Fault] = []
        sound = []
        for name in scenes:
            try:
                sound.append(read_any(name, registry))
            except SceneError as error:
                faults += error.faults
        for read in sound if not as_json else ():
            if isinstance(read, BodyScene):
                joints = f"{len(read.skeleton.names)} joints in {len(read.parts)} chains"
                counts = f"{joints}, {len(read.frame_names)} frames"
            else:
                counts = f"{len(read.chain)} joints, {len(read.goals)} goals"
            typer.echo(f"{read.document.name}: ok, {counts}")
            say_notes(read)
        if faults:
            raise SceneError(faults)
        if as_json:
            typer.echo(to_json(check_record(sound)))
