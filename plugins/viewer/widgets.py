"""A widget on the page for each control."""

from collections.abc import Callable
from math import floor, log10
from threading import Lock
from typing import Any

from viser import GuiApi, GuiEvent

from limbik.plugins.viewer.controls import Control

Change = Callable[[Control, Any], bool]
"""Called with what people set; returns whether it was taken."""

WIDEST_SLIDER = 1000  # longer ranges are typed


def add_control(gui: GuiApi, control: Control, value: Any, change: Change, label: str = "") -> Any:
    """Add the widget of a control; a value that is refused goes back to what it was.

    Args:
        gui: Of the page; the widget goes into the folder that is open.
        control: What it sets.
        value: What it holds at first.
        change: What to do with what people set.
        label: Its name for people, if not the control's own.
    """
    handle = _made(gui, control, value, label or control.name)
    if handle is None:
        return None
    kept, turns = [handle.value], Lock()  # events come on many threads

    def taken(event: GuiEvent[Any]) -> None:
        if event.client is None:  # set by ourselves
            kept[0] = event.target.value
            return
        with turns:  # read inside: the last to come in finds the newest
            given = event.target.value
            meant = (control.initial if given else None) if control.kind == "switch" else given
            if change(control, meant):
                kept[0] = given
            else:
                event.target.value = kept[0]

    handle.on_update(taken)
    return handle


class Slider:
    """A slider people drag while solves write to it: what they set last is never overwritten.

    Args:
        handle: viser's slider of whole numbers.
        change: Called with what people set.
    """

    def __init__(self, handle: Any, change: Callable[[int], Any]) -> None:
        self.handle, self._change = handle, change
        self._known, self._turns = int(handle.value), Lock()
        handle.on_update(self._moved)

    def _moved(self, event: GuiEvent[Any]) -> None:
        if event.client is not None:
            with self._turns:
                self._known = int(event.target.value)
                self._change(self._known)

    def show(self, value: int, last: int | None = None) -> None:
        """Move it, unless it is there; `last` is a new end of its range."""
        if last is not None:
            self.handle.max = last
        if value != self._known:
            self._known = value
            self.handle.value = value


def _made(gui: GuiApi, control: Control, value: Any, name: str) -> Any:
    hint = control.text or None
    match control.kind:
        case "bool":
            return gui.add_checkbox(name, bool(value), hint=hint)
        case "switch":
            return gui.add_checkbox(name, value is not None, hint=hint)
        case "choice":
            return gui.add_dropdown(name, control.choices, initial_value=value, hint=hint)
        case "vector":
            return _vector(gui, control, tuple(map(float, value)), name)
        case "int" | "float":
            number = int(value) if control.kind == "int" else float(value)
            return _number(gui, control, number, name)


def _number(gui: GuiApi, control: Control, value: float, name: str) -> Any:
    low, high = control.low, control.high
    if low is None or high is None or high - low > WIDEST_SLIDER:
        kind = type(value)
        ends = (None if end is None else kind(end) for end in (low, high))
        return gui.add_number(name, value, **_ends(*ends), hint=control.text or None)
    step = 1 if isinstance(value, int) else step_of(high - low)
    return gui.add_slider(
        name, type(value)(low), type(value)(high), step, value, hint=control.text or None
    )


def _ends(low: float | None, high: float | None) -> dict[str, Any]:
    return {"min": low, "max": high}


def _vector(gui: GuiApi, control: Control, value: tuple[float, ...], name: str) -> Any:
    made = {2: gui.add_vector2, 3: gui.add_vector3}.get(len(value))
    if made is None:
        return None
    ends = {
        end: (bound,) * len(value)
        for end, bound in (("min", control.low), ("max", control.high))
        if bound is not None
    }
    any_size: Any = made
    return any_size(name, value, **ends, step=0.01, hint=control.text or None)


def step_of(width: float) -> float:
    """Return a round step, at most a hundredth of a range's width."""
    return float(10.0 ** floor(log10(width / 100.0)))
