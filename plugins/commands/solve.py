"""The command `limbik solve`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported

if TYPE_CHECKING:
    from limbik.core.bodyscene import BodyScene
    from limbik.core.registry import Registry
    from limbik.core.scene import Scene


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

        registry = Registry()
        read = read_any(scene, registry)
        if plot is not None:
            from limbik.plugins.output.plot import check_plot

            check_plot(plot)
        if isinstance(read, BodyScene):
            met = _solve_body(read, registry, as_json, csv, plot, servo, trace)
        else:
            met = _solve_chain(read, registry, as_json, csv, plot, servo, trace)
        if not met:
            raise SystemExit(1)


def _solve_chain(
    scene: "Scene",
    registry: "Registry",
    as_json: bool,
    csv: Path | None,
    plot: Path | None,
    servo: str | None,
    trace: bool,
) -> bool:
    """Solve a scene with one chain; return whether all goals are reached."""
    from limbik.core.solving import are_met, solve_scene
    from limbik.plugins.output.files import write_whole
    from limbik.plugins.output.records import solve_record, solve_rows, to_json

    profile = None
    if servo is not None:
        from limbik.plugins.output.servo import read_profile

        profile = read_profile(servo, scene.chain)
    say_notes(scene)
    announce_compiling()
    solutions = solve_scene(scene, registry, trace or plot is not None)
    poses = [] if profile is None else profile.quantise_all(scene.goal_names, solutions)
    if csv is not None:
        write_whole(csv, solve_rows(scene, solutions))
    if plot is not None:
        from limbik.plugins.output.plot import draw

        write_whole(plot, draw(scene, solutions, plot.suffix.lower().lstrip(".")))
    if as_json:
        typer.echo(to_json(solve_record(scene, solutions, stages=trace, servos=poses)))
    else:
        from limbik.plugins.output.table import print_servos, print_solutions

        print_solutions(scene, solutions)
        print_servos(scene, poses)
    return are_met(scene, solutions)


def _solve_body(
    scene: "BodyScene",
    registry: "Registry",
    as_json: bool,
    csv: Path | None,
    plot: Path | None,
    servo: str | None,
    trace: bool,
) -> bool:
    """Solve a scene with several chains; return whether all goals are reached."""
    from limbik.core.baking import stacked
    from limbik.core.body import bodies_met, chain_solutions, solve_body
    from limbik.core.errors import Fault, InputError
    from limbik.plugins.formats.bodytables import body_rows
    from limbik.plugins.output.files import write_whole
    from limbik.plugins.output.records import body_record, to_json

    if servo is not None:
        raise InputError(Fault("chains", "needs a scene with one chain", "--servo"))
    say_notes(scene)
    announce_compiling()
    found = solve_body(scene, registry, trace)
    if csv is not None:
        chains = {name: stacked(of) for name, of in chain_solutions(found).items()}
        write_whole(csv, body_rows(scene.frame_names, chains))
    if plot is not None:
        from limbik.plugins.output.plotbody import draw_body

        write_whole(plot, draw_body(scene, found, plot.suffix.lower().lstrip(".")))
    if as_json:
        typer.echo(to_json(body_record(scene, found, stages=trace)))
    else:
        from limbik.plugins.output.table import print_body

        print_body(scene, found)
    return bodies_met(scene, found)
