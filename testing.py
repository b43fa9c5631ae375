"""For authors of plug-ins: check a strategy as the host will use it, and fake an installed plug-in.

Nothing here needs a test framework; what fails raises AssertionError or the host's own error.
"""

from pathlib import Path
from typing import Any

import numpy as np

from limbik.core.errors import PluginError
from limbik.core.params import sample
from limbik.core.slots import SLOTS
from limbik.core.strategy import Strategy, flatten, unflatten
from limbik.core.trial import examine


def check_strategy(
    slot: str, strategy: Strategy, params: Any = None, tolerance: float = 1e-12
) -> None:
    """Check that a strategy fits its slot, compiles, and computes the same when compiled.

    Args:
        slot: Name of the slot, such as `initial_bend`.
        strategy: The strategy.
        params: Instance of its params class to run it with, angles in degrees; its defaults if
            absent.
        tolerance: Largest difference between compiled and interpreted results.

    Raises:
        AssertionError: The strategy is refused at registration, does not compile, or its two
            results differ.
    """
    place = SLOTS[slot]
    try:
        examine(place, strategy)
        values = sample(strategy) if params is None else params
        if values is None:
            raise ValueError("give params: its required ones could not be guessed")
        for arguments in place.samples():
            _compare(slot, strategy, values, arguments, tolerance)
    except (PluginError, TypeError, ValueError) as error:
        raise AssertionError(f"{slot} '{strategy.name}': {error}") from error


def _compare(
    slot: str, strategy: Strategy, values: Any, arguments: tuple[Any, ...], tolerance: float
) -> None:
    """Run one sample in the interpreter and through native code."""
    plain = [_copy(argument) for argument in arguments]
    place = SLOTS[slot].names.index("params")
    plain[place] = unflatten(strategy.params, flatten(values))
    with np.errstate(all="ignore"):
        strategy.function()(*plain)
    native = run_native(slot, strategy, values, arguments)
    for argument, one, other in zip(SLOTS[slot].arguments, plain, native, strict=True):
        if argument.written:
            message = f"'{argument.name}' is {other} compiled and {one} interpreted"
            assert np.allclose(one, other, rtol=0.0, atol=tolerance), message


def run_native(slot: str, strategy: Strategy, values: Any, arguments: tuple[Any, ...]) -> list[Any]:
    """Call a strategy as the solve does, by the address of its native code.

    Args:
        slot: Name of the slot.
        strategy: The strategy.
        values: Instance of its params class, angles in degrees.
        arguments: What the kernel gets; whatever stands in the place of `params` is ignored.

    Returns:
        Copies of the arguments, with what the strategy wrote (NaN if it raised).

    Raises:
        PluginError: The kernel does not compile.
    """
    from limbik.core import callers
    from limbik.core.compiler import native

    given = [_copy(argument) for argument in arguments]
    given[SLOTS[slot].names.index("params")] = flatten(values)
    getattr(callers, f"call_{slot}")(native(slot, strategy), *given)
    return given


def _copy(argument: Any) -> Any:
    return argument.copy() if isinstance(argument, np.ndarray) else argument


def fake_distribution(
    folder: Path,
    name: str,
    source: str,
    *,
    plugin: str = "",
    module: str = "",
    version: str = "1.0",
) -> str:
    """Write a distribution with one plug-in, as if it were installed in a folder.

    Put the folder on `sys.path` to make it count.

    Args:
        folder: Where to write.
        name: Name of the distribution.
        source: Source of its module.
        plugin: Name of its entry point; the distribution's name if absent.
        module: Name of its module; made from the distribution's name if absent.
        version: Version of the distribution.

    Returns:
        Name of the module.
    """
    module = module or name.replace("-", "_")
    metadata = folder / f"{name.replace('-', '_')}-{version}.dist-info"
    metadata.mkdir(parents=True)
    about = f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n"
    (metadata / "METADATA").write_text(about, encoding="utf-8")
    points = f"[limbik]\n{plugin or name} = {module}\n"
    (metadata / "entry_points.txt").write_text(points, encoding="utf-8")
    (folder / f"{module}.py").write_text(source, encoding="utf-8")
    return module
