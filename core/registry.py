"""The registry: which strategies there are, who brought them, and what went wrong.

Built-in plug-ins are loaded at once and must work. Plug-ins of other distributions are loaded
when a name is asked for that is not built in, or for a list. Whatever fails in one of them becomes
an entry of `broken`; everything else goes on working.
"""

import os
from collections.abc import Iterable, Mapping
from functools import partial
from importlib import import_module
from threading import RLock
from typing import Any

from limbik.core.binding import Bound, split_choice, unknown_strategy
from limbik.core.errors import PluginError
from limbik.core.formats import Output, SceneInput
from limbik.core.params import read
from limbik.core.roster import Broken, Plugin, Registered, Roster, entry_points
from limbik.core.slots import HOOKED

_BUILT_IN_PACKAGE = "limbik.plugins"


class Registry:
    """Strategies by slot and name.

    Args:
        third_party: Whether plug-ins of other distributions are looked for.
        block: Names of plug-ins or distributions to leave out; those of the environment variable
            `LIMBIK_BLOCK` (separated by commas) are left out too.

    Raises:
        PluginError: A built-in plug-in does not work.
    """

    def __init__(self, third_party: bool = True, block: Iterable[str] = ()) -> None:
        listed = os.environ.get("LIMBIK_BLOCK", "").split(",")
        self._blocked = {name.strip() for name in (*block, *listed)} - {""}
        self._roster = Roster()
        self._lock = RLock()
        self._complete = not third_party
        self._load_built_in()

    def _load_built_in(self) -> None:
        """Load limbik's own plug-ins, named by their modules: `bend_vector.auto`."""
        for module in import_module(_BUILT_IN_PACKAGE).BUILT_IN:
            name = module.removeprefix(f"{_BUILT_IN_PACKAGE}.").rstrip("_")
            plugin = Plugin(name, "limbik", origin=module, built_in=True)
            if self._is_blocked(plugin):
                self._roster.leave_out(plugin)
            else:
                self._roster.load(plugin, partial(import_module, module))
        for first in self._roster.broken:
            raise PluginError(first.cause, first.plugin.name, first.strategy, first.slot)

    def _load_third_party(self) -> None:
        with self._lock:
            if self._complete:
                return
            self._complete = True
            for plugin, load in entry_points():
                if self._is_blocked(plugin):
                    self._roster.leave_out(plugin)
                else:
                    self._roster.load(plugin, load)

    def _is_blocked(self, plugin: Plugin) -> bool:
        return plugin.name in self._blocked or plugin.distribution in self._blocked

    def register(self, module: Any, name: str) -> None:
        """Add a plug-in by hand, without an entry point.

        Args:
            module: Module or object with hook implementations.
            name: Name of the plug-in.

        Raises:
            PluginError: Something in it does not work; what works stays.
        """
        with self._lock:
            before = len(self._roster.broken)
            self._roster.load(Plugin(name, "", origin=str(module)), lambda: module)
            for failure in self._roster.broken[before:]:
                raise PluginError(failure.cause, name, failure.strategy, failure.slot)

    def strategies(self, slot: str) -> dict[str, Registered]:
        """All working strategies of a slot by name, sorted.

        Args:
            slot: Name of the slot, such as `initial_bend`.

        Raises:
            KeyError: There is no such slot.
        """
        self._load_third_party()
        known = self._roster.strategies(HOOKED[slot].name)
        return {name: known[name] for name in sorted(known)}

    def find(self, slot: str, name: str) -> Registered:
        """Look a strategy up.

        Raises:
            InputError: There is none of that name.
            PluginError: There would be one, but it does not work, or two plug-ins offer it.
        """
        known = self._roster.strategies(HOOKED[slot].name)
        if name not in known:
            self._load_third_party()
            known = self._roster.strategies(slot)
        if name in known:
            return known[name]
        for failure in self._roster.broken:
            if (failure.slot, failure.strategy) == (slot, name):
                raise PluginError(failure.cause, failure.plugin.name, name, slot)
        missing = [failure.plugin for failure in self._roster.broken]
        raise unknown_strategy(slot, name, sorted(known), missing)

    def bind(self, slot: str, choice: str | Mapping[str, Any]) -> Bound:
        """Choose a strategy with its parameters.

        Args:
            slot: Name of the slot.
            choice: The strategy's name, or a mapping with the name under `use` and its parameters.

        Returns:
            The strategy with checked parameters, ready for a solve.

        Raises:
            InputError: No strategy of that name, or parameters it does not take; the key of each
                fault is the parameter's name.
            PluginError: The strategy's plug-in does not work.
        """
        name, given = split_choice(slot, choice)
        found = self.find(slot, name)
        label = f"{slot} '{name}'"
        try:
            params = read(found.strategy, given, label)
        except (TypeError, ArithmeticError, LookupError, AttributeError) as error:
            cause = f"its check of the parameters failed: {type(error).__name__}: {error}"
            raise PluginError(cause, found.plugin.name, name, slot) from error
        return Bound(slot, name, params, found.plugin, found.strategy)

    def scene_input(self, keys: Iterable[str]) -> SceneInput | None:
        """Find the scene input that one of the keys of a `chain` mapping chooses, or None.

        Plug-ins of other distributions are only looked at when no built-in input fits.
        """
        wanted = list(keys)
        for complete in (False, True):
            known = self._formats("scene_input", complete)
            for key in wanted:
                if isinstance(found := known.get(key), SceneInput):
                    return found
        return None

    def scene_inputs(self) -> dict[str, SceneInput]:
        """All working scene inputs by name, sorted."""
        known = sorted(self._formats("scene_input", True).items())
        return {name: found for name, found in known if isinstance(found, SceneInput)}

    def outputs(self) -> dict[str, Output]:
        """All working outputs by name, sorted."""
        known = sorted(self._formats("output", True).items())
        return {name: found for name, found in known if isinstance(found, Output)}

    def _formats(self, kind: str, complete: bool) -> dict[str, SceneInput | Output]:
        if complete:
            self._load_third_party()
        return self._roster.formats(kind)

    def plugins(self) -> list[Plugin]:
        """All plug-ins, built-in ones first, then by name; also blocked and broken ones."""
        self._load_third_party()
        plugins = self._roster.plugins
        return sorted(plugins, key=lambda p: (not p.built_in, p.name, p.distribution))

    @property
    def broken(self) -> tuple[Broken, ...]:
        """Everything that failed in plug-ins of other distributions."""
        self._load_third_party()
        return tuple(self._roster.broken)
