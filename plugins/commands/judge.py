"""The command `limbik judge`."""

import typer

from limbik.plugins.commands.common import AsJson, SceneFile, announce_compiling
from limbik.plugins.output.failures import reported


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
        announce_compiling()
        verdicts = report.judge(read, registry)
        if as_json:
            typer.echo(to_json(report.judge_record(read, verdicts)))
        else:
            report.print_verdicts(verdicts)
        if not report.are_passed(verdicts):
            raise SystemExit(1)
