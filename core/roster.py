"""Load plug-ins one by one, and keep who brought what and what failed."""

import contextlib
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import metadata
from itertools import islice
from typing import Any, TypeVar

import pluggy

from limbik.core import hooks
from limbik.core.formats import FORMAT_HOOKS, Output, SceneInput, format_fault
from limbik.core.slots import HOOKED, Slot
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
class OfferedFormat:
    """A file format and who brought it."""

    format: SceneInput | Output
    plugin: Plugin


Offer = TypeVar("Offer", Registered, OfferedFormat)


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
    kinds = [slot.hook for slot in HOOKED.values()] + [hook for hook, _ in FORMAT_HOOKS.values()]
    for hook in kinds:
        for implementation in getattr(manager.hook, hook).get_hookimpls():
            found[hook] = implementation.function
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
        self._formats: dict[tuple[str, str], list[OfferedFormat]] = {}

    @property
    def broken(self) -> list[Broken]:
        """What failed, with the strategies whose name is taken."""
        return [*self._failures, *self._clashes()]

    def strategies(self, slot: str) -> dict[str, Registered]:
        """The strategies of a slot that work and have their name for themselves."""
        return _unrivalled(self._offers, slot)

    def formats(self, kind: str) -> dict[str, SceneInput | Output]:
        """The formats of a kind (`scene_input`, `output`) that have their name for themselves."""
        found = _unrivalled(self._formats, kind)
        return {name: offered.format for name, offered in found.items()}

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
        for slot in HOOKED.values():
            if slot.hook in implemented:
                for strategy in self._offered(plugin, slot.name, implemented[slot.hook]):
                    self._take(plugin, slot, strategy)
        for kind, (hook, _) in FORMAT_HOOKS.items():
            if hook in implemented:
                for offered in self._offered(plugin, kind, implemented[hook]):
                    self._take_format(plugin, kind, offered)

    def _offered(self, plugin: Plugin, kind: str, hook: Callable[[], Any]) -> list[Any]:
        """Call a plug-in's hook; exhaust it here, where its name is known."""
        try:
            with contextlib.redirect_stdout(sys.stderr):
                return list(islice(hook() or (), _MOST_STRATEGIES))
        except (Exception, SystemExit) as error:
            cause = f"limbik_{kind}s failed: {one_line(error)}"
            self._failures.append(Broken(plugin, cause, kind))
            return []

    def _take_format(self, plugin: Plugin, kind: str, offered: Any) -> None:
        name = str(getattr(offered, "name", ""))
        fault = format_fault(kind, offered)
        if fault:
            self._failures.append(Broken(plugin, fault, kind, name))
            return
        self._formats.setdefault((kind, name), []).append(OfferedFormat(offered, plugin))

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
        every: dict[tuple[str, str], Sequence[Registered | OfferedFormat]] = {
            **self._offers,
            **self._formats,
        }
        for (slot, name), offers in every.items():
            owner = offers[0].plugin
            for offer in offers[1:] if owner.built_in else offers if len(offers) > 1 else ():
                others = [o.plugin for o in offers if o is not offer]
                rivals = [owner] if owner.built_in else others
                yield Broken(offer.plugin, _clash_text(rivals), slot, name)


def _unrivalled(offers: Mapping[tuple[str, str], Sequence[Offer]], kind: str) -> dict[str, Offer]:
    """The first of the offers of a kind, by name, where no other plug-in has the right to it."""
    return {
        name: found[0]
        for (where, name), found in offers.items()
        if where == kind and (len(found) == 1 or found[0].plugin.built_in)
    }


def _clash_text(rivals: list[Plugin]) -> str:
    names = " and ".join(map(str, rivals))
    block = ",".join(sorted({rival.name for rival in rivals}))
    return f"the name is also offered by {names}; set LIMBIK_BLOCK={block} to leave the other out"
