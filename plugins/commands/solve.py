"""The command `limbik solve`."""

from pathlib import Path
from typing import Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported


def solve(
    scene: SceneFile,
    as_json: AsJson = False,
    csv: Annotated[Path | None, typer.Option(help="Write the results to a CSV file.")] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw the poses to a .png, .svg or .pdf file.")
    ] = None,
    servo: Annotated[
        str | None, typer.Option(help="Show servo ticks too: ax-12, or a profile (YAML).")
    ] = None,
    trace: Annotated[
        bool, typer.Option("--trace", help="Put every stage's pose into the JSON.")
    ] = False,
) -> None:
    """Solve a scene's goals and show the angles, in degrees; one table a chain.

    limbik solve arm.yaml

    limbik solve arm.yaml --json --plot arm.png
    """
    with reported(as_json):
        from limbik.core.bodyscene import BodyScene, read_any
        from limbik.core.registry import Registry
        from limbik.plugins.output.bake_servos import servo_profile
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.files import write_whole
        from limbik.plugins.output.plot import check_plot, form_of
        from limbik.plugins.output.results import BodyResults, ChainResults

        registry = Registry()
        read = read_any(scene, registry)
        if plot is not None:
            check_plot(plot)
        profile = servo_profile(servo, read)
        say_notes(read)
        announce_compiling()
        found: BodyResults | ChainResults
        if isinstance(read, BodyScene):
            found = BodyResults(read, registry, trace)
        else:
            found = ChainResults(read, registry, trace or plot is not None, profile)
        if csv is not None:
            write_whole(csv, found.rows())
        if plot is not None:
            write_whole(plot, found.draw(form_of(plot)))
        if as_json:
            typer.echo(to_json(found.record(trace)))
        else:
            found.show()
        if not found.met:
            raise SystemExit(1)
