"""Errors of a schema become faults: the right code, place, words, and only what helps."""

from typing import Annotated, Any, Literal

import pytest
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from limbik.core.errors import Fault
from limbik.core.validation import known_keys, validation_faults
from limbik.core.wording import found_words
from limbik.core.yamlfile import read_yaml


class Model(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class Cone(Model):
    axis: Literal["x+", "y+"]
    half_angle: Annotated[float, Field(gt=0.0, le=90.0)] = 30.0


class Joint(Model):
    name: Annotated[str, Field(min_length=1, max_length=8, pattern="^[a-z]*$")]
    offset: Annotated[list[float], Field(min_length=3, max_length=3)] = [0.0, 0.0, 0.0]


class Point(Model):
    kind: Literal["point"]
    at: list[float]


class Pose(Model):
    kind: Literal["pose"]
    turn: float


class Scene(Model):
    version: Literal[1] = 1
    ik: bool = True
    rounds: Annotated[int, Field(ge=-2, lt=100)] = 20
    joints: Annotated[list[Joint], Field(min_length=1)] = [Joint(name="a")]
    bend: str | dict[str, Any] = "nth-root"
    cone: Cone | None = None
    weight: Annotated[float, Field(ge=0.0)] | Cone = 1.0
    goal: Annotated[Point | Pose, Field(discriminator="kind")] | None = None
    limits: dict[str, list[float]] = {}
    size: Annotated[float, Field(alias="scale")] = 1.0

    @model_validator(mode="after")
    def _no_rounds_without_ik(self) -> "Scene":
        if not self.ik and self.rounds > 50:
            raise ValueError("rounds above 50 need ik")
        return self


def faults(text: str) -> list[Fault]:
    document = read_yaml(text, "s.yaml")
    with pytest.raises(ValidationError) as caught:
        Scene.model_validate(document.content)
    return validation_faults(caught.value, document, Scene)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("version: 2", "1:10: error[choice]: version: must be 1, not 2"),
        (
            "version: '1'",
            "1:10: error[choice]: version: must be 1, not text '1' (write it without quotes)",
        ),
        ("ik: yes", "1:5: error[type]: ik: must be true or false, not text 'yes' (write true)"),
        (
            "ik: False",
            "1:5: error[type]: ik: must be true or false, not text 'False' (write false)",
        ),
        ("ik: 1", "1:5: error[type]: ik: must be true or false, not 1"),
        ("rounds: 1.5", "1:9: error[type]: rounds: must be a whole number, not 1.5"),
        ("rounds: true", "1:9: error[type]: rounds: must be a whole number, not true"),
        ("rounds: -3", "1:9: error[range]: rounds: must be at least -2, not -3"),
        ("rounds: 100", "1:9: error[range]: rounds: must be below 100, not 100"),
        ("scale: 1_0", "1:8: error[type]: scale: must be a number, not text '1_0' (write 10)"),
        (
            "scale: '2.5'",
            "1:8: error[type]: scale: must be a number, not text '2.5' (write 2.5, without quotes)",
        ),
        ("scale: null", "1:8: error[type]: scale: must be a number, not null"),
        ("scale: {}", "1:8: error[type]: scale: must be a number, not a mapping"),
        ("joints:", "1:8: error[type]: joints: must be a list, not null"),
        ("joints: {}", "1:9: error[type]: joints: must be a list, not a mapping"),
        ("joints: []", "1:9: error[length]: joints: must be a list of at least 1, not a list of 0"),
        ("joints: [3]", "1:10: error[type]: joints[0]: must be a mapping, not 3"),
        (
            "joints: [{name: 7}]",
            "1:17: error[type]: joints[0].name: must be text, not 7 (write it in quotes)",
        ),
        ("joints: [{name: ''}]", "1:17: error[length]: joints[0].name: must not be empty"),
        (
            "joints: [{name: abcdefghi}]",
            "1:17: error[length]: joints[0].name: must be at most 8 characters, "
            "not text 'abcdefghi'",
        ),
        (
            "joints: [{name: A/B}]",
            "1:17: error[pattern]: joints[0].name: must be text of the form ^[a-z]*$, "
            "not text 'A/B'",
        ),
        (
            "joints: [{name: a, offset: [1, 2, x]}]",
            "1:35: error[type]: joints[0].offset[2]: must be a number, not text 'x'",
        ),
        (
            "joints: [{name: a, offset: [1, 2]}]",
            "1:28: error[length]: joints[0].offset: must be a list of at least 3, not a list of 2",
        ),
        (
            "joints: [{offset: [1, 2, 3]}]",
            "1:10: error[missing-key]: joints[0].name: key 'name' is",
        ),
        (
            "cone:\n  axis: X+",
            "2:9: error[choice]: cone.axis: must be 'x+' or 'y+', not text 'X+' "
            "(did you mean 'x+'?)",
        ),
        (
            "cone: {axis: x+, half_angle: 0}",
            "1:30: error[range]: cone.half_angle: must be above 0.0, not 0",
        ),
        ("bend: 3", "1:7: error[type]: bend: must be text or a mapping, not 3"),
        ("weight: -1", "1:9: error[range]: weight: must be at least 0.0, not -1"),
        ("weight: x", "1:9: error[type]: weight: must be a number or a mapping, not text 'x'"),
        ("weight: {axis: z}", "1:16: error[choice]: weight.axis: must be 'x+' or 'y+', not text"),
        ("goal: {kind: spot}", "1:7: error[choice]: goal: 'kind' must be one of 'point', 'pose'"),
        ("goal: {}", "1:7: error[missing-key]: goal: key 'kind' is missing"),
        ("goal: {kind: pose, turn: x}", "1:26: error[type]: goal.turn: must be a number"),
        ("limits: {arm: [a]}", "1:16: error[type]: limits.arm[0]: must be a number, not text 'a'"),
        ("ik: false\nrounds: 60", "1:1: error[value]: rounds above 50 need ik"),
        ("- 1", "1:1: error[type]: must be a mapping, not a list of 1"),
        ("hello", "1:1: error[type]: must be a mapping, not text 'hello'"),
        (
            "verson: 1",
            "1:1: error[unknown-key]: verson: unknown key 'verson' (did you mean 'version'?)",
        ),
        (
            "cone: {axis: x+, half: 3}",
            "1:18: error[unknown-key]: cone.half: unknown key 'half' (did",
        ),
        ("cone: {axis: x+, zz: 3}", "1:18: error[unknown-key]: cone.zz: unknown key 'zz' (known: "),
        (
            "goal: {kind: pose, turn: 1, trun: 2}",
            "1:29: error[unknown-key]: goal.trun: unknown key",
        ),
    ],
)
def test_a_single_fault_is_worded_at_its_place(text: str, expected: str) -> None:
    (fault,) = faults(text)
    assert str(fault).startswith(f"s.yaml:{expected}")


def test_a_mistyped_key_hides_the_missing_one_it_stands_for() -> None:
    (fault,) = faults("joints: [{nmae: a}]")
    assert (fault.code, fault.key) == ("unknown-key", "joints[0].nmae")
    assert fault.hint == "did you mean 'name'?"


def test_a_missing_key_is_reported_beside_a_key_that_is_not_like_it() -> None:
    assert {fault.code for fault in faults("joints: [{color: a}]")} == {
        "unknown-key",
        "missing-key",
    }


def test_keys_already_given_are_suggested_last() -> None:
    (fault,) = faults("cone: {axis: x+, axes: y+}")
    assert fault.hint == "did you mean 'axis'?"


def test_all_faults_come_sorted_by_line() -> None:
    text = "scale: x\nik: 3\nzz: 1\njoints: [{name: a, offset: [a]}]\nversion: 3\n"
    assert [fault.line for fault in faults(text)] == [1, 2, 3, 4, 5]


def test_at_most_twenty_faults_are_listed() -> None:
    listed = faults("".join(f"key{n}: 1\n" for n in range(50)))
    assert len(listed) == 20
    assert listed[-1].message == "31 more faults are not shown"


def test_content_from_inside_a_document_is_placed_in_the_whole() -> None:
    document = read_yaml("a:\n  - cone: {axis: q}\n", "s.yaml")
    with pytest.raises(ValidationError) as caught:
        Cone.model_validate(document.content["a"][0]["cone"])
    (fault,) = validation_faults(caught.value, document, Cone, ("a", 0, "cone"))
    assert str(fault).startswith("s.yaml:2:18: error[choice]: a[0].cone.axis: must be")


def test_a_fixed_tuple_that_is_too_short_is_one_fault_about_its_length() -> None:
    class Pair(BaseModel):
        at: tuple[float, float, float]

    document = read_yaml("at: [1]", "s.yaml")
    with pytest.raises(ValidationError) as caught:
        Pair.model_validate(document.content)
    (fault,) = validation_faults(caught.value, document, Pair)
    assert str(fault) == "s.yaml:1:5: error[length]: at: must be a list of 3, not a list of 1"


@pytest.mark.parametrize(
    ("path", "keys"),
    [
        (("cone",), ["axis", "half_angle"]),
        (("joints", 4), ["name", "offset"]),
        (("weight",), ["axis", "half_angle"]),
        (("goal",), ["kind", "at", "turn"]),
        (("bend",), []),
        (("nothing", "there"), []),
    ],
)
def test_the_known_keys_of_a_place_are_those_of_its_models(
    path: tuple[str | int, ...], keys: list[str]
) -> None:
    assert known_keys(Scene, path) == keys
    assert "scale" in known_keys(Scene)
    assert "size" not in known_keys(Scene)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (None, "null"),
        (True, "true"),
        (0.5, "0.5"),
        ("x" * 50, f"text '{'x' * 37}...'"),
        ([1, 2], "a list of 2"),
        ({"a": 1}, "a mapping"),
    ],
)
def test_found_values_are_said_briefly(value: object, words: str) -> None:
    assert found_words(value) == words
