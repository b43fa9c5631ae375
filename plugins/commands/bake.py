"""The command `limbik bake`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported

if TYPE_CHECKING:
    from limbik.core.formats import Bake


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
        say_notes(read)
        announce_compiling()
        with progress(len(read.goals)) as report:
            seconds = None if fps is None else 1.0 / fps
            baked = bake_scene(
                read, registry, mirrored=mirrored, frame_time=seconds, progress=report
            )
        write_whole(output, writer.write(baked))
        _show_bake(baked, output, as_json)
        if read.settings.ik and baked.metrics["reached"] < baked.metrics["frames"]:
            raise SystemExit(1)


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
