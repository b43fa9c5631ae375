"""The registry takes what works, reports what fails, and never lets one plug-in spoil another."""

import re
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

from limbik.core import hooks
from limbik.core.errors import InputError, PluginError
from limbik.core.registry import Registry
from limbik.core.slots import SLOTS
from limbik.testing import fake_distribution

SIMPLE = """
import limbik
def kernel(lengths, reach_ratio, weights, params, angles):
    for bone in range(angles.shape[0]):
        angles[bone] = weights[bone]
"""
BENDS = ["nth-root", "solved-arc", "two-bone", "uniform-arc"]
OFFER = """
@limbik.hookimpl
def limbik_initial_bends():
    return [limbik.Strategy({name!r}, kernel)]
"""

Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Install fake distributions for one test; their modules are forgotten afterwards."""
    monkeypatch.delenv("LIMBIK_BLOCK", raising=False)
    monkeypatch.syspath_prepend(tmp_path)
    modules = []

    def add(name: str, source: str, **more: str) -> None:
        modules.append(fake_distribution(tmp_path, name, textwrap.dedent(source), **more))

    yield add
    for module in modules:
        sys.modules.pop(module, None)


def good(name: str) -> str:
    return SIMPLE + OFFER.format(name=name)


def broken_lines(registry: Registry) -> list[str]:
    return [str(failure) for failure in registry.broken]


def test_built_in_names_are_those_of_the_document() -> None:
    registry = Registry(third_party=False)
    assert {slot: list(registry.strategies(slot)) for slot in SLOTS} == {
        "initial_bend": BENDS,
        "bend_vector": ["auto", "global", "manual"],
        "root_control": ["none", "prefer-flip", "suppress-flip"],
        "bank_suppression": ["none", "threshold"],
        "finish": ["newton", "none"],
        "limit": ["cone"],
    }
    assert registry.broken == ()


def test_third_party_strategy_is_found_and_listed_with_its_distribution(install: Install) -> None:
    install("acme-bends", good("spiral"), plugin="acme", version="3.2")
    registry = Registry()
    assert str(registry.find("initial_bend", "spiral").plugin) == "plug-in 'acme' (acme-bends 3.2)"
    assert list(registry.strategies("initial_bend")) == sorted([*BENDS, "spiral"])
    acme = next(plugin for plugin in registry.plugins() if plugin.name == "acme")
    assert (acme.status, acme.hooks) == ("loaded", ("limbik_initial_bends",))


def test_third_party_is_not_imported_for_a_built_in_name(install: Install) -> None:
    install("acme-lazy", good("spiral"))
    Registry().bind("initial_bend", "nth-root")
    assert "acme_lazy" not in sys.modules


def test_third_party_false_never_looks_outside(install: Install) -> None:
    install("acme-outside", good("spiral"))
    with pytest.raises(InputError, match="no initial_bend is called 'spiral'"):
        Registry(third_party=False).find("initial_bend", "spiral")


FAILURES = {
    "import": ("import no_such_module", "ModuleNotFoundError"),
    "exit": ("import sys; sys.exit(3)", "SystemExit: 3"),
    "typo": (good("x").replace("limbik_initial_bends", "limbik_inital_bends"), "unknown hook"),
    "empty": ("import limbik", "implements none of limbik's hooks"),
    "raises": (
        SIMPLE + "@limbik.hookimpl\ndef limbik_initial_bends():\n    yield 1/0",
        "limbik_initial_bends failed: ZeroDivisionError",
    ),
    "type": (good("x").replace("limbik.Strategy('x', kernel)", "'x'"), "must return strategies"),
    "signature": (good("x").replace("reach_ratio", "reach"), "the slot passes (lengths, reach_"),
    "name": (good("Spiral One"), "lower-case words joined by hyphens"),
    "api": (good("x").replace("kernel)", "kernel, api=99)"), "agreement 99"),
    "kernel": (good("x").replace("weights[bone]\n", "1 / 0\n"), "ZeroDivisionError"),
    "nan": (good("x").replace("weights[bone]\n", "float('nan')\n"), "writes [nan"),
    "returns": (good("x").replace("weights[bone]\n", "0.0\n    return 1\n"), "returned 1"),
    "inputs": (good("x").replace("angles[bone] =", "lengths[bone] ="), "writes into 'lengths'"),
    "state": (
        good("x").replace("weights[bone]\n", "len(COUNT)\n    COUNT.append(0)\nCOUNT = []\n"),
        "another 'angles' each time",
    ),
    "shape": (good("x").replace("angles[bone] =", "angles[99] ="), "IndexError"),
    "params": (good("x").replace("kernel)", "kernel, dict)"), "NamedTuple class"),
    "field": (
        "from typing import NamedTuple\nclass P(NamedTuple):\n    text: str = ''\n"
        + good("x").replace("kernel)", "kernel, P)"),
        "parameter 'text'",
    ),
    "default": (
        "from typing import Annotated, NamedTuple\nfrom pydantic import Field\n"
        "class P(NamedTuple):\n    a: Annotated[float, Field(ge=2)] = 1.0\n"
        + good("x").replace("kernel)", "kernel, P)"),
        "defaults are refused",
    ),
}


@pytest.mark.parametrize("kind", FAILURES)
def test_failing_plugin_is_reported_and_others_keep_working(install: Install, kind: str) -> None:
    source, cause = FAILURES[kind]
    install(f"acme-bad-{kind}", source, plugin="bad")
    install(f"acme-good-{kind}", good("fine"), plugin="good")
    registry = Registry()
    (failure,) = registry.broken
    assert str(failure).startswith(f"plug-in 'bad' (acme-bad-{kind} 1.0)")
    assert cause in failure.cause
    assert "\n" not in failure.cause
    assert list(registry.strategies("initial_bend")) == sorted([*BENDS, "fine"])


def test_bad_strategy_does_not_take_its_neighbour_along(install: Install) -> None:
    source = good("fine").replace("kernel)]", "kernel), limbik.Strategy('bad', lambda x: None)]")
    install("acme-neighbour", source)
    registry = Registry()
    assert "fine" in registry.strategies("initial_bend")
    assert [failure.strategy for failure in registry.broken] == ["bad"]


def test_printing_plugin_leaves_standard_output_clean(
    install: Install, capsys: pytest.CaptureFixture[str]
) -> None:
    install(
        "acme-loud",
        "print('at import')\n" + good("loud").replace("    for", "    print(1)\n    for"),
    )
    assert "loud" in Registry().strategies("initial_bend")
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "at import" in printed.err


def test_using_a_broken_strategy_names_plugin_and_cause(install: Install) -> None:
    install("acme-used", good("x").replace("reach_ratio", "reach"), plugin="acme")
    with pytest.raises(PluginError, match=r"plug-in 'acme', initial_bend 'x'.*the slot passes"):
        Registry().bind("initial_bend", "x")


def test_built_in_wins_a_clash_and_the_other_is_reported(install: Install) -> None:
    install("acme-clash", good("nth-root"), plugin="clash")
    registry = Registry()
    assert registry.strategies("initial_bend")["nth-root"].plugin.built_in
    (line,) = broken_lines(registry)
    assert "plug-in 'clash' (acme-clash 1.0): initial_bend 'nth-root'" in line
    assert "LIMBIK_BLOCK=initial_bend.nth_root" in line


def test_blocking_the_built_in_lets_the_other_have_the_name(install: Install) -> None:
    install("acme-instead", good("nth-root"), plugin="instead")
    registry = Registry(block=["initial_bend.nth_root"])
    assert registry.find("initial_bend", "nth-root").plugin.name == "instead"


def test_neither_of_two_third_parties_wins_a_clash(install: Install) -> None:
    install("acme-one", good("spiral"), plugin="one")
    install("acme-two", good("spiral"), plugin="two")
    registry = Registry()
    assert "spiral" not in registry.strategies("initial_bend")
    assert len(registry.broken) == 2
    with pytest.raises(PluginError) as caught:
        registry.find("initial_bend", "spiral")
    assert "'one'" in str(caught.value)
    assert "'two' (acme-two 1.0); set LIMBIK_BLOCK=two" in str(caught.value)


@pytest.mark.parametrize("blocked", ["two", "acme-second", " x , two "])
def test_limbik_block_settles_a_clash(
    install: Install, monkeypatch: pytest.MonkeyPatch, blocked: str
) -> None:
    install("acme-first", good("spiral"), plugin="one")
    install("acme-second", good("spiral"), plugin="two")
    monkeypatch.setenv("LIMBIK_BLOCK", blocked)
    registry = Registry()
    assert registry.find("initial_bend", "spiral").plugin.name == "one"
    assert [p.status for p in registry.plugins() if p.name == "two"] == ["blocked"]


def test_blocked_plugin_is_not_imported(install: Install) -> None:
    install("acme-blocked", "raise RuntimeError('imported')")
    registry = Registry(block=["acme-blocked"])
    assert registry.broken == ()
    assert "acme_blocked" not in sys.modules


def test_two_distributions_with_one_entry_point_name_are_both_loaded(install: Install) -> None:
    install("acme-b", good("of-b"), plugin="same")
    install("acme-a", good("of-a"), plugin="same")
    registry = Registry()
    assert list(registry.strategies("initial_bend")) == sorted([*BENDS, "of-a", "of-b"])
    same = [plugin.distribution for plugin in registry.plugins() if plugin.name == "same"]
    assert same == ["acme-a", "acme-b"]


def test_unknown_name_suggests_and_lists_also_what_was_not_loaded(install: Install) -> None:
    install("acme-gone", "import no_such_module", plugin="gone")
    with pytest.raises(InputError) as caught:
        Registry().bind("initial_bend", "nth-rot")
    (fault,) = caught.value.faults
    assert fault.code == "unknown-strategy"
    assert fault.hint == "did you mean 'nth-root'?"
    known = f"known: {', '.join(BENDS)}; not loaded: plug-in 'gone' (acme-gone 1.0)"
    assert known in fault.message


def test_failing_built_in_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("limbik.plugins.BUILT_IN", ("limbik.plugins.no_such_module",))
    with pytest.raises(PluginError, match="no_such_module"):
        Registry()


def test_plugin_registered_by_hand_works_and_its_failure_raises() -> None:
    module = ModuleType("by_hand")
    exec(good("by-hand"), module.__dict__)
    registry = Registry(third_party=False)
    registry.register(module, "mine")
    assert registry.bind("initial_bend", "by-hand").plugin.name == "mine"
    exec(good("nth-root"), module.__dict__)
    with pytest.raises(PluginError, match=r"also offered by plug-in 'initial_bend\.nth_root'"):
        registry.register(module, "mine-too")


@pytest.mark.parametrize("slot", SLOTS)
def test_example_in_each_hook_is_a_working_plugin(slot: str) -> None:
    docstring = getattr(hooks, SLOTS[slot].hook).__doc__
    example = re.search(r"```python\n(.*?)```", docstring, re.DOTALL)
    assert example is not None
    module = ModuleType("example")
    exec(textwrap.dedent(example[1]), module.__dict__)
    registry = Registry(third_party=False)
    before = set(registry.strategies(slot))
    registry.register(module, "example")
    assert len(set(registry.strategies(slot)) - before) == 1


BIND_FAULTS = [
    ("bank_suppression", {"use": "threshold", "angle": 2.5}, "angle", "range", "at most 2"),
    ("bank_suppression", {"use": "threshold", "angle": "1.0"}, "angle", "type", "a number"),
    ("bank_suppression", {"use": "threshold", "angle": float("nan")}, "angle", "not-finite", "nan"),
    ("bank_suppression", {"use": "threshold", "angle": True}, "angle", "type", "a number"),
    ("bank_suppression", {"use": "threshold", "angel": 1}, "angel", "unknown-key", "takes angle"),
    ("bank_suppression", {"use": "none", "angle": 1}, "angle", "unknown-key", "no parameters"),
    ("bank_suppression", {"angle": 1}, "use", "missing-key", "must name the strategy"),
    ("bank_suppression", {"use": 3}, "use", "type", "not 3"),
    ("bank_suppression", 3, "", "type", "name or a mapping, not 3"),
    ("bend_vector", {"use": "global", "direction": [0, 0, 0]}, "", "value", "point somewhere"),
    ("bend_vector", {"use": "global", "direction": [0, "a", 0]}, "direction[1]", "type", "'a'"),
    ("bend_vector", {"use": "global", "direction": [0, 1]}, "direction[2]", "missing-key", "short"),
    ("bend_vector", {"use": "auto", "sensitivity": 0.0005}, "", "value", "0.001"),
]


@pytest.mark.parametrize(("slot", "choice", "key", "code", "words"), BIND_FAULTS)
def test_bind_names_the_parameter_at_fault(
    slot: str, choice: object, key: str, code: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        Registry(third_party=False).bind(slot, choice)  # type: ignore[arg-type]
    (fault,) = caught.value.faults
    assert (fault.key, fault.code) == (key, code)
    assert words in fault.message


def test_bind_reports_every_fault_at_once() -> None:
    choice = {"use": "auto", "strength": 2, "angel": 3}
    with pytest.raises(InputError) as caught:
        Registry(third_party=False).bind("bend_vector", choice)
    assert [fault.key for fault in caught.value.faults] == ["angel", "strength"]


def test_bind_keeps_degrees_and_hands_radians_on() -> None:
    bound = Registry(third_party=False).bind("bend_vector", {"use": "manual", "angle": 180})
    assert bound.params.angle == 180.0
    assert bound.values[:3].tolist() == [3.141592653589793, 0.0, 0.0]


def test_registry_and_parameters_need_no_compiler() -> None:
    code = (
        "import sys; from limbik.core.registry import Registry; r = Registry();"
        "r.bind('bend_vector', {'use': 'global', 'direction': [0, 1, 0]}); r.plugins();"
        "sys.exit('numba' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
