"""The command `limbik solve`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported

if TYPE_CHECKING:
    from limbik.core.registry import Registry
    from limbik.core.scene import Scene
    from limbik.core.solution import Solution


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
    """Solve a scene's goals and show the angles, in degrees.

    limbik solve arm.yaml

    limbik solve arm.yaml --json --plot arm.png
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.core.solving import are_met
        from limbik.plugins.output.files import write_whole
        from limbik.plugins.output.records import solve_record, solve_rows, to_json

        registry = Registry()
        read = read_scene(scene, registry)
        if plot is not None:
            from limbik.plugins.output.plot import check_plot

            check_plot(plot)
        profile = None
        if servo is not None:
            from limbik.plugins.output.servo import read_profile

            profile = read_profile(servo, read.chain)
        solutions = _solve_all(read, registry, trace=trace or plot is not None)
        poses = [] if profile is None else profile.quantise_all(read.goal_names, solutions)
        if csv is not None:
            write_whole(csv, solve_rows(read, solutions))
        if plot is not None:
            from limbik.plugins.output.plot import draw

            write_whole(plot, draw(read, solutions, plot.suffix.lower().lstrip(".")))
        if as_json:
            typer.echo(to_json(solve_record(read, solutions, stages=trace, servos=poses)))
        else:
            from limbik.plugins.output.table import print_servos, print_solutions

            print_solutions(read, solutions)
            print_servos(read, poses)
        if not are_met(read, solutions):
            raise SystemExit(1)


def _solve_all(scene: "Scene", registry: "Registry", trace: bool) -> list["Solution"]:
    from limbik.core.solving import solve_scene

    say_notes(scene)
    announce_compiling()
    return solve_scene(scene, registry, trace)
