"""The command `limbik view`."""

import webbrowser
from typing import Annotated

import typer

from limbik.plugins.commands.common import SceneFile, announce_compiling, say_notes
from limbik.plugins.output.failures import reported


def view(
    scene: SceneFile,
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port; the next free one if taken, 0 for any.")
    ] = 8080,
    host: Annotated[
        str, typer.Option(help="Address to listen at; the default is for this machine only.")
    ] = "127.0.0.1",
    timeout: Annotated[
        int,
        typer.Option(min=0, help="Seconds to go on after the last page closed; 0 keeps serving."),
    ] = 5,
    open_browser: Annotated[
        bool, typer.Option("--open", help="Open the page in the browser.")
    ] = False,
) -> None:
    """Show a scene in the browser: drag its goal and see what the solver makes of it.

    limbik view arm.yaml

    limbik view leg-pole.yaml --open

    The server ends by itself a few seconds after its last page was closed.
    """
    with reported():
        from limbik.core.bodyscene import read_any
        from limbik.core.registry import Registry
        from limbik.plugins.viewer.server import Viewer, check_viewer, is_loopback
        from limbik.plugins.viewer.session import Session

        check_viewer()
        if not is_loopback(host):
            typer.echo("limbik: whoever reaches this address can use the page", err=True)
        registry = Registry()
        read = read_any(scene, registry)
        say_notes(read)
        announce_compiling()
        viewer = Viewer(Session(read, registry), host, port)
        try:
            ends = "closing the page or Ctrl-C ends it" if timeout else "Ctrl-C ends it"
            typer.echo(f"{read.document.name} is at {viewer.url} ({ends})")
            if open_browser:
                webbrowser.open(viewer.url)
            viewer.wait(timeout)
            typer.echo("limbik: the last page was closed", err=True)
        except KeyboardInterrupt:  # the usual end
            pass
        finally:
            viewer.close()
