"""Formats come through hooks as strategies do; core names none; a bad one spoils nothing."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from limbik import Chain, Joint, Registry, hookimpl
from limbik.core.bodyscene import read_body
from limbik.core.errors import PluginError, SceneError
from limbik.core.formats import Body, Inspection, Output, SceneInput, SkeletonInput
from limbik.core.scene import read_scene
from limbik.core.settings import Model
from limbik.plugins.output.baking import inspect_file, output_for


class Stick(Model):
    """A chain of bones in a row."""

    stick: str


def read_stick(model: Stick, folder: Path) -> Body:
    lengths = map(float, (folder / model.stick).read_text().split())
    bones = [Joint(f"bone {k}", (0.0, 0.0, x)) for k, x in enumerate(lengths)]
    return Body(Chain([Joint("base"), *bones]))


def inspect_stick(path: Path) -> Inspection:
    return Inspection("a stick", ("length",), ((path.read_text(),),), ())


STICK = SceneInput("stick", (".stick",), Stick, read_stick, inspect_stick)
WORDS = Output("words", (".txt",), lambda bake: "words")
SCENE = "limbik: 1\nchain: {stick: s.stick}\ngoals: [{position: [0, 1, 2]}]\n"
Offer = Callable[..., Registry]


@pytest.fixture
def offer() -> Offer:
    """Register a plug-in that offers inputs and outputs."""

    def add(inputs: tuple[Any, ...] = (), outputs: tuple[Any, ...] = ()) -> Registry:
        @hookimpl
        def limbik_scene_inputs() -> Any:
            return inputs

        @hookimpl
        def limbik_outputs() -> Any:
            return outputs

        registry = Registry(third_party=False)
        hooks = SimpleNamespace(
            limbik_scene_inputs=limbik_scene_inputs, limbik_outputs=limbik_outputs
        )
        registry.register(hooks, "acme")
        return registry

    return add


def test_built_in_formats_are_those_of_the_manual() -> None:
    registry = Registry(third_party=False)
    assert list(registry.scene_inputs()) == ["bvh", "urdf"]
    assert list(registry.outputs()) == ["bvh", "csv", "glb", "json", "npz"]


def test_blocking_a_plug_in_removes_its_format() -> None:
    registry = Registry(third_party=False, block=["formats.urdf_input", "formats.glb"])
    assert list(registry.scene_inputs()) == ["bvh"]
    assert "glb" not in registry.outputs()


def test_an_offered_input_reads_scenes_and_files(offer: Offer, tmp_path: Path) -> None:
    registry = offer(inputs=(STICK,))
    (tmp_path / "s.stick").write_text("1 2 0.5")
    (tmp_path / "scene.yaml").write_text(SCENE)
    scene = read_scene(tmp_path / "scene.yaml", registry)
    assert scene.chain.lengths.tolist() == [1.0, 2.0, 0.5]
    assert inspect_file(tmp_path / "s.stick", registry).title == "a stick"


def test_an_offered_output_is_chosen_by_its_ending(offer: Offer) -> None:
    assert output_for(Path("a.b.TXT"), offer(outputs=(WORDS,))) is WORDS


def test_without_its_plug_in_the_key_is_unknown(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE)
    with pytest.raises(SceneError, match="unknown key 'stick'"):
        read_scene(tmp_path / "scene.yaml", Registry(third_party=False))


def test_an_input_that_falls_over_is_blamed(offer: Offer, tmp_path: Path) -> None:
    def fall(model: Stick, folder: Path) -> Body:
        raise KeyError("length")

    registry = offer(inputs=(SceneInput("stick", (".stick",), Stick, fall, inspect_stick),))
    (tmp_path / "scene.yaml").write_text(SCENE)
    with pytest.raises(PluginError, match=r"reading s\.stick failed: KeyError: 'length'"):
        read_scene(tmp_path / "scene.yaml", registry)


def test_an_input_of_skeletons_that_falls_over_is_blamed(offer: Offer, tmp_path: Path) -> None:
    def fall_over(model: Stick, folder: Path) -> Any:
        raise KeyError("length")

    registry = offer(inputs=(replace(STICK, skeleton=SkeletonInput(Stick, fall_over)),))
    (tmp_path / "scene.yaml").write_text(
        "limbik: 1\nskeleton: {stick: s.stick}\n"
        "chains: [{name: arm, base: base, end: tip, goals: [{position: [0, 1, 2]}]}]\n",
        encoding="utf-8",
    )

    with pytest.raises(PluginError, match=r"reading s\.stick failed: KeyError: 'length'"):
        read_body(tmp_path / "scene.yaml", registry)


BAD = {
    "kind": (WORDS, "limbik_scene_inputs must return SceneInput objects, not Output"),
    "name": (
        SceneInput("My Stick", (), Stick, read_stick, inspect_stick),
        "the name 'My Stick' must be lower-case words joined by underscores",
    ),
    "ending": (
        SceneInput("stick", ("stick",), Stick, read_stick, inspect_stick),
        "the ending 'stick' must be a dot and lower-case letters, like '.csv'",
    ),
    "field": (
        SceneInput("rod", (".rod",), Stick, read_stick, inspect_stick),
        "its model needs a field 'rod' for the path of the file",
    ),
    "taken": (
        SceneInput(
            "urdf",
            (".urdf",),
            type("U", (Stick,), {"__annotations__": {"urdf": str}}),
            read_stick,
            inspect_stick,
        ),
        "the name is also offered by plug-in 'formats.urdf_input' (built-in)",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_bad_format_is_named_with_its_cause(offer: Offer, kind: str) -> None:
    bad, cause = BAD[kind]
    with pytest.raises(PluginError) as caught:
        offer(inputs=(bad,))
    assert (caught.value.plugin, caught.value.slot) == ("acme", "scene_input")
    assert cause in str(caught.value)


def test_core_names_no_format() -> None:
    core = Path(__file__).parents[2] / "core"
    words = ("urdf", "bvh", "glb")
    # In docstrings only.
    allowed = {"bodymodel.py", "frames.py", "scene.py", "formats.py", "schema.py"}
    for path in core.rglob("*.py"):
        code = path.read_text(encoding="utf-8")
        if path.name in allowed:
            code = _without_docstrings(code)
        assert [word for word in words if word in code.lower()] == [], path


def _without_docstrings(code: str) -> str:
    import ast

    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            node.value.value = ""
    return ast.unparse(tree)
