"""Load plug-ins one by one, and keep who brought what and what failed."""

import contextlib
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import metadata
from itertools import islice
from typing import Any

import pluggy

from limbik.core import hooks
from limbik.core.slots import SLOTS, Slot
from limbik.core.strategy import Strategy
from limbik.core.trial import examine

_MOST_STRATEGIES = 1000


@dataclass(frozen=True)
class Plugin:
    """A plug-in, whether it works or not.

    Attributes:
        name: Name of its entry point; for a built-in one its place in `limbik.plugins`.
        distribution: The distribution it came with; `limbik` if built in, empty if registered by
            hand.
        version: Version of that distribution, or empty.
        origin: What was loaded, such as `acme_bends`.
        hooks: Names of the hooks it implements, sorted.
        failure: Why it could not be loaded, or empty.
        blocked: Whether it was left out on purpose.
        built_in: Whether it is one of limbik's own.
    """

    name: str
    distribution: str
    version: str = ""
    origin: str = ""
    hooks: tuple[str, ...] = ()
    failure: str = ""
    blocked: bool = False
    built_in: bool = False

    @property
    def status(self) -> str:
        """`loaded`, `blocked` or `broken`."""
        return "blocked" if self.blocked else "broken" if self.failure else "loaded"

    def __str__(self) -> str:
        source = "built-in" if self.built_in else f"{self.distribution} {self.version}".strip()
        return f"plug-in '{self.name}' ({source or 'registered by hand'})"


@dataclass(frozen=True)
class Registered:
    """A working strategy and who brought it."""

    strategy: Strategy
    plugin: Plugin


@dataclass(frozen=True)
class Broken:
    """Something in a plug-in that failed.

    Attributes:
        plugin: The plug-in.
        cause: What happened, in one line.
        slot: Slot of the strategy at fault; empty if the plug-in as a whole failed.
        strategy: Name of the strategy at fault, or empty.
    """

    plugin: Plugin
    cause: str
    slot: str = ""
    strategy: str = ""

    def __str__(self) -> str:
        what = f": {self.slot} '{self.strategy}'" if self.strategy else ""
        return f"{self.plugin}{what}: {self.cause}"


def entry_points() -> Iterator[tuple[Plugin, Callable[[], Any]]]:
    """Find the plug-ins of other distributions, sorted by name and distribution."""
    found = []
    for point in metadata.entry_points(group=hooks.PROJECT):
        name = point.dist.name if point.dist else ""
        version = point.dist.version if point.dist else ""
        found.append((Plugin(point.name, name, version, point.value), point.load))
    yield from sorted(found, key=lambda pair: (pair[0].name, pair[0].distribution))


def one_line(error: BaseException) -> str:
    """Write an error as `ValueError: what it says`, in one line."""
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _implementations(manager: pluggy.PluginManager) -> dict[str, Callable[[], Any]]:
    """The implemented hooks of a manager that holds one plug-in."""
    found = {}
    for slot in SLOTS.values():
        for implementation in getattr(manager.hook, slot.hook).get_hookimpls():
            found[slot.hook] = implementation.function
    return found


class Roster:
    """The plug-ins loaded so far.

    Attributes:
        plugins: All of them, in the order of loading.
    """

    def __init__(self) -> None:
        self.plugins: list[Plugin] = []
        self._failures: list[Broken] = []
        self._offers: dict[tuple[str, str], list[Registered]] = {}

    @property
    def broken(self) -> list[Broken]:
        """What failed, with the strategies whose name is taken."""
        return [*self._failures, *self._clashes()]

    def strategies(self, slot: str) -> dict[str, Registered]:
        """The strategies of a slot that work and have their name for themselves."""
        firsts = {name: o for (where, name), o in self._offers.items() if where == slot}
        return {
            name: offers[0]
            for name, offers in firsts.items()
            if len(offers) == 1 or offers[0].plugin.built_in
        }

    def leave_out(self, plugin: Plugin) -> None:
        """Note a plug-in that is blocked."""
        self.plugins.append(replace(plugin, blocked=True))

    def load(self, plugin: Plugin, load: Callable[[], Any]) -> None:
        """Load a plug-in and take its strategies; whatever it raises ends up in `broken`."""
        manager = pluggy.PluginManager(hooks.PROJECT)
        manager.add_hookspecs(hooks)
        try:
            with contextlib.redirect_stdout(sys.stderr):
                manager.register(load(), plugin.name)
            manager.check_pending()  # the only place where a misspelt hook is noticed
            implemented = _implementations(manager)
            if not implemented:
                raise TypeError(f"{plugin.origin} implements none of limbik's hooks")
        except (Exception, SystemExit) as error:
            failed = replace(plugin, failure=one_line(error))
            self.plugins.append(failed)
            self._failures.append(Broken(failed, failed.failure))
            return
        plugin = replace(plugin, hooks=tuple(sorted(implemented)))
        self.plugins.append(plugin)
        for slot in SLOTS.values():
            if slot.hook in implemented:
                self._take_all(plugin, slot, implemented[slot.hook])

    def _take_all(self, plugin: Plugin, slot: Slot, hook: Callable[[], Any]) -> None:
        """Call a plug-in's hook; exhaust it here, where its name is known."""
        try:
            with contextlib.redirect_stdout(sys.stderr):
                offered = list(islice(hook() or (), _MOST_STRATEGIES))
        except (Exception, SystemExit) as error:
            cause = f"{slot.hook} failed: {one_line(error)}"
            self._failures.append(Broken(plugin, cause, slot.name))
            return
        for strategy in offered:
            self._take(plugin, slot, strategy)

    def _take(self, plugin: Plugin, slot: Slot, strategy: Any) -> None:
        name = str(getattr(strategy, "name", ""))
        try:
            examine(slot, strategy)
        except (Exception, SystemExit) as error:
            self._failures.append(Broken(plugin, one_line(error), slot.name, name))
            return
        self._offers.setdefault((slot.name, name), []).append(Registered(strategy, plugin))

    def _clashes(self) -> Iterator[Broken]:
        """Strategies that cannot be used, since others have the same name."""
        for (slot, name), offers in self._offers.items():
            owner = offers[0].plugin
            for offer in offers[1:] if owner.built_in else offers if len(offers) > 1 else ():
                others = [o.plugin for o in offers if o is not offer]
                rivals = [owner] if owner.built_in else others
                yield Broken(offer.plugin, _clash_text(rivals), slot, name)


def _clash_text(rivals: list[Plugin]) -> str:
    names = " and ".join(map(str, rivals))
    block = ",".join(sorted({rival.name for rival in rivals}))
    return f"the name is also offered by {names}; set LIMBIK_BLOCK={block} to leave the other out"
