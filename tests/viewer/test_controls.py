"""Every option and every parameter has a control, read from its model."""

from enum import IntEnum
from typing import Annotated, NamedTuple

from pydantic import Field

from limbik.core.params import model
from limbik.core.pole import PoleRotor
from limbik.core.settings import Choose, Settings
from limbik.core.slots import OPTIONS
from limbik.plugins.viewer.controls import Control, controls, value_at


def paths(found: list[Control]) -> set[tuple[str, ...]]:
    return {control.path for control in found}


def test_every_option_has_a_control_or_is_a_slot() -> None:
    reached = {path[0] for path in paths(controls(Settings))}
    assert reached | set(OPTIONS) == set(Settings.model_fields)
    assert {path[1] for path in paths(controls(Settings)) if path[0] == "choose" and path[1:]} == (
        set(Choose.model_fields)
    )


def test_a_table_by_joint_has_a_control_for_each() -> None:
    found = {control.path: control for control in controls(Settings) if control.by_joint}
    assert set(found) == {("stiffness",), ("choose", "pose"), ("choose", "weights")}
    elbow = found["stiffness",].of_joint("elbow")
    assert (elbow.path, elbow.kind, elbow.absent) == (("stiffness", "elbow"), "float", 0.0)
    assert found["choose", "weights"].absent == 1.0
    assert (found["choose", "pose"].kind, found["choose", "pose"].size) == ("vector", 3)


def test_a_rotor_shows_all_it_has() -> None:
    assert {path[0] for path in paths(controls(PoleRotor))} == set(PoleRotor.model_fields)


def test_every_control_finds_its_value_in_the_settings() -> None:
    values = Settings().model_dump()
    for control in controls(Settings):
        held = value_at(values, control.path)
        if control.by_joint:
            continue
        if control.kind == "choice" and held is not None:
            assert held in control.choices
        if control.kind == "vector":
            assert len(held) == control.size


def test_ranges_and_meanings_come_from_the_model() -> None:
    smoothing = next(c for c in controls(Settings) if c.path == ("smoothing",))
    assert (smoothing.kind, smoothing.low, smoothing.high) == ("float", 0.1, 1.0)
    assert smoothing.text == "CCD round k has strength min(k x this, 1)"


def test_an_optional_group_is_a_switch_that_starts_with_something_valid() -> None:
    switches = {c.path: c for c in controls(Settings) if c.kind == "switch"}
    assert {("forbidden_cone",), ("choose",)} <= switches.keys()
    for path, switch in switches.items():
        if len(path) == 1:
            assert getattr(Settings(**{path[0]: switch.initial}), path[0]) is not None
    pose = switches["choose", "pose"].initial
    assert Choose(pose=pose, weights={}).pose == {}


class Colour(IntEnum):
    RED = 0
    DARK_BLUE = 1


class Params(NamedTuple):
    share: Annotated[float, Field(ge=0.0, le=1.0, description="how much")] = 0.5
    rounds: int = 3
    on: bool = False
    colour: Colour = Colour.RED
    way: tuple[float, float, float] = (0.0, 0.0, 1.0)


def test_all_kinds_of_parameters_a_plugin_may_have_get_controls() -> None:
    assert controls(model(Params)) == [
        Control(("share",), "float", 0.0, 1.0, text="how much"),
        Control(("rounds",), "int"),
        Control(("on",), "bool"),
        Control(("colour",), "choice", choices=("red", "dark-blue")),
        Control(("way",), "vector", size=3),
    ]
