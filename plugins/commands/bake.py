"""The command `limbik bake`."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported


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
    servo: Annotated[
        str | None,
        typer.Option(help="Put servo ticks into the file too: ax-12, or a profile (YAML)."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Solve a scene's goals as the frames of a motion and write it to a file.

    limbik bake walk.yaml -o walk.bvh

    limbik bake reach.yaml -o reach.glb --follow --fps 60

    limbik bake reach.yaml -o ticks.csv --servo ax-12
    """
    with reported(as_json):
        from dataclasses import replace

        from limbik.core.baking import bake_body, bake_scene
        from limbik.core.body import followed
        from limbik.core.bodyscene import BodyScene, read_any
        from limbik.core.registry import Registry
        from limbik.plugins.output.bake_servos import servo_profile, servo_values
        from limbik.plugins.output.baking import body_writer, output_for, progress
        from limbik.plugins.output.files import write_whole

        registry = Registry()
        writer = output_for(output, registry)
        read = read_any(scene, registry)
        profile = servo_profile(servo, read, writer, mirrored)
        say_notes(read)
        seconds = None if fps is None else 1.0 / fps
        if isinstance(read, BodyScene):
            write_body = body_writer(writer, output)
            if follow is not None:
                read = followed(read, follow)
            announce_compiling()
            with progress(len(read.frame_names)) as report:
                body = bake_body(
                    read, registry, mirrored=mirrored, frame_time=seconds, progress=report
                )
            write_whole(output, write_body(body))
            pursued = [part.scene.settings.ik for part in read.parts]
            met = _show(body.metrics, pursued, output, as_json)
        else:
            if follow is not None:
                read = replace(read, follow=follow)
            announce_compiling()
            with progress(len(read.goals)) as report:
                baked = bake_scene(
                    read, registry, mirrored=mirrored, frame_time=seconds, progress=report
                )
            if profile is not None:
                baked = replace(baked, servos=servo_values(profile, baked))
            write_whole(output, writer.write(baked))
            met = _show({"": baked.metrics}, [read.settings.ik], output, as_json)
        if not met:
            raise SystemExit(1)


def _show(
    metrics: dict[str, dict[str, Any]], pursued: Sequence[bool], output: Path, as_json: bool
) -> bool:
    """Show what a motion is like, chain by chain; return whether all goals pursued are reached."""
    from limbik.plugins.output.encoding import to_json
    from limbik.plugins.output.table import print_metrics

    all_met = (of["reached"] == of["frames"] for of in metrics.values())
    met = all(met or not ik for met, ik in zip(all_met, pursued, strict=True))
    if as_json:
        shown = metrics.get("", metrics)
        status = "ok" if met else "unreached"
        typer.echo(to_json({"status": status, "file": str(output), "metrics": shown}))
        return met
    for name, of in metrics.items():
        print_metrics(of, name)
    typer.echo(f"wrote {output}")
    return met
