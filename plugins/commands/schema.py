"""The command `limbik schema`."""

import typer

from limbik.plugins.output.failures import reported


def schema() -> None:
    """Write the JSON Schema of scenes, for editors that check and complete YAML.

    limbik schema > limbik.schema.json

    limbik schema | head
    """
    with reported():
        from limbik.plugins.output.templates import schema_text

        typer.echo(schema_text(), nl=False)
