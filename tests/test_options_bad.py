"""Bad parameters, strategies and goals are refused by name, with what is right."""

from typing import Any

import numpy as np
import pytest

from limbik.core.errors import InputError
from limbik.core.solver import Solver
from limbik.tests.limbs import (
    LIMB,
    REGISTRY,
    solve,
    solver,
)

BAD_PARAMETERS: list[tuple[str, dict[str, Any], str, str]] = [
    ("bend_vector", {"use": "manual", "angle": 361.0}, "angle", "361"),
    ("bend_vector", {"use": "manual", "exclude_bank": 1}, "exclude_bank", "true or false"),
    (
        "bend_vector",
        {"use": "manual", "direction": (1, 0, 0)},
        "direction",
        "takes angle, exclude_bank",
    ),
    ("bend_vector", {"use": "auto", "sensitivity": 0.0005}, "sensitivity", "0 (off) or 0.001"),
    ("bend_vector", {"use": "auto", "sensitivity": 11.0}, "sensitivity", "10"),
    ("bend_vector", {"use": "auto", "strength": 1.1}, "strength", "1"),
    ("bend_vector", {"use": "global", "direction": (0.0, 0.0, 0.0)}, "", "must point somewhere"),
    ("bend_vector", {"use": "global", "direction": (0.0, 1.0)}, "direction", ""),
    ("bank_suppression", {"use": "threshold", "angle": 2.1}, "angle", "2"),
    (
        "bank_suppression",
        {"use": "threshold", "heading_correction": "no"},
        "heading_correction",
        "",
    ),
    ("bank_suppression", {"use": "threshold", "all_stages": 0}, "all_stages", "true or false"),
    ("root_control", {"use": "suppress-flip", "angle": 80.0}, "angle", "takes no parameters"),
    ("initial_bend", {"use": "nth-root", "n": 4}, "n", "takes no parameters"),
]


@pytest.mark.parametrize(("slot", "choice", "key", "message"), BAD_PARAMETERS)
def test_a_bad_parameter_of_a_strategy_is_named(
    slot: str, choice: dict[str, Any], key: str, message: str
) -> None:
    with pytest.raises(InputError) as caught:
        solver(LIMB, **{slot: choice})
    (fault,) = caught.value.faults
    assert key in f"{fault.key} {fault.message}"
    assert message in f"{fault.message} {fault.hint}"


BAD_OPTIONS: list[tuple[dict[str, Any], str]] = [
    (
        {"tolerence": 0.1},
        "error[unknown-key]: tolerence: unknown key 'tolerence' (did you mean 'tolerance'?)",
    ),
    ({"tolerance": -1}, "error[range]: tolerance: must be above 0.0, not -1"),
    ({"held": {"base": "x"}}, "error[type]: held.base: must be a whole number, not text 'x'"),
]


@pytest.mark.parametrize(("options", "message"), BAD_OPTIONS)
def test_a_bad_option_is_named_and_what_is_right(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError) as caught:
        Solver(LIMB, registry=REGISTRY, **options)
    assert str(caught.value) == message
    with pytest.raises(InputError) as caught:
        solver(LIMB).altered(**options)
    assert str(caught.value) == message


@pytest.mark.parametrize("threads", [0, -1])
def test_fewer_than_one_thread_is_refused(threads: int) -> None:
    with pytest.raises(InputError, match=f"threads: expected at least 1, found {threads}"):
        solver(LIMB).solve_many(np.ones((2, 3)), threads=threads)


BAD_GOALS: list[tuple[dict[str, Any], str]] = [
    ({"goal": (0.0, 1.0)}, "goal: expected shape (3,), found (2,)"),
    ({"goal": (0.0, np.nan, 0.0)}, "goal: every number must be finite and below 1e+100 in size"),
    ({"goal": (0.0, 1e101, 0.0)}, "goal: every number must be finite and below 1e+100 in size"),
    ({"goal": "here"}, "goal: expected numbers of shape (3,)"),
    ({"fk": np.zeros((3, 3))}, "FK offsets: expected shape (4, 3), found (3, 3)"),
    ({"fk": np.full((4, 3), np.inf)}, "FK offsets: every number must be finite"),
]


@pytest.mark.parametrize(("given", "message"), BAD_GOALS, ids=[str(case[1]) for case in BAD_GOALS])
def test_a_goal_that_is_none_is_refused(given: dict[str, Any], message: str) -> None:
    """C-04, C-07."""
    with pytest.raises(InputError) as caught:
        solve(**given)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "name", ["initial_bend", "bend_vector", "root_control", "bank_suppression"]
)
def test_an_unknown_strategy_is_refused_with_those_there_are(name: str) -> None:
    with pytest.raises(InputError, match="known"):
        solver(LIMB, **{name: "nosuch"})
    assert REGISTRY.strategies(name)
