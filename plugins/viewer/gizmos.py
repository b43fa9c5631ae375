"""Handles to drag: the goal of a chain, and the pole of the 2D solver."""

from collections.abc import Callable
from threading import Lock
from typing import Any

import numpy as np
from viser import TransformControlsEvent, ViserServer

from limbik.core.rotation import Array
from limbik.plugins.viewer.axes import (
    frame_to_page,
    from_page,
    to_page,
    turn_from_page,
    turn_to_page,
)
from limbik.plugins.viewer.looks import Colour
from limbik.plugins.viewer.shapes import ball
from limbik.plugins.viewer.views import Flat

Moved = Callable[[Array, Array, bool], bool]
"""Called with position, rotation and whether the drag is over; returns whether they were taken."""

FAR = 1e6
UP = np.array([0.0, 1.0, 0.0])


class Gizmo:
    """A ball with arrows to drag it by.

    Args:
        server: Of the page.
        name: Of the node.
        text: Written above it.
        size: Length of its arrows [length].
        colour: Of the ball.
        flat: The plane it stays in, if any.
        moved: What to do when somebody drags it.
    """

    def __init__(
        self,
        server: ViserServer,
        name: str,
        text: str,
        size: float,
        colour: Colour,
        flat: Flat | None,
        moved: Moved,
    ) -> None:
        self._size, self._flat = size, flat
        self._moved = moved
        self._place, self._turn = np.zeros(3), np.eye(3)
        self._ball = server.scene.add_mesh_simple(
            f"{name}-ball", 0.34 * size * ball()[0], ball()[1], color=colour, opacity=0.85
        )
        self._label = server.scene.add_label(f"{name}-label", text, anchor="bottom-center")
        self._rotates = False
        self._visible = True
        self._held = False
        self._turns = Lock()  # of the threads on which drags come
        self._is_put = False  # whether the handle is where it was put
        far = (-FAR, FAR)
        self._handle = server.scene.add_transform_controls(
            name,
            scale=size,
            active_axes=(True, True, flat is None),
            disable_rotations=True,
            disable_sliders=True,
            depth_test=False,
            translation_limits=(far, far, far),
        )
        self._handle.on_update(self._dragged)

    def _wxyz(self) -> Array:
        return turn_to_page(self._turn) if self._flat is None else frame_to_page(self._flat.axes)

    def _dragged(self, event: TransformControlsEvent) -> None:
        """Take the newest pose; one that is not finite, or is refused, is put back."""
        if event.phase == "start":
            self._held = True
            return
        with self._turns:  # read inside: the last to come in finds the newest
            self._held = self._held and event.phase != "end"
            self._is_put = False
            place, wxyz = np.array(event.target.position), np.array(event.target.wxyz)
            taken = False
            if np.isfinite(place).all() and np.isfinite(wxyz).all() and wxyz.any():
                turn = self._turn if self._flat is not None else turn_from_page(wxyz)
                taken = self._moved(from_page(place), turn, event.phase == "end")
            if not taken:
                self._handle.position, self._handle.wxyz = to_page(self._place), self._wxyz()

    def put(self, place: Array, turn: Array | None = None) -> None:
        """Put it somewhere, world; while somebody holds it only what goes with it moves."""
        turn = self._turn if turn is None else turn
        same = np.array_equal(place, self._place) and np.array_equal(turn, self._turn)
        if same and self._is_put:
            return
        self._place, self._turn, self._is_put = place, turn, not self._held
        at = to_page(place)
        self._ball.position = at
        self._label.position = at + 0.35 * self._size * UP
        if not self._held:
            self._handle.position, self._handle.wxyz = at, self._wxyz()

    @property
    def rotates(self) -> bool:
        """Whether it has rings to turn it by."""
        return self._rotates

    @rotates.setter
    def rotates(self, rotates: bool) -> None:
        self._rotates = rotates
        self._handle.disable_rotations = not rotates

    @property
    def visible(self) -> bool:
        """Whether it is there."""
        return self._visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._visible = visible
        node: Any
        for node in (self._ball, self._label, self._handle):
            node.visible = visible
