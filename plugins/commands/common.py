"""What several commands share: arguments and notices."""

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from limbik.core.bodyscene import BodyScene
    from limbik.core.scene import Scene

SceneFile = Annotated[str, typer.Argument(help="Scene file (YAML), or - for standard input.")]
AsJson = Annotated[bool, typer.Option("--json", help="Write one JSON object to stdout.")]


def announce_compiling() -> None:
    """Say on stderr that the first solve will take long, when it will, and get help for it."""
    from limbik.core.jit import is_compiled_before

    if not is_compiled_before():
        from limbik.core import warm

        warm.start()
        typer.echo("limbik: compiling machine code, once for this version ...", err=True)


def say_notes(scene: "Scene | BodyScene") -> None:
    """Write a scene's notes to stderr."""
    for note in scene.notes:
        typer.echo(f"{scene.document.name}: note: {note}", err=True)
