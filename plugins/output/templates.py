"""Scenes to start from: copies of those limbik ships in its `configs` folder."""

from pathlib import Path

from limbik.core.errors import Fault, InputError

TEMPLATES = ("arm", "leg", "spine", "weld")


def write_template(name: Path, template: str) -> Path:
    """Write a commented scene that runs.

    Args:
        name: File to write; `.yaml` is added if it has no such ending.
        template: One of `TEMPLATES`.

    Returns:
        The file written.

    Raises:
        InputError: There is no such template, or the file exists already.
        EnvironmentProblem: The file cannot be written.
    """
    from importlib.resources import files

    from limbik.core.wording import near_match
    from limbik.plugins.output.files import write_new

    if template not in TEMPLATES:
        message = f"no template is called '{template}'; known: {', '.join(TEMPLATES)}"
        hint = near_match(template, list(TEMPLATES))
        raise InputError(Fault("choice", message, "--template", hint=hint))
    path = name if name.suffix in (".yaml", ".yml") else name.with_name(f"{name.name}.yaml")
    text = files("limbik").joinpath("configs", f"{template}.yaml").read_text(encoding="utf-8")
    write_new(path, text)
    return path
