"""A strategy chosen for a slot, with its parameters."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.core.errors import Fault, InputError, PluginError
from limbik.core.roster import Plugin
from limbik.core.strategy import Strategy, flatten
from limbik.core.wording import found_words, near_match


@dataclass(frozen=True)
class Bound:
    """A strategy with checked parameters, ready for a solve.

    Attributes:
        slot: Name of the slot.
        name: Name of the strategy.
        params: Instance of the strategy's params class, angles in degrees as given.
        plugin: Who brought it.
        strategy: The strategy.
    """

    slot: str
    name: str
    params: Any
    plugin: Plugin
    strategy: Strategy

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """The parameters as the kernel's wrapper reads them: (MAX_PARAMS,), angles in radians."""
        return flatten(self.params)

    @cached_property
    def address(self) -> int:
        """Where the strategy's native code is; compiled on first use.

        Raises:
            PluginError: The kernel does not compile.
        """
        from limbik.core.compiler import native

        try:
            return native(self.slot, self.strategy)
        except PluginError as error:
            raise PluginError(error.message, self.plugin.name, self.name, self.slot) from error


def split_choice(slot: str, choice: object) -> tuple[str, dict[str, Any]]:
    """Take a choice apart into the strategy's name and its parameters.

    Raises:
        InputError: It is neither a name nor a mapping with a name under `use`.
    """
    if isinstance(choice, str):
        return choice, {}
    if not isinstance(choice, Mapping):
        message = f"{slot} must be a strategy's name or a mapping, not {found_words(choice)}"
        raise InputError(Fault("type", message))
    given = {str(key): value for key, value in choice.items()}
    if "use" not in given:
        raise InputError(Fault("missing-key", f"'use' must name the strategy for {slot}", "use"))
    name = given.pop("use")
    if not isinstance(name, str):
        message = f"must be a strategy's name, not {found_words(name)}"
        raise InputError(Fault("type", message, "use"))
    return name, given


def unknown_strategy(
    slot: str, name: str, known: list[str], not_loaded: Iterable[Plugin]
) -> InputError:
    """Say which strategies there are instead, and which plug-ins could not bring theirs."""
    message = f"no {slot} is called '{name}'; known: {', '.join(known) or 'none'}"
    if missing := sorted({str(plugin) for plugin in not_loaded}):
        message += f"; not loaded: {', '.join(missing)}"
    return InputError(Fault("unknown-strategy", message, hint=near_match(name, known)))
