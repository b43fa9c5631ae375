"""Settings: the document's defaults, and a message for every value out of range."""

from typing import Any

import pytest
from pydantic import ValidationError

from limbik.core.errors import InputError
from limbik.core.registry import Registry
from limbik.core.settings import Settings

# Tables 7-4, 7-5 and 7-19, and the solver's options of 6.3 whose default the text gives.
DOCUMENT: dict[str, Any] = {
    "tolerance": 0.01,  # table 7-4 row 3
    "max_iterations": 20,  # row 4
    "max_violations": 0,  # row 5
    "initial_bend": "nth-root",  # row 6
    "coefficient_base": 1.0,  # row 7
    "weight_range": (0.0, 0.0),  # row 8
    "smoothing": 0.1,  # row 9
    "bend_reference": 1,
    "reference_axis": "y+",
    "twist": 0.0,
    "aim_twist": False,
    "bank_lock": False,
    "off_axis": False,
    "hold_bend_vector": False,  # table 7-19 row 4
    "forbidden_cone": None,  # rows 5-7
    "bend_smoothing": 0.0,
    "bank_suppression": "none",
    "root_control": "none",
    "fk_strength": 1.0,
    "fk_mix": 0.0,
    "ik": True,
    "reach_limit": False,
}


@pytest.mark.parametrize("name", DOCUMENT)
def test_defaults_are_the_documents(name: str) -> None:
    assert getattr(Settings(), name) == DOCUMENT[name]


def test_no_joint_is_held_by_default() -> None:
    """Table 7-5."""
    assert Settings().held.model_dump() == {
        "base": 0,
        "end": 0,
        "bend_base": False,
        "bend_end": False,
    }


def test_bend_vector_defaults_are_those_of_table_7_19() -> None:
    registry = Registry(third_party=False)
    manual = registry.bind("bend_vector", Settings().bend_vector)
    assert (manual.name, manual.params) == ("manual", (0.0, False))  # rows 1-3
    auto = registry.bind("bend_vector", "auto").params._asdict()
    assert (auto["sensitivity"], auto["strength"]) == (0.1, 0.1)  # rows 8, 9


RANGES: list[tuple[dict[str, Any], str]] = [
    ({"tolerance": 0.0}, "above 0"),
    ({"max_iterations": -3}, "at least -2"),
    ({"max_iterations": 100_001}, "at most 100000"),
    ({"max_iterations": 2.0}, "a whole number"),
    ({"smoothing": 0.09}, "at least 0.1"),
    ({"smoothing": 1.01}, "at most 1"),
    ({"max_violations": -1}, "at least 0"),
    ({"held": {"base": -1}}, "at least 0"),
    ({"held": {"end": -1}}, "at least 0"),
    ({"held": {"bend_base": 1}}, "true or false"),
    ({"coefficient_base": -0.1}, "at least 0"),
    ({"coefficient_base": 2.1}, "at most 2"),
    ({"weight_range": (-1.1, 0.0)}, "at least -1"),
    ({"weight_range": (0.0, 1.1)}, "at most 1"),
    ({"weight_range": (0.0,)}, "a list of 2"),
    ({"bend_reference": -1}, "at least 0"),
    ({"reference_axis": "z+"}, "'free', 'x+', 'x-', 'y+' or 'y-'"),
    ({"twist": 361.0}, "at most 360"),
    ({"aim_twist": "yes"}, "true or false"),
    ({"off_axis": 1}, "true or false"),
    ({"aim_from": "rest"}, "'initial' or 'previous'"),
    ({"bank_lock": None}, "true or false"),
    ({"forbidden_cone": {"axis": "w+", "half_angle": 20.0}}, "'x+', 'x-', 'y+', 'y-'"),
    ({"forbidden_cone": {"axis": "x+", "half_angle": 0.0}}, "above 0"),
    ({"forbidden_cone": {"axis": "x+", "half_angle": 90.1}}, "at most 90"),
    (
        {"forbidden_cone": {"axis": "x+", "half_angle": 9.0, "entry": "bounce"}},
        "'stop' or 'go-around'",
    ),
    ({"hold_bend_vector": 0}, "true or false"),
    (
        {"hold_bend_vector": True, "bend_vector": "auto"},
        "hold_bend_vector goes with the modes manual and global, not with auto",
    ),
    (
        {"hold_bend_vector": True, "bend_vector": {"use": "auto", "strength": 0.5}},
        "hold_bend_vector goes with the modes manual and global, not with auto",
    ),
    ({"bend_smoothing": -0.1}, "at least 0"),
    ({"bend_smoothing": 45.1}, "at most 45"),
    ({"reach_limit": "no"}, "true or false"),
    ({"clamp": "soft"}, "'re-aim' or 'plain'"),
    ({"fk_strength": 1.1}, "at most 1"),
    ({"fk_strength": -0.1}, "at least 0"),
    ({"fk_mix": 1.1}, "at most 1"),
    ({"fk_mix": -0.1}, "at least 0"),
    ({"ik": 0}, "true or false"),
    ({"tolerance": float("nan")}, "finite"),
    ({"tolerance": "0.01"}, "a number"),
    ({"initial_bend": 3}, "text"),
    ({"speed": 1}, "unknown key"),
]


@pytest.mark.parametrize(("given", "message"), RANGES, ids=[str(case[0]) for case in RANGES])
def test_a_value_out_of_range_is_refused_with_what_is_right(
    given: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError) as caught:
        Settings(**given)
    (fault, *_) = caught.value.faults
    assert message in fault.message
    if not given.get("hold_bend_vector"):
        assert fault.key.startswith(next(iter(given)))


def test_settings_cannot_be_changed_after() -> None:
    with pytest.raises(ValidationError, match="frozen"):
        Settings().tolerance = 1.0
