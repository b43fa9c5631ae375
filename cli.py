"""The command line: read, call, print.

Results go to stdout, the rest to stderr. Exit status: 0 all goals reached, 1 some not, 2 bad
input, 3 environment, 4 a plug-in failed, 70 a bug in limbik, 130 interrupted. What is heavy is
imported inside the commands.
"""

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from limbik import __version__
from limbik.plugins.output.compare_command import compare
from limbik.plugins.output.failures import reported
from limbik.plugins.output.templates import TEMPLATES, write_template

if TYPE_CHECKING:
    from limbik.core.formats import Bake
    from limbik.core.registry import Registry
    from limbik.core.scene import Scene
    from limbik.core.solution import Solution

app = typer.Typer(
    name="limbik",
    help="Inverse kinematics of limbs, spines and robot arms, from YAML scenes.",
    epilog="Exit status: 0 all goals reached, 1 some not, 2 bad input, 3 environment, "
    "4 a plug-in failed, 70 a bug, 130 interrupted.",
    context_settings={"help_option_names": ["-h", "--help"]},
    pretty_exceptions_enable=False,
    add_completion=False,
)

SceneFile = Annotated[str, typer.Argument(help="Scene file (YAML), or - for standard input.")]
AsJson = Annotated[bool, typer.Option("--json", help="Write one JSON object to stdout.")]


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


@app.command()
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


app.command()(compare)


@app.command()
def trajectory(
    scene: SceneFile,
    dt: Annotated[
        float | None, typer.Option(help="Time between samples [s]; absent = the scene's.")
    ] = None,
    as_json: AsJson = False,
    csv: Annotated[Path | None, typer.Option(help="Write poses and angles to a CSV file.")] = None,
    npz: Annotated[Path | None, typer.Option(help="Write arrays for numpy [rad].")] = None,
    tum: Annotated[Path | None, typer.Option(help="Write TUM poses.")] = None,
    right_handed: Annotated[
        bool, typer.Option("--right-handed", help="TUM poses in the right-handed Z-up world.")
    ] = False,
    plot: Annotated[
        Path | None, typer.Option(help="Draw path, speed and joints to a .png, .svg or .pdf file.")
    ] = None,
) -> None:
    """Plan a scene's trajectory and solve the joint motion, checked sample by sample.

    limbik trajectory weld.yaml

    limbik trajectory weld.yaml --csv weld.csv --plot weld.png
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.output.trajectory_report import Files, run_trajectory

        registry = Registry()
        read = read_scene(scene, registry)
        files = Files(csv, npz, tum, plot, right_handed)
        if not run_trajectory(read, registry, files, dt, as_json, _announce_compiling):
            raise SystemExit(1)


@app.command()
def bake(
    scene: SceneFile,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="File to write; its ending chooses the format.")
    ],
    follow: Annotated[
        bool | None,
        typer.Option(
            "--follow/--stateless",
            help="Solve each frame from the one before, or on its own; absent = as the scene says.",
            show_default=False,
        ),
    ] = None,
    mirrored: Annotated[
        bool, typer.Option("--mirrored", help="Exchange left and right in the result.")
    ] = False,
    fps: Annotated[
        float | None,
        typer.Option(min=0.001, max=1e6, help="Frames a second; absent = the clip's, or 30."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene's goals as the frames of a motion and write it to a file.

    limbik bake walk.yaml -o walk.bvh

    limbik bake reach.yaml -o reach.glb --follow --fps 60
    """
    with reported(as_json):
        from dataclasses import replace

        from limbik.core.baking import bake_scene
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.output.baking import output_for, progress
        from limbik.plugins.output.files import write_whole

        registry = Registry()
        writer = output_for(output, registry)
        read = read_scene(scene, registry)
        if follow is not None:
            read = replace(read, follow=follow)
        _say_notes(read)
        _announce_compiling()
        with progress(len(read.goals)) as report:
            seconds = None if fps is None else 1.0 / fps
            baked = bake_scene(
                read, registry, mirrored=mirrored, frame_time=seconds, progress=report
            )
        write_whole(output, writer.write(baked))
        _show_bake(baked, output, as_json)
        if read.settings.ik and baked.metrics["reached"] < baked.metrics["frames"]:
            raise SystemExit(1)


@app.command()
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
        from limbik.plugins.output.records import to_json
        from limbik.plugins.output.table import print_inspection

        inspection = inspect_file(file, Registry())
        if as_json:
            typer.echo(to_json({"status": "ok", "file": str(file), **asdict(inspection)}))
        else:
            print_inspection(inspection)


@app.command()
def schema() -> None:
    """Write the JSON Schema of scenes, for editors that check and complete YAML.

    limbik schema > limbik.schema.json

    limbik schema | head
    """
    with reported():
        from limbik.plugins.output.templates import schema_text

        typer.echo(schema_text(), nl=False)


@app.command()
def check(
    scenes: Annotated[list[str], typer.Argument(help="Scene files (YAML), or -.")],
    as_json: AsJson = False,
) -> None:
    """Check scenes without solving them; show every fault with its line.

    limbik check arm.yaml

    limbik check scenes/*.yaml --json
    """
    with reported(as_json):
        from limbik.core.errors import Fault, SceneError
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.output.records import check_record, to_json

        registry = Registry()
        faults: list[Fault] = []
        sound = []
        for name in scenes:
            try:
                sound.append(read_scene(name, registry))
            except SceneError as error:
                faults += error.faults
        for read in sound if not as_json else ():
            counts = f"{len(read.chain)} joints, {len(read.goals)} goals"
            typer.echo(f"{read.document.name}: ok, {counts}")
            _say_notes(read)
        if faults:
            raise SceneError(faults)
        if as_json:
            typer.echo(to_json(check_record(sound)))


@app.command()
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


@app.command()
def judge(scene: SceneFile, as_json: AsJson = False) -> None:
    """Measure how natural the motion along a scene's goals is.

    Exit status 1 means: a threshold of the scene's `judge` section is exceeded.

    limbik judge walk.yaml

    limbik judge walk.yaml --json
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.judging import report
        from limbik.plugins.output.records import to_json

        registry = Registry()
        read = read_scene(scene, registry)
        _announce_compiling()
        verdicts = report.judge(read, registry)
        if as_json:
            typer.echo(to_json(report.judge_record(read, verdicts)))
        else:
            report.print_verdicts(verdicts)
        if not report.are_passed(verdicts):
            raise SystemExit(1)


@app.command()
def plugins(as_json: AsJson = False) -> None:
    """List plug-ins and every strategy with parameters, defaults, ranges and units.

    limbik plugins

    limbik plugins --json
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.plugins.output.listing import plugin_record
        from limbik.plugins.output.records import to_json

        record = plugin_record(Registry())
        if as_json:
            typer.echo(to_json(record))
        else:
            from limbik.plugins.output.table import print_plugins

            print_plugins(record)


def _solve_all(scene: "Scene", registry: "Registry", trace: bool) -> list["Solution"]:
    from limbik.core.solving import solve_scene

    _say_notes(scene)
    _announce_compiling()
    return solve_scene(scene, registry, trace)


def _announce_compiling() -> None:
    from limbik.core.jit import is_compiled_before

    if not is_compiled_before():
        typer.echo("limbik: compiling machine code, once for this version ...", err=True)


def _say_notes(scene: "Scene") -> None:
    for note in scene.notes:
        typer.echo(f"{scene.document.name}: note: {note}", err=True)


def _show_bake(baked: "Bake", output: Path, as_json: bool) -> None:
    from limbik.plugins.output.records import to_json
    from limbik.plugins.output.table import print_metrics

    met = baked.metrics["reached"] == baked.metrics["frames"]
    if as_json:
        status = "ok" if met or not baked.scene.settings.ik else "unreached"
        typer.echo(to_json({"status": status, "file": str(output), "metrics": baked.metrics}))
    else:
        print_metrics(baked.metrics)
        typer.echo(f"wrote {output}")


def main() -> None:
    """Run the command line."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal that lacks a character gets a `?`
            stream.reconfigure(errors="replace")
    app()
