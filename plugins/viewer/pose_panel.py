"""Goal and pole in numbers, the stages of the solve, and the path in time."""

from collections.abc import Callable
from typing import Any

import numpy as np
from viser import GuiEvent

from limbik.core.pole import ROTORS, PoleRotor
from limbik.plugins.viewer.controls import Control, controls, value_at
from limbik.plugins.viewer.page import Page
from limbik.plugins.viewer.player import Player
from limbik.plugins.viewer.session import LAST, Shown
from limbik.plugins.viewer.widgets import Slider, add_control

NO_ROTOR, OWN_ROTOR = "none", "own"


class PosePanel:
    """Goal, stage and time.

    Args:
        page: What it is about.
        selected: Called when another chain was selected.
    """

    def __init__(self, page: Page, selected: Callable[[], None]) -> None:
        self.selected = selected
        self._page, self._session = page, page.session
        gui, one = page.server.gui, self._session.chain
        if len(self._session.chains) > 1:
            text = "what the panels are about"
            chain = Control(("chain",), "choice", choices=tuple(self._session.chains), text=text)
            add_control(gui, chain, one.name, self._select)
        place = Control(("goal",), "vector", size=3, text="where the end shall go, world")
        self._goal = add_control(gui, place, tuple(one.to_world(one.goal)), self._set_goal)
        stage = gui.add_slider("stage", 0, 1, 1, 1, hint="poses of the solve, one by one")
        self._stage = Slider(stage, self._set_stage)
        self._stage_name = gui.add_markdown("")
        self._pole_folder = gui.add_folder("pole")
        with self._pole_folder:
            text = "where the chain bends to, world"
            where = Control(("position",), "vector", size=3, text=text)
            self._pole = add_control(gui, where, one.pole(one.setup), self._set_pole)
            names = (NO_ROTOR, *ROTORS, OWN_ROTOR)
            rotor = Control(("rotor",), "choice", choices=names, text="what turns the pole along")
            self._rotor = add_control(gui, rotor, self._rotor_name(), self._choose_rotor)
            self._rotor_folder: Any = None
            text = "leave the rest pose where it is"
            bind = Control(("bind",), "bool", text=text)
            self._bind = add_control(gui, bind, one.setup.given.bind, self._set_bind)
        self._build_rotor()
        self._add_path()

    def _select(self, control: Control, name: Any) -> bool:
        with self._session.lock:
            self._page.select(name)
            self._rotor.value = self._rotor_name()
            self._bind.value = self._session.chain.setup.given.bind
            self._build_rotor()
            self.selected()
        return True

    def _add_path(self) -> None:
        page, session = self._page, self._session
        gui, path = page.server.gui, session.path
        self._player = Player(self._tick)
        self._time: Slider | None = None
        with gui.add_folder("path"):
            if path.note:
                gui.add_markdown(path.note)
            if len(path) > 1:
                text = "goals of the scene, one after the other"
                frame = gui.add_slider("frame", 0, len(path) - 1, 1, 0, hint=text)
                self._time = Slider(frame, self._set_frame)
                self._play = gui.add_checkbox("play", False)
                self._play.on_update(self._set_play)
            self._name = gui.add_markdown("")
            follow = Control(("follow",), "bool", text="start each solve from the pose before")
            add_control(gui, follow, session.follow, self._set_follow)

    def update(self, shown: dict[str, Shown], dragged: bool) -> None:
        """Show a solve."""
        one = self._session.chain
        seen = shown[one.name]
        self._goal.value = tuple(np.round(one.to_world(one.goal), 9).tolist())
        self._pole_folder.visible = one.setup.in_plane
        self._pole.value = tuple(np.round(one.pole(one.setup), 9).tolist())
        if not dragged or seen.stages:
            self._show_stage(seen)
        if self._time is not None:
            self._time.show(self._session.frame)
        path = self._session.path
        self._name.content = (
            f"{path.names[self._session.frame]} · {path.times[self._session.frame]:.2f} s"
        )

    def _show_stage(self, seen: Shown) -> None:
        last = max(len(seen.stages) - 1, 0)
        self._stage.handle.disabled = last == 0
        at = last if seen.stage == LAST else seen.stage
        self._stage.show(at if last else 1, max(last, 1))
        self._stage_name.content = seen.stages[at] if seen.stages else "no stages to see"

    def _set_goal(self, control: Control, value: Any) -> bool:
        one = self._session.chain
        return self._page.act(lambda: self._session.move_goal(one.name, np.array(value)))

    def _set_pole(self, control: Control, value: Any) -> bool:
        one = self._session.chain
        return self._page.act(
            lambda: self._session.change(
                one.name, one.setup.with_pole(one.from_world(np.array(value)))
            )
        )

    def _set_bind(self, control: Control, value: Any) -> bool:
        one = self._session.chain
        return self._page.act(
            lambda: self._session.change(one.name, one.setup.with_bind(bool(value)))
        )

    def _rotor_name(self) -> str:
        rotor = self._session.chain.setup.pole.rotor
        return NO_ROTOR if rotor is None else rotor if isinstance(rotor, str) else OWN_ROTOR

    def _choose_rotor(self, control: Control, name: str) -> bool:
        given = {NO_ROTOR: None, OWN_ROTOR: PoleRotor().model_dump()}.get(name, name)
        with self._session.lock:
            taken = self._set_rotor(given)
            self._build_rotor()
        return taken

    def _set_rotor(self, rotor: str | dict[str, Any] | None) -> bool:
        one = self._session.chain
        return self._page.act(lambda: self._session.change(one.name, one.setup.with_rotor(rotor)))

    def _build_rotor(self) -> None:
        """Show the parameters of a rotor that is no preset."""
        if self._rotor_folder is not None:
            self._rotor_folder.remove()
            self._rotor_folder = None
        rotor = self._session.chain.setup.pole.rotor
        if isinstance(rotor, PoleRotor):
            gui, values = self._page.server.gui, rotor.model_dump()
            with self._pole_folder:
                self._rotor_folder = gui.add_folder("rotor")
            with self._rotor_folder:
                for control in controls(PoleRotor):
                    add_control(gui, control, value_at(values, control.path), self._turn_rotor)

    def _turn_rotor(self, control: Control, value: Any) -> bool:
        rotor = self._session.chain.setup.pole.rotor
        assert isinstance(rotor, PoleRotor)
        return self._set_rotor({**rotor.model_dump(), control.path[0]: value})

    def _set_stage(self, at: int) -> None:
        def change() -> None:
            self._session.stage = LAST if at >= self._stage.handle.max else at

        self._page.act(change)

    def _set_frame(self, frame: int) -> None:
        self._page.act(lambda: self._session.go_to(frame))

    def _set_follow(self, control: Control, value: Any) -> bool:
        def change() -> None:
            self._session.follow = bool(value)

        return self._page.act(change)

    def _set_play(self, event: GuiEvent[Any]) -> None:
        if event.target.value:
            self._player.start()
        else:
            self._player.stop()

    def _tick(self, seconds: float) -> None:
        self._page.act(lambda: self._session.advance(seconds), dragged=True)

    def close(self) -> None:
        """Stop what runs."""
        self._player.stop()
