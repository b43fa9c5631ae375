"""Solver, strategies, options and FK: widgets made from the models, remade as choices change."""

from typing import Any

import numpy as np

from limbik.core.chain import AXES
from limbik.core.slots import LIMIT, SOLVER
from limbik.core.whole import OWN_SOLVERS
from limbik.plugins.viewer.controls import Control, value_at
from limbik.plugins.viewer.page import Page
from limbik.plugins.viewer.session import Shown
from limbik.plugins.viewer.setup import Setup
from limbik.plugins.viewer.widgets import add_control

NOBODY = "nobody"
LAST = 100.0  # place in its tab
OF_FK = ("ik", "fk_strength", "fk_mix")
RANGES = "ranges"


class SolverPanel:
    """Widgets for how the chain is solved.

    Args:
        page: What it is about.
        solver, options, joints: Tabs they go into.
    """

    def __init__(self, page: Page, solver: Any, options: Any, joints: Any) -> None:
        self._page, self._session, self._gui = page, page.session, page.server.gui
        self._tabs = {"solver": solver, "options": options, "joints": joints}
        self._folders: dict[str, Any] = {}
        self.rebuild()

    @property
    def _setup(self) -> Setup:
        return self._session.chain.setup

    def update(self, shown: dict[str, Shown], dragged: bool) -> None:
        """Nothing here changes by itself."""

    def _try(self, make: Any) -> bool:
        """Change to the setup that is made, if it can be made."""
        return self._page.act(
            lambda: self._session.change(self._session.chain.name, make(self._setup))
        )

    def _folder(self, tab: str, name: str, order: float) -> Any:
        """Return an empty folder in the place of the one of this name."""
        before = self._folders.pop(name, None)
        if before is not None:
            before.remove()
        with self._tabs[tab]:
            self._folders[name] = self._gui.add_folder(name, order=order)
        return self._folders[name]

    def rebuild(self) -> None:
        """Make all widgets anew, for the chain that is selected."""
        self._joint = self._setup.chain.names[0]
        with self._folder("solver", "side by side", LAST):
            fit, why = self._setup.solvers
            text = "; ".join(f"not {name}: {reason}" for name, reason in why.items())
            rival = Control(("with",), "choice", choices=(NOBODY, *fit), text=text)
            add_control(self._gui, rival, NOBODY, self._compare)
            apart = Control(("apart",), "float", 0.0, 2.0, text="in lengths of the chain")
            add_control(self._gui, apart, self._page.apart, self._set_apart)
        self._build_all()

    def _build_all(self) -> None:
        slots = (SOLVER.name, *self._setup.slots)
        for name in [name for name in self._folders if name.startswith("slot ")]:
            self._folders.pop(name).remove()
        for order, slot in enumerate(slots):
            self._build_slot(slot, order)
        self._build_options()
        self._build_fk()
        self._build_joint()

    def _build_slot(self, slot: str, order: float) -> None:
        gui, chosen = self._gui, self._setup.chosen(slot)
        name = chosen["use"]
        names = self._setup.solvers[0] if slot == SOLVER.name else self._setup.offered(slot)
        with self._tabs["solver"]:
            folder = gui.add_folder(slot.replace("_", " "), order=order)
        self._folders[f"slot {slot}"] = folder
        with folder:
            use = Control(("use",), "choice", choices=tuple(names), text=self._about(slot, name))

            def choose(control: Control, value: Any) -> bool:
                with self._session.lock:
                    taken = self._try(
                        lambda setup: setup.with_strategy(slot, setup.fresh(slot, value))
                    )
                    if taken:
                        self._build_all()
                return taken

            add_control(gui, use, name, choose)
            for control in self._setup.parameters(slot, name):

                def tune(control: Control, value: Any) -> bool:
                    return self._try(
                        lambda setup: setup.with_strategy(
                            slot, {**setup.chosen(slot), control.path[0]: value}
                        )
                    )

                add_control(gui, control, value_at(chosen, control.path), tune)

    def _about(self, slot: str, name: str) -> str:
        known = self._setup.registry.strategies(slot)
        return known[name].strategy.description if name in known else ""

    def _build_options(self) -> None:
        gui, values = self._gui, self._setup.settings.model_dump()
        with self._folder("options", "options of the solve", 0.0):
            self._say_whose()
            for control in self._setup.options:
                held = value_at(values, control.path)
                group = control.path if control.kind != "switch" else control.path[:-1]
                if control.path[0] in OF_FK or value_at(values, group) is None:
                    continue  # or of a group that is off
                if control.by_joint:
                    self._add_by_joint(control, held)
                else:
                    add_control(gui, control, held, self._set_option)

    def _say_whose(self) -> None:
        """Tell people that a solver of a plug-in may leave some of this aside."""
        name = self._setup.choice["use"]
        if name not in OWN_SOLVERS:
            self._gui.add_markdown(f"*{name}* heeds what it has use for.")

    def _add_by_joint(self, control: Control, held: Any) -> None:
        """Add a folder with an option's value for each joint."""
        chain = self._setup.chain
        rest = np.round(np.degrees(chain.rest), 9).tolist()
        with self._gui.add_folder(control.name, expand_by_default=False):
            for name, resting in zip(chain.names, rest, strict=True):
                absent = resting if control.absent is None else control.absent
                one = control.of_joint(name)
                add_control(self._gui, one, held.get(name, absent), self._set_option, name)

    def _set_option(self, control: Control, value: Any) -> bool:
        with self._session.lock:
            taken = self._try(lambda setup: setup.with_option(control.path, value))
            if taken and control.kind == "switch":
                self._build_options()
        return taken

    def _build_fk(self) -> None:
        gui, values = self._gui, self._setup.settings.model_dump()
        with self._folder("joints", "forward kinematics", 0.0):
            self._say_whose()
            for control in self._setup.options:
                if control.path[0] in OF_FK:
                    add_control(gui, control, value_at(values, control.path), self._set_option)

    @property
    def _at(self) -> int:
        return self._setup.chain.names.index(self._joint)

    def _build_joint(self) -> None:
        """Show FK offset and limit of the joint that is chosen."""
        gui, names = self._gui, self._setup.chain.names
        with self._folder("joints", "one joint", 1.0):
            joint = Control(("joint",), "choice", choices=names, text="what is below is about it")
            add_control(gui, joint, self._joint, self._choose_joint)
            turn = np.degrees(self._setup.fk[self._at])
            for axis, angle in zip(AXES, turn.tolist(), strict=True):
                text = "FK offset from the rest pose [deg]"
                control = Control((axis,), "float", -180.0, 180.0, text=text)
                add_control(gui, control, angle, self._turn)
            if self._setup.takes_limits:
                self._add_limit()

    def _add_limit(self) -> None:
        """Add what limits the joint, and the parameters of a limit of its own."""
        own = self._setup.own[self._at]
        names = (RANGES, *self._setup.registry.strategies(LIMIT.name))
        text = "ranges of heading, pitch and bank, or a limit of its own"
        limit = Control((LIMIT.name,), "choice", choices=names, text=text)
        add_control(self._gui, limit, RANGES if own is None else own["use"], self._choose_limit)
        if own is not None:
            chosen = self._setup.full(LIMIT.name, own)
            for control in self._setup.parameters(LIMIT.name, own["use"]):
                add_control(self._gui, control, value_at(chosen, control.path), self._tune_limit)

    def _choose_limit(self, control: Control, value: Any) -> bool:
        with self._session.lock:
            taken = self._try(
                lambda setup: setup.with_limit(
                    self._at, None if value == RANGES else setup.fresh(LIMIT.name, value)
                )
            )
            if taken:
                self._build_joint()
        return taken

    def _tune_limit(self, control: Control, value: Any) -> bool:
        own = self._setup.own[self._at] or {}
        changed = {**self._setup.full(LIMIT.name, own), control.path[0]: value}
        return self._try(lambda setup: setup.with_limit(self._at, changed))

    def _choose_joint(self, control: Control, value: Any) -> bool:
        with self._session.lock:
            self._joint = value
            self._build_joint()
        return True

    def _turn(self, control: Control, value: Any) -> bool:
        at = self._at
        turn = self._setup.fk[at].copy()
        turn[AXES.index(control.path[0])] = np.radians(value)
        return self._try(lambda setup: setup.with_fk(at, turn))

    def _set_apart(self, control: Control, value: Any) -> bool:
        self._page.apart = float(value)
        return self._page.act(lambda: None)

    def _compare(self, control: Control, value: Any) -> bool:
        return self._page.act(lambda: self._session.compare(None if value == NOBODY else value))
