"""The command `limbik plugins`."""

import typer

from limbik.plugins.commands.common import AsJson
from limbik.plugins.output.failures import reported


def plugins(as_json: AsJson = False) -> None:
    """List plug-ins and every strategy with parameters, defaults, ranges and units.

    limbik plugins

    limbik plugins --json
    """
    with reported(as_json):
        from limbik.core.registry import Registry
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.listing import plugin_record

        record = plugin_record(Registry())
        if as_json:
            typer.echo(to_json(record))
        else:
            from limbik.plugins.output.table import print_plugins

            print_plugins(record)
