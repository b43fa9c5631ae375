"""Scenes to start from: copies of those limbik ships in its `configs` folder."""

from pathlib import Path

from limbik.core.errors import Fault, InputError

TEMPLATES = (
    "arm",
    "arm7",
    "arm7-pose",
    "body",
    "cosine-arm",
    "finger",
    "humanoid",
    "lambda-leg",
    "leg",
    "leg-pole",
    "planar",
    "spine",
    "walk",
    "weld",
)
_WITH_FILES = {  # what a scene is read with
    "arm7": "arm7.urdf",
    "arm7-pose": "arm7.urdf",
    "body": "humanoid.urdf",
    "humanoid": "humanoid.urdf",
    "walk": "walk.bvh",
}
SCHEMA_FILE = "limbik.schema.json"


def write_template(name: Path, template: str) -> Path:
    """Write a commented scene that runs, and beside it the schema that editors check it by.

    Args:
        name: File to write; `.yaml` is added if it has no such ending.
        template: One of `TEMPLATES`.

    Returns:
        The file written.

    Raises:
        InputError: There is no such template, the name names no file, or the file exists already.
        EnvironmentProblem: The file cannot be written.
    """
    from importlib.resources import files

    from limbik.core.wording import near_match
    from limbik.plugins.output.files import write_new, write_whole

    if template not in TEMPLATES:
        message = f"no template is called '{template}'; known: {', '.join(TEMPLATES)}"
        hint = near_match(template, list(TEMPLATES))
        raise InputError(Fault("choice", message, "--template", hint=hint))
    if not name.name:
        raise InputError(Fault("choice", f"a file's name is needed, not '{name}'", "name"))
    path = name if name.suffix in (".yaml", ".yml") else name.with_name(f"{name.name}.yaml")
    configs = files("limbik").joinpath("configs")
    text = configs.joinpath(f"{template}.yaml").read_text(encoding="utf-8")
    beside = _WITH_FILES.get(template)
    if beside and not path.exists():
        content = configs.joinpath(beside).read_bytes()
        companion = path.with_name(beside)
        if not companion.exists() or companion.read_bytes() != content:
            write_new(companion, content)
    write_new(path, f"# yaml-language-server: $schema={SCHEMA_FILE}\n{text}")
    schema = path.with_name(SCHEMA_FILE)
    if not schema.exists():
        write_whole(schema, schema_text())
    return path


def schema_text() -> str:
    """Write the JSON Schema of scenes, with the strategies and formats installed here."""
    import json

    from limbik.core.registry import Registry
    from limbik.core.schema import scene_schema

    return json.dumps(scene_schema(Registry()), indent=2) + "\n"
