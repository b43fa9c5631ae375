"""Compiled strategies are kept between runs, never stale, and safe whatever their authors do."""

import os
import re
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from enum import IntEnum
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from limbik.core import cache, compiler, jit, sources
from limbik.core.binding import Bound
from limbik.core.callers import call_bank_suppression, call_initial_bend, call_root_control
from limbik.core.errors import PluginError
from limbik.core.registry import Registry
from limbik.core.roster import Plugin
from limbik.core.strategy import Degrees, Strategy, flatten

Array = NDArray[np.float64]

compiled_only = pytest.mark.skipif(not jit.COMPILES, reason="NUMBA_DISABLE_JIT is set")


class Mode(IntEnum):
    STOP = 0
    GO_AROUND = 3


class Mixed(NamedTuple):
    angle: Annotated[float, Degrees] = 180.0
    place: int = 1
    flag: bool = False
    mode: Mode = Mode.GO_AROUND
    vector: tuple[float, float, float] = (1.0, 2.0, 3.0)
    pair: Annotated[tuple[float, float], Degrees] = (90.0, 45.0)


def doubled(value: float) -> float:
    return 2.0 * plus(value)


def plus(value: float) -> float:
    return value + OFFSET


OFFSET = 1.0


def mixed(lengths: Array, reach_ratio: float, weights: Array, params: Mixed, angles: Array) -> None:
    angles[0] = params.angle
    angles[1] = lengths[params.place]
    angles[2] = 5.0 if params.flag else 6.0
    angles[3] = 7.0 if params.mode == Mode.GO_AROUND else 8.0
    angles[4] = params.vector[0] + 10.0 * params.vector[1] + 100.0 * params.vector[2]
    angles[5] = doubled(params.pair[1])


def failing(lengths: Array, reach_ratio: float, weights: Array, params: Any, angles: Array) -> None:
    angles[0] = 1.0
    if reach_ratio > 0.5:
        raise ValueError("not for me")


def failing_control(
    root: int, has_previous: int, previous: Array, params: Any, low: Array, high: Array
) -> None:
    raise ValueError("never")


def odd(lengths: Array, reach_ratio: float, weights: Array, params: Any, angles: Array) -> None:
    angles[0] = str(reach_ratio).no_such_thing  # type: ignore[attr-defined]


def bend(strategy: Strategy, ratio: float = 0.5, params: Any = None) -> Array:
    lengths, angles = np.arange(6.0), np.full(6, np.nan)
    values = flatten(strategy.params() if params is None else params)
    address = compiler.native("initial_bend", strategy)
    call_initial_bend(address, lengths, ratio, lengths, values, angles)
    return angles


def test_parameters_of_every_kind_reach_the_kernel() -> None:
    strategy = Strategy("mixed", mixed, Mixed)
    wanted = [np.pi, 1.0, 6.0, 7.0, 321.0, 2.0 * (np.pi / 4 + OFFSET)]
    assert bend(strategy) == pytest.approx(wanted)
    others = Mixed(0.0, 4, True, Mode.STOP, (0.0, 0.0, 1.0), (0.0, 90.0))
    wanted = [0.0, 4.0, 5.0, 8.0, 100.0, 2.0 * (np.pi / 2 + OFFSET)]
    assert bend(strategy, params=others) == pytest.approx(wanted)


def test_two_strategies_of_one_function_keep_their_own_constants() -> None:
    def made(constant: float) -> Strategy:
        def kernel(
            lengths: Array, reach_ratio: float, weights: Array, params: Any, angles: Array
        ) -> None:
            angles[:] = constant

        return Strategy("made", kernel)

    one, two = made(1.0), made(2.0)
    assert [bend(one)[0], bend(two)[0], bend(one)[0]] == [1.0, 2.0, 1.0]


def test_raising_strategy_fills_its_result_with_nan_and_nothing_else_happens() -> None:
    strategy = Strategy("failing", failing)
    assert bend(strategy, 0.4)[0] == 1.0
    assert np.isnan(bend(strategy, 0.6)).all()
    low, high = -np.ones((2, 3)), np.ones((2, 3))
    address = compiler.native("root_control", Strategy("failing", failing_control))
    call_root_control(address, 0, 0, low.copy(), np.zeros(16), low, high)
    assert np.isnan(low).all()
    assert np.isnan(high).all()


def picked(array: Array, place: int) -> float:
    return float(array[place])


def picking(lengths: Array, reach_ratio: float, weights: Array, params: Any, angles: Array) -> None:
    angles[0], angles[1], angles[2] = picked(lengths, 3), picked(lengths, -1), picked(lengths, 0)


@compiled_only
def test_calls_with_other_constants_share_one_compiled_version() -> None:
    assert bend(Strategy("picking", picking))[:3].tolist() == [3.0, 5.0, 0.0]
    (versions,) = (d for function, d in compiler._COMPILED.values() if function is picked)
    assert len(versions.overloads) == 1


@compiled_only
def test_kernel_that_does_not_compile_is_a_plugin_error_naming_its_plugin() -> None:
    strategy = Strategy("odd", odd)
    bound = Bound("initial_bend", "odd", strategy.params(), Plugin("acme", "acme-bends"), strategy)
    with pytest.raises(PluginError, match=r"'acme', initial_bend 'odd': .*no_such_thing"):
        _ = bound.address


@compiled_only
def test_compilers_report_is_cut_down_to_complaint_and_line() -> None:
    with pytest.raises(PluginError) as caught:
        compiler.native("initial_bend", Strategy("odd-again", odd))
    assert re.search(r"no_such_thing.*\(File .*test_jit\.py\", line \d+\)$", str(caught.value))
    assert "During" not in str(caught.value)


def test_styles_of_the_compilers_report_do_not_reach_the_message() -> None:
    report = '\x1b[1mFailed in nopython mode\nno such thing\n\x1b[1m\nFile "a.py", line 3:\x1b[0m'
    assert compiler._reason(Exception(report)) == 'no such thing (File "a.py", line 3)'


@compiled_only
def test_arrays_of_another_layout_are_refused_not_misread() -> None:
    threshold = Registry(third_party=False).bind("bank_suppression", "threshold")
    strided = np.zeros(6)[::2]
    with pytest.raises(Exception, match="bank_suppression takes"):
        call_bank_suppression(
            threshold.address, strided, strided, 0.0, 1, threshold.values, np.zeros(3)
        )


def test_threads_compile_and_call_at_once_with_equal_results() -> None:
    strategies = [Strategy(f"thread-{n}", mixed, Mixed) for n in range(2)]
    with ThreadPoolExecutor(8) as pool:
        results = list(pool.map(bend, strategies * 8))
    assert all(np.array_equal(result, results[0]) for result in results)


def test_address_of_a_strategy_stays_the_same() -> None:
    strategy = Strategy("stay", failing)
    assert compiler.native("initial_bend", strategy) == compiler.native("initial_bend", strategy)


def test_cache_folders_unused_for_a_month_are_removed_and_no_others(tmp_path: Path) -> None:
    old, new = tmp_path / f"{cache.PREFIX}old", tmp_path / f"{cache.PREFIX}new"
    other = tmp_path / "something else"
    for folder in (old, new, other):
        folder.mkdir()
        (folder / "file").touch()
    now = time.time()
    for folder, age in ((old, 31), (new, 29), (other, 31)):
        os.utime(folder, (now, now - age * 86_400))
    cache.remove_unused(tmp_path, now)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([new.name, other.name])


def test_only_the_cache_folders_used_last_stay(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "MOST_FOLDERS", 2)
    for age in range(4):
        folder = tmp_path / f"{cache.PREFIX}{age}"
        folder.mkdir()
        os.utime(folder, (1e9, 1e9 - age))
    cache.remove_unused(tmp_path, 1e9)
    assert {path.name for path in tmp_path.iterdir()} == {f"{cache.PREFIX}0", f"{cache.PREFIX}1"}


@pytest.mark.slow
@pytest.mark.skipif(not jit.COMPILES, reason="nothing is compiled")
def test_warming_keeps_the_default_strategies_machine_code(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "limbik.core.warm"]
    subprocess.run(command, check=True, env=os.environ | {"LIMBIK_CACHE": str(tmp_path)})
    kept = {file.name.partition("_")[0] for file in tmp_path.rglob("*.nbi")}
    assert kept == {"wrappers.initial", "wrappers.bend", "wrappers.finish"}


def test_fingerprint_follows_helpers_constants_and_closures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = sources.fingerprint(Strategy("mixed", mixed).function())
    assert before == sources.fingerprint(Strategy("mixed", mixed).function())
    monkeypatch.setitem(globals(), "OFFSET", 2.0)
    assert sources.fingerprint(Strategy("mixed", mixed).function()) != before


def test_function_without_a_file_has_no_fingerprint() -> None:
    space: dict[str, Any] = {}
    exec("def kernel():\n    return None", space)
    assert sources.fingerprint(space["kernel"]) is None


SPIRAL = """
from typing import NamedTuple
import limbik
from spiral_numbers import FACTOR, scaled

class P(NamedTuple):
    turns: float = 1.0

def spiral(lengths, reach_ratio, weights, params, angles):
    for bone in range(angles.shape[0]):
        angles[bone] = scaled(params.turns) + FACTOR

STRATEGY = limbik.Strategy("spiral", spiral, P)
"""
NUMBERS = """
FACTOR = {factor}

def scaled(value):
    return {scale} * value
"""
RUN = """
import sys
import numpy as np
from limbik.core import compiler, jit
from limbik.core.callers import call_initial_bend
from limbik.core.strategy import flatten
from spiral import STRATEGY, P

before = jit.is_compiled_before()
address = compiler.native("initial_bend", STRATEGY)
angles, lengths = np.zeros(2), np.ones(2)
call_initial_bend(address, lengths, 0.5, lengths, flatten(P()), angles)
(entry,) = compiler._NATIVE.values()
print(angles[0], sum(entry[1][0].stats.cache_hits.values()), before)
"""


def run(folder: Path, **environment: str) -> tuple[float, int, bool]:
    """Compile and call the strategy of a folder in a new process."""
    variables = {k: v for k, v in os.environ.items() if k != "LIMBIK_CACHE"}
    variables |= {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"} | environment
    done = subprocess.run(
        [sys.executable, "-c", RUN], env=variables, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    value, hits, before = done.stdout.split()
    return float(value), int(hits), before == "True"


@pytest.fixture
def spiral(tmp_path: Path) -> Callable[..., Path]:
    def write(factor: float = 0.0, scale: float = 2.0) -> Path:
        folder = tmp_path / "code"
        folder.mkdir(exist_ok=True)
        (folder / "spiral.py").write_text(SPIRAL)
        (folder / "spiral_numbers.py").write_text(NUMBERS.format(factor=factor, scale=scale))
        return folder

    return write


@pytest.mark.slow
@compiled_only
def test_later_process_finds_the_code_and_an_edit_elsewhere_is_noticed(
    spiral: Callable[..., Path], tmp_path: Path
) -> None:
    place = {"LIMBIK_CACHE": str(tmp_path / "cache")}
    folder = spiral()
    assert run(folder, **place)[:2] == (2.0, 0)
    assert run(folder, **place)[:2] == (2.0, 1)
    spiral(scale=3.0)  # in the file of the function the kernel calls
    assert run(folder, **place)[:2] == (3.0, 0)
    spiral(scale=3.0, factor=5.0)  # a constant in that file
    assert run(folder, **place)[:2] == (8.0, 0)
    assert run(folder, **place)[:2] == (8.0, 1)


@pytest.mark.slow
@compiled_only
def test_folder_that_cannot_be_made_is_passed_over(
    spiral: Callable[..., Path], tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    impossible = str(tmp_path / "file" / "cache")
    assert run(spiral(), LIMBIK_CACHE=impossible)[0] == 2.0


NOTHING_WRITABLE = """
from pathlib import Path
from limbik.core import cache
cache.candidates = lambda: iter([Path("/proc/limbik/nowhere")])
"""
USER_CACHE_ONLY = """
from limbik.core import cache
cache._PACKAGE_CACHE = cache.Path("/proc/limbik/nowhere")
"""


@pytest.mark.slow
@compiled_only
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder nobody can write to")
def test_without_any_writable_folder_everything_works_uncached(
    spiral: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = spiral()
    monkeypatch.setattr(sys.modules[__name__], "RUN", textwrap.dedent(NOTHING_WRITABLE) + RUN)
    assert run(folder) == (2.0, 0, False)
    assert run(folder) == (2.0, 0, False)


@pytest.mark.slow
@compiled_only
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder nobody can write to")
def test_user_cache_is_used_where_the_package_cannot_be_written_to(
    spiral: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, home = spiral(), {"XDG_CACHE_HOME": str(tmp_path / "home"), "HOME": str(tmp_path)}
    monkeypatch.setattr(sys.modules[__name__], "RUN", textwrap.dedent(USER_CACHE_ONLY) + RUN)
    assert run(folder, **home)[1] == 0
    assert run(folder, **home)[1] == 1
    assert list(tmp_path.rglob("limbik/native-*/**/*.nbi"))


@pytest.mark.slow
def test_interpreter_computes_the_same(spiral: Callable[..., Path]) -> None:
    code = RUN.replace("sum(entry[1][0].stats.cache_hits.values())", "0")
    variables = os.environ | {"PYTHONPATH": str(spiral()), "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", code], env=variables, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["2.0", "0", "True"]
