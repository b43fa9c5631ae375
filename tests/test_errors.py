"""Errors carry what, where and what would be right; their exit codes are a promise to scripts."""

import pickle

import pytest

from limbik.core.errors import (
    MOST_FAULTS,
    ChainError,
    EnvironmentProblem,
    Fault,
    InputError,
    LimbikError,
    PluginError,
    SceneError,
    key_text,
    shortlist,
)


@pytest.mark.parametrize(
    ("kind", "code"),
    [
        (InputError, 2),
        (ChainError, 2),
        (SceneError, 2),
        (EnvironmentProblem, 3),
        (PluginError, 4),
    ],
)
def test_exit_codes_are_those_of_the_command_line(kind: type[LimbikError], code: int) -> None:
    assert kind.exit_code == code
    assert issubclass(kind, LimbikError)


@pytest.mark.parametrize("kind", [ChainError, SceneError])
def test_faults_of_chain_and_scene_are_input_errors(kind: type[InputError]) -> None:
    with pytest.raises(InputError):
        raise kind("no bones")


@pytest.mark.parametrize(
    ("fault", "text"),
    [
        (Fault("empty", "nothing here"), "error[empty]: nothing here"),
        (Fault("c", "m", key="a[0].b"), "error[c]: a[0].b: m"),
        (Fault("c", "m", file="s.yaml"), "s.yaml: error[c]: m"),
        (Fault("c", "m", file="s.yaml", line=3), "s.yaml:3: error[c]: m"),
        (
            Fault("c", "m", key="k", file="s.yaml", line=3, column=7, hint="try x"),
            "s.yaml:3:7: error[c]: k: m (try x)",
        ),
        (Fault("c", "m", line=3, column=7), "3:7: error[c]: m"),
    ],
)
def test_a_fault_reads_like_a_compilers_and_leaves_out_what_is_empty(
    fault: Fault, text: str
) -> None:
    assert str(fault) == text


def test_an_input_error_has_a_line_for_each_fault() -> None:
    error = InputError([Fault("a", "one"), Fault("b", "two")])
    assert str(error).splitlines() == ["error[a]: one", "error[b]: two"]
    assert [fault.code for fault in error.faults] == ["a", "b"]


def test_an_input_error_without_a_fault_is_a_mistake_of_the_caller() -> None:
    with pytest.raises(ValueError, match="at least one fault"):
        InputError([])


def test_a_chain_error_names_its_joint() -> None:
    error = ChainError("the offset must be finite", joint="elbow")
    assert error.joint == "elbow"
    assert str(error) == "error[chain]: elbow: the offset must be finite"
    assert ChainError("no bones").joint is None


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (PluginError("no"), "no"),
        (PluginError("no", "acme"), "plug-in 'acme': no"),
        (
            PluginError("no", "acme", "spiral", "initial_bend"),
            "plug-in 'acme', initial_bend 'spiral': no",
        ),
        (PluginError("no", strategy="spiral"), "strategy 'spiral': no"),
    ],
)
def test_a_plugin_error_says_whose_fault_it_is(error: PluginError, text: str) -> None:
    assert str(error) == text


@pytest.mark.parametrize(
    "error",
    [
        InputError([Fault("a", "one"), Fault("b", "two", line=3)]),
        ChainError("no", joint="elbow"),
        SceneError(Fault("a", "one")),
        EnvironmentProblem("no port"),
        PluginError("no", "acme", "spiral", "initial_bend"),
    ],
)
def test_errors_cross_to_another_process_whole(error: LimbikError) -> None:
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)


@pytest.mark.parametrize(
    ("path", "text"),
    [
        ((), ""),
        (("chain", "joints", 1, "offset", 2), "chain.joints[1].offset[2]"),
        ((3,), "[3]"),
        (("a", "two words", "b"), "a['two words'].b"),
        (("half-angle",), "half-angle"),
        (("x" * 100,), f"['{'x' * 37}...']"),
    ],
)
def test_a_place_is_written_the_way_it_is_read(path: tuple[str | int, ...], text: str) -> None:
    assert key_text(path) == text


def test_a_shortlist_is_sorted_by_line_with_unknown_keys_first_in_it() -> None:
    faults = [
        Fault("type", "c", line=5, column=1),
        Fault("type", "a", line=2, column=3),
        Fault("unknown-key", "b", line=2, column=9),
    ]
    assert [fault.message for fault in shortlist(faults)] == ["b", "a", "c"]


def test_a_long_list_keeps_unknown_keys_and_says_how_many_are_left_out() -> None:
    faults = [Fault("type", "t", line=n) for n in range(1, 40)]
    faults.append(Fault("unknown-key", "typo", line=99))
    short = shortlist(faults)
    assert len(short) == MOST_FAULTS
    assert short[-2].message == "typo"
    assert short[-1].message == "21 more faults are not shown"


def test_as_many_faults_as_fit_are_all_shown() -> None:
    faults = [Fault("type", "t", line=n) for n in range(1, MOST_FAULTS + 1)]
    assert shortlist(faults) == faults
