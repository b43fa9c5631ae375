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
        from limbik.core.bodyscene import BodyScene, read_any
        from limbik.core.registry import Registry
        from limbik.plugins.judging import report
        from limbik.plugins.output.encoding import to_json

        registry = Registry()
        read = read_any(scene, registry)
        announce_compiling()
        if isinstance(read, BodyScene):
            from limbik.plugins.judging.bodies import judge_body

            chains = judge_body(read, registry)
            record = report.body_record(read, chains)
        else:
            chains = {"": report.judge(read, registry)}
            record = report.judge_record(read, chains[""])
        if as_json:
            typer.echo(to_json(record))
        for name, verdicts in chains.items() if not as_json else ():
            report.print_verdicts(verdicts, name)
        if not all(map(report.are_passed, chains.values())):
            raise SystemExit(1)
