"""The command `limbik trajectory`."""

from pathlib import Path
from typing import Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling
from limbik.plugins.output.failures import reported


def trajectory(
    scene: SceneFile,
    dt: Annotated[
        float | None, typer.Option(help="Time between samples, in seconds; absent = the scene's.")
    ] = None,
    as_json: AsJson = False,
    csv: Annotated[Path | None, typer.Option(help="Write poses and angles to a CSV file.")] = None,
    npz: Annotated[Path | None, typer.Option(help="Write arrays for numpy, in radians.")] = None,
    tum: Annotated[Path | None, typer.Option(help="Write TUM poses.")] = None,
    right_handed: Annotated[
        bool, typer.Option("--right-handed", help="TUM poses in the right-handed Z-up world.")
    ] = False,
    servo: Annotated[
        str | None,
        typer.Option(help="Put servo ticks into the files too: ax-12, or a profile (YAML)."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(help="Draw path, speed and joints to a .png, .svg or .pdf file.")
    ] = None,
) -> None:
    """Plan a scene's trajectory and solve the joint motion, checked sample by sample.

    limbik trajectory weld.yaml

    limbik trajectory weld.yaml --csv weld.csv --plot weld.png

    limbik trajectory weld.yaml --servo servos.yaml --csv ticks.csv
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.core.scene import read_scene
        from limbik.plugins.output.trajectory_report import Files, run_trajectory

        registry = Registry()
        read = read_scene(scene, registry)
        files = Files(csv, npz, tum, plot, right_handed, servo)
        if not run_trajectory(read, registry, files, dt, as_json, announce_compiling):
            raise SystemExit(1)
