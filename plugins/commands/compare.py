"""The command `limbik compare`."""

from pathlib import Path
from typing import Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile
from limbik.plugins.output.failures import reported


def compare(
    scene: SceneFile,
    solvers: Annotated[str, typer.Option(help="Names of solvers, separated by commas.")],
    as_json: AsJson = False,
    plot: Annotated[
        Path | None, typer.Option(help="Draw them side by side to a .png, .svg or .pdf file.")
    ] = None,
) -> None:
    """Solve a scene with several solvers and show what each makes of it.

    limbik compare planar.yaml --solvers article-ccd,planar-ccd

    limbik compare planar.yaml --solvers article-ccd,article-ccd-limit,planar-ccd --plot p.png
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.output import compare as comparing
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.files import write_whole
        from limbik.plugins.output.plot import check_plot, form_of

        registry = Registry()
        read = read_scene(scene, registry)
        if plot is not None:
            check_plot(plot)
        names = list(dict.fromkeys(filter(None, map(str.strip, solvers.split(",")))))
        found = comparing.compare(read, names, registry)
        if plot is not None:
            write_whole(plot, comparing.draw_comparison(found, form_of(plot)))
        if as_json:
            typer.echo(to_json(comparing.compare_record(found)))
        else:
            from limbik.plugins.output.table import print_comparison

            print_comparison(read, found.solutions)
        if not found.are_reached:
            raise SystemExit(1)
