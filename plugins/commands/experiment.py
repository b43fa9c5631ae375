"""The commands `limbik experiment run`, `report` and `list`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from limbik.plugins.commands.common import AsJson, announce_compiling
from limbik.plugins.output.failures import reported

if TYPE_CHECKING:
    from limbik.plugins.experiments.run import Outcome, Run

experiment = typer.Typer(
    name="experiment",
    help="Compare strategies, options, chains and goals: one YAML file, one table, one report.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)


@experiment.command()
def run(
    file: Annotated[Path, typer.Argument(help="Experiment file (YAML).")],
    output: Annotated[
        str | None, typer.Option("-o", "--output", help="Folder; absent = as the file says.")
    ] = None,
    engine: Annotated[
        str | None, typer.Option(help="serial, local or dask://HOST:PORT; absent = as the file.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Processes of the engine local; absent = all cores.")
    ] = None,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Change the file: seed=7, a.b=1,2 ..."),
    ] = None,
    new: Annotated[
        bool, typer.Option("--new", help="Take a new folder if this one holds another experiment.")
    ] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would be done, and how long it takes.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Run an experiment; one that was interrupted goes on where it was.

    limbik experiment run bends.yaml

    limbik experiment run bends.yaml --set sweep.smoothing=0.1,0.5 -o runs/smooth
    """
    with reported(as_json):
        from limbik.plugins.experiments.overrides import Override, read_override
        from limbik.plugins.experiments.read import read_experiment
        from limbik.plugins.experiments.run import prepare
        from limbik.plugins.experiments.run import run as run_prepared
        from limbik.plugins.output.baking import progress
        from limbik.plugins.output.encoding import to_json

        given = {"output": output, "engine": engine, "workers": workers}
        overrides = [read_override(text) for text in settings or ()]
        overrides += [
            Override(f"--{key} {value}", (key,), value)
            for key, value in given.items()
            if value is not None
        ]
        prepared = prepare(read_experiment(file, overrides))
        announce_compiling()
        if dry_run:
            record = _expected(prepared)
            typer.echo(to_json(record) if as_json else _expected_words(record))
            return
        total = sum(batch.solves for batch in prepared.batches)
        try:
            with progress(total) as report:
                outcome = run_prepared(prepared, new, report)
        except KeyboardInterrupt:
            typer.echo("limbik: finished parts stay; run it again to go on", err=True)
            raise
        record = _finished(prepared, outcome)
        typer.echo(to_json(record) if as_json else _finished_words(record))


@experiment.command()
def report(
    folder: Annotated[Path, typer.Argument(help="Folder of a run.")],
    as_json: AsJson = False,
) -> None:
    """Sum a run up: a table here, report.html and pictures in its folder.

    limbik experiment report runs/bends

    limbik experiment report runs/bends --json
    """
    with reported(as_json):
        from limbik.plugins.experiments.report import print_summary, summary_record, write_report
        from limbik.plugins.experiments.summary import summarise
        from limbik.plugins.output.encoding import to_json

        summary = summarise(folder)
        written = write_report(summary)
        if as_json:
            typer.echo(to_json(summary_record(summary, written)))
        else:
            print_summary(summary)
            for path in written:
                typer.echo(f"wrote {path}")


@experiment.command("list")
def list_runs(
    folder: Annotated[Path, typer.Argument(help="Folder that holds the runs' folders.")] = Path(
        "runs"
    ),
    as_json: AsJson = False,
) -> None:
    """List the runs there are, and how far each has come.

    limbik experiment list

    limbik experiment list elsewhere --json
    """
    with reported(as_json):
        from limbik.plugins.experiments.listing import print_runs, runs_in
        from limbik.plugins.output.encoding import to_json

        found = runs_in(folder)
        if as_json:
            typer.echo(to_json({"status": "ok", "runs": found}))
        else:
            print_runs(folder, found)


def _expected(prepared: "Run") -> dict[str, Any]:
    from limbik.plugins.experiments.estimate import estimate

    expected = estimate(prepared)
    return {
        "status": "ok",
        "name": prepared.experiment.name,
        "folder": str(prepared.output),
        "engine": prepared.engine,
        "trials": len(prepared.experiment.trials),
        "solves": prepared.solves,
        "batches": len(prepared.batches),
        "seconds": expected.seconds,
        "bytes": int(expected.size),
    }


def _expected_words(record: dict[str, Any]) -> str:
    return (
        f"{record['name']}: {record['trials']} trials, {record['solves']} solves in "
        f"{record['batches']} batches, by engine {record['engine']} into {record['folder']}\n"
        f"about {record['seconds']:.3g} s of one core (without metrics) "
        f"and {record['bytes'] / 1e6:.3g} MB"
    )


def _finished(prepared: "Run", outcome: "Outcome") -> dict[str, Any]:
    return {
        "status": "ok",
        "name": prepared.experiment.name,
        "folder": str(outcome.folder),
        "fingerprint": prepared.manifest["fingerprint"],
        "engine": prepared.engine,
        "trials": len(prepared.experiment.trials),
        "solves": prepared.solves,
        "parts": outcome.parts,
        "parts_before": outcome.before,
        "failed": outcome.failed,
    }


def _finished_words(record: dict[str, Any]) -> str:
    before = f", {record['parts_before']} of them were there" if record["parts_before"] else ""
    failed = f"; {record['failed']} solves failed" if record["failed"] else ""
    return (
        f"{record['folder']}: {record['trials']} trials, {record['solves']} solves "
        f"in {record['parts']} parts{before}{failed}\n"
        f"next: limbik experiment report {record['folder']}"
    )
