"""`Page`: session and drawing held together; every change goes through `act`."""

from collections.abc import Callable
from typing import Any, Final, Protocol

import numpy as np
from viser import ViserServer

from limbik.core.errors import LimbikError
from limbik.core.posegoals import PoseSolution
from limbik.core.rotation import Array, hpb_to_matrix, matrix_to_hpb
from limbik.core.solution2d import PlanarSolution
from limbik.plugins.viewer.axes import to_page
from limbik.plugins.viewer.drawing import ChainDrawing, Limb, SkeletonDrawing, blocking
from limbik.plugins.viewer.gizmos import Gizmo
from limbik.plugins.viewer.looks import GOAL, OTHER, PLANE
from limbik.plugins.viewer.session import Session, Shown
from limbik.plugins.viewer.shapes import ball
from limbik.plugins.viewer.stage import set_stage
from limbik.plugins.viewer.status import status_html

ARROWS: Final = 0.2  # of a gizmo, over the chain's length
THICK: Final = 0.05  # of a joint, over the chain's length
OF_A_BONE: Final = 0.35  # of a joint at most, over the usual bone's length


class Panel(Protocol):
    """A part of the page beside the picture."""

    def update(self, shown: dict[str, Shown], dragged: bool) -> None:
        """Show a solve; while a gizmo is dragged only what is quick."""


class Page:
    """What all open pages show.

    Args:
        server: Of the page.
        session: What is shown.

    Attributes:
        drawings: The chains, by name.
        goals, poles: Their gizmos.
        apart: How far beside the pose of the solver compared with stands, over the length.
    """

    def __init__(self, server: ViserServer, session: Session) -> None:
        self.server, self.session = server, session
        self.apart = 0.6
        self._error, self._closed = "", False
        self._panels: list[Panel] = []
        self._rows: list[tuple[str, Shown]] = []
        shown = session.solve(stages=True)
        set_stage(server, session, shown)
        self._status = server.gui.add_html("")
        self.drawings: dict[str, ChainDrawing] = {}
        self.goals: dict[str, Gizmo] = {}
        self.poles: dict[str, Gizmo] = {}
        for name, one in shown.items():
            self._add(name, one)
        self._skeleton = SkeletonDrawing(server.scene, session)
        self.select(session.selected)

    def select(self, name: str) -> None:
        """Let panels and comparison be about a chain."""
        with self.session.lock:
            self.session.select(name)
            shown = self.session.solve(stages=True)
            one, scene = shown[name], self.server.scene
            size = joint_size(one)
            self._other = Limb(scene, "/compared", len(one.positions), size, OTHER)
            self._other_goal = scene.add_mesh_simple(
                "/compared/goal", 1.3 * size * ball()[0], ball()[1], color=GOAL, opacity=0.5
            )
            self._show(shown, dragged=False)

    def _add(self, name: str, shown: Shown) -> None:
        size = ARROWS * shown.solution.chain.length
        several = len(self.session.chains) > 1
        self.drawings[name] = ChainDrawing(
            self.server.scene, f"/{name}", shown, joint_size(shown), plain=several
        )

        def moved(place: Array, turn: Array, over: bool) -> bool:
            def change() -> None:
                self.session.move_goal(name, place)
                if self.goals[name].rotates:
                    self.session.turn_goal(name, matrix_to_hpb(turn))

            return self.act(change, dragged=not over)

        def pole_moved(place: Array, turn: Array, over: bool) -> bool:
            one = self.session.chains[name]

            def change() -> None:
                self.session.change(name, one.setup.with_pole(one.from_world(place)))

            return self.act(change, dragged=not over)

        self.goals[name] = Gizmo(
            self.server, f"/{name}-goal", name if several else "goal", size, GOAL,
            self.session.flat, moved,
        )  # fmt: skip
        self.poles[name] = Gizmo(
            self.server, f"/{name}-pole", "pole", 0.8 * size, PLANE, None, pole_moved
        )

    def add_panel(self, panel: Panel) -> None:
        """Let a panel know of every solve from now on."""
        self._panels.append(panel)
        panel.update(self.session.solve(stages=True), False)

    def act(self, change: Callable[[], Any], dragged: bool = False) -> bool:
        """Change the session and show what comes of it; say so if the change is refused.

        Args:
            change: Changes the session or raises `LimbikError`.
            dragged: Whether more changes follow at once, from a gizmo or a path that plays.

        Returns:
            Whether it was taken.
        """
        with self.session.lock:
            if self._closed:
                return False
            try:
                with self.session.tried():
                    change()
                    shown = self.session.solve(stages=not dragged)
            except LimbikError as error:
                self._error = str(error)
                self._status.content = status_html(self._rows, self._error)
                return False
            self._error = ""
            self._show(shown, dragged)
            return True

    def close(self) -> None:
        """Take no changes any more: nobody is there to see them."""
        with self.session.lock:
            self._closed = True

    def _show(self, shown: dict[str, Shown], dragged: bool) -> None:
        with self.server.atomic():
            for name, one in shown.items():
                self.drawings[name].update(one)
                chained = self.session.chains[name]
                gizmo = self.goals[name]
                turn = np.eye(3)
                if gizmo.rotates:
                    given = chained.world_turn(chained.setup, self.session.frame)
                    turn = _goal_turn(given, one)
                gizmo.put(chained.to_world(chained.goal), turn)
                pole = self.poles[name]
                pole.visible = chained.setup.in_plane
                if pole.visible:
                    pole.put(chained.pole(chained.setup))
            compared = self.session.compared(shown)
            self._skeleton.update(self.session)
            self._show_compared(compared)
            self._rows = _rows(shown, compared)
            self._status.content = status_html(self._rows, self._error)
            for panel in self._panels:
                panel.update(shown, dragged)

    def _show_compared(self, shown: Shown | None) -> None:
        self._other.visible = shown is not None
        self._other_goal.visible = shown is not None
        if shown is None:
            return
        flat = self.session.flat
        right = np.array([1.0, 0.0, 0.0]) if flat is None else flat.axes[:, 0]
        shift = self.apart * shown.solution.chain.length * right
        self._other.update(shown.positions + shift, blocking(shown.solution))
        self._other_goal.position = to_page(shown.solution.goal + shift)


def _rows(shown: dict[str, Shown], compared: Shown | None) -> list[tuple[str, Shown]]:
    """Name what was solved: chains by their names, a single one by its solver."""
    rows = list(shown.items()) if len(shown) > 1 else [(name_of(s), s) for s in shown.values()]
    return rows if compared is None else [*rows, (name_of(compared), compared)]


def name_of(shown: Shown) -> str:
    """Return the name of the solver at work."""
    return str(shown.setup.choice["use"])


def joint_size(shown: Shown) -> float:
    """Return how thick a chain's joints are [length]."""
    chain = shown.solution.chain
    bones = chain.lengths[chain.lengths > 0.0]
    return float(min(THICK * chain.length, OF_A_BONE * np.median(bones)))


def _goal_turn(turn: Array | None, shown: Shown) -> Array:
    """Return the axes of a goal: given, or what one without any stands for."""
    if turn is not None and np.isfinite(turn).all():
        return hpb_to_matrix(turn)
    solution = shown.solution
    axes = None
    if isinstance(solution, PlanarSolution | PoseSolution):
        axes = solution.goal_rotation
    known = axes is not None and np.isfinite(axes).all()
    return np.asarray(axes if known else shown.rotations[-1])
