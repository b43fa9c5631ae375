"""The page without a browser: what a client sends over the wire moves the chain, or is refused."""

import math
import time
from collections.abc import Callable, Iterator
from functools import partial
from threading import Thread
from typing import Any

import numpy as np
import pytest

from limbik.core.solution2d import PlanarSolution
from limbik.plugins.viewer.axes import to_page
from limbik.plugins.viewer.session import LAST
from limbik.tests.viewer.scenes import Opened

viser = pytest.importorskip("viser", reason="the extra 'view' is not installed")
websockets = pytest.importorskip("websockets.sync.client")
msgspec = pytest.importorskip("msgspec")

from viser import _messages as wire  # noqa: E402 - after it is known to be there

from limbik.plugins.viewer.server import Viewer  # noqa: E402

PATIENCE = 20.0  # [s]


class Client:
    """Somebody who speaks to the page's server as the browser does."""

    def __init__(self, viewer: Viewer) -> None:
        self.viewer, self._held = viewer, ""
        self._line = websockets.connect(
            viewer.url.replace("http", "ws"),
            subprotocols=[f"viser-v{viser.__version__}"],
            max_size=None,
        )
        self._line.recv(timeout=PATIENCE)
        still, ahead = (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        up = (0.0, 1.0, 0.0)
        seen = wire.ViewerCameraMessage(still, up, 0.7, 0.1, 100.0, 600, 800, ahead, up)
        self.send(seen)  # only who has told what it sees is a client
        until(lambda: bool(viewer.page.server.get_clients()))

    def send(self, message: Any) -> None:
        self._line.send(msgspec.msgpack.encode(message.as_serializable_dict()))

    def drag(self, gizmo: str, place: Any, over: bool = False) -> None:
        """Send a place in the page's axes."""
        x, y, z = map(float, place)
        if gizmo != self._held:
            self._held = gizmo
            self.send(wire.TransformControlsDragStartMessage(gizmo))
        self.send(wire.TransformControlsUpdateMessage(gizmo, (1.0, 0.0, 0.0, 0.0), (x, y, z)))
        if over:
            self._held = ""
            self.send(wire.TransformControlsDragEndMessage(gizmo))

    def set(self, label: str, value: Any) -> None:
        """Set the widget with a label."""
        self.send(wire.GuiUpdateMessage(self.widget(label)._impl.uuid, {"value": value}))

    def widget(self, label: str) -> Any:
        with self.viewer.page.session.lock:  # panels are remade under it
            known = self.viewer.page.server.gui._gui_input_handle_from_uuid.values()
            return next(handle for handle in known if getattr(handle, "label", "") == label)

    def close(self) -> None:
        self._line.close()


Visiting = Callable[[str], Client]


@pytest.fixture
def visit(opened: Opened) -> Iterator[Visiting]:
    """Open a shipped scene and connect to it."""
    clients: list[Client] = []

    def visit(name: str) -> Client:
        clients.append(Client(Viewer(opened(name), port=0)))
        return clients[-1]

    yield visit
    for client in clients:
        client.close()
        client.viewer.close()


def until(true: Callable[[], bool]) -> None:
    """Wait until something is so."""
    end = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < end, "it never came about"
        time.sleep(0.01)


def drawn(client: Client, name: str) -> np.ndarray:
    """Where the page has the joints, in limbik's axes."""
    return to_page(client.viewer.page.drawings[name].limb._joints.batched_positions)


def test_a_drag_moves_the_end_there_and_a_nan_does_not(visit: Visiting) -> None:
    client = visit("arm")
    session = client.viewer.page.session
    goal = np.array([12.0, 130.0, 35.0])
    client.drag("/arm-goal", to_page(goal), over=True)
    until(lambda: bool(np.allclose(session.chain.goal, goal)))
    until(lambda: bool(np.allclose(drawn(client, "arm")[-1], goal, atol=0.02)))
    client.drag("/arm-goal", (math.nan, 1.0, 2.0))
    client.drag("/arm-goal", (1.0, math.inf, 2.0), over=True)
    handle = client.viewer.page.goals["arm"]._handle
    until(lambda: bool(np.allclose(handle.position, to_page(goal))))
    np.testing.assert_allclose(session.chain.goal, goal)
    assert np.isfinite(drawn(client, "arm")).all()


def test_a_burst_of_drags_ends_with_the_last(visit: Visiting) -> None:
    client = visit("arm")
    start = client.viewer.page.session.chain.goal.copy()
    down, last = np.array([0.0, -0.2, 0.0]), start - np.array([0.0, 25.0, 0.0])
    for step in range(100):
        client.drag("/arm-goal", to_page(start + step * down))
    client.drag("/arm-goal", to_page(last), over=True)
    until(lambda: bool(np.allclose(drawn(client, "arm")[-1], last, atol=0.02)))


def test_the_pole_drags_the_knee(visit: Visiting) -> None:
    client = visit("leg-pole")
    before = drawn(client, "leg-pole")[1]
    client.drag("/leg-pole-pole", to_page([60.0, 50.0, 0.0]), over=True)
    until(lambda: drawn(client, "leg-pole")[1][0] > before[0] + 3.0)


def test_every_goal_can_be_turned_also_one_that_says_nothing_of_it(visit: Visiting) -> None:
    client = visit("leg-pole")
    page = client.viewer.page
    client.set("turn the goal", True)
    handle = page.goals["leg-pole"]._handle
    until(lambda: not handle.disable_rotations)
    for frame, name in enumerate(page.session.path.names):
        client.set("frame", frame)
        until(lambda frame=frame: page.session.frame == frame)  # type: ignore[misc]
        assert np.isfinite(handle.wxyz).all(), name


def test_widgets_change_strategy_option_and_stage(visit: Visiting) -> None:
    client = visit("arm")
    page = client.viewer.page
    client.set("tolerance", 0.5)
    until(lambda: page.session.chain.setup.settings.tolerance == 0.5)
    client.set("tolerance", -1.0)
    until(lambda: "tolerance" in page._error)
    assert page.session.chain.setup.settings.tolerance == 0.5
    until(lambda: client.widget("tolerance").value == 0.5)
    client.set("stage", 0)
    until(lambda: page.session.stage == 0)
    rest = page.session.chain.setup.chain
    assert len(drawn(client, "arm")) == len(rest)
    client.set("stage", client.widget("stage").max)
    until(lambda: page.session.stage == LAST)


def test_the_server_listens_on_this_machine_only_and_shares_nothing(visit: Visiting) -> None:
    viewer = visit("arm").viewer
    assert viewer.url.startswith("http://127.0.0.1:")
    assert viewer.page.server.get_host() == "127.0.0.1"
    assert viewer.page.server._share_tunnel is None


def test_a_taken_port_is_passed_over(visit: Visiting, opened: Opened) -> None:
    first = visit("arm").viewer
    taken = int(first.url.rsplit(":", 1)[1])
    second = Viewer(opened("arm"), port=taken)
    try:
        assert int(second.url.rsplit(":", 1)[1]) != taken
    finally:
        second.close()


def labels(client: Client) -> list[str]:
    """The labels of all widgets."""
    with client.viewer.page.session.lock:
        known = client.viewer.page.server.gui._gui_input_handle_from_uuid.values()
        return [getattr(handle, "label", "") for handle in known]


def segments_of(client: Client, name: str, line: str) -> np.ndarray:
    """Ends of a line's segments, (k, 2, 3), in limbik's axes."""
    return to_page(client.viewer.page.drawings[name].lines[line].points)


def _is_drawn(client: Client, line: str) -> bool:
    return bool(np.abs(segments_of(client, "leg-pole", line)).any())


def test_lines_end_where_they_should(visit: Visiting) -> None:
    client = visit("leg-pole")
    page = client.viewer.page
    session = page.session
    page.act(lambda: session.go_to(2))
    for line in ("handle", "IK component", "FK component", "pole", "bend direction"):
        client.set(line, True)
    drawing = page.drawings["leg-pole"]
    until(lambda: all(handle.visible for handle in drawing.lines.values()))
    until(lambda: session.parts == {"IK", "FK"})
    with session.lock:
        one = session.solve()["leg-pole"]
    solution = one.solution
    assert isinstance(solution, PlanarSolution)
    base, end = one.positions[0], one.positions[-1]
    expected = {
        "handle": np.array([[base, end]]),
        "pole": np.array([[base, solution.pole]]),
        "IK component": np.stack([one.parts["IK"][:-1], one.parts["IK"][1:]], 1),
        "FK component": np.stack([one.parts["FK"][:-1], one.parts["FK"][1:]], 1),
    }
    for line, ends in expected.items():
        until(partial(_is_drawn, client, line))
        np.testing.assert_allclose(segments_of(client, "leg-pole", line), ends, atol=1e-4)
    start, tip = segments_of(client, "leg-pole", "bend direction")[0]
    way = (tip - start) / np.linalg.norm(tip - start)
    np.testing.assert_allclose(way, solution.plane[:, 1], atol=1e-5)


def test_a_line_takes_the_colour_it_is_given(visit: Visiting) -> None:
    client = visit("arm")
    line = client.viewer.page.drawings["arm"].lines["handle"]
    client.set("in", (255, 0, 0))
    until(lambda: line.colors.reshape(-1, 3).tolist() == [[255, 0, 0]] * 2)


def test_the_panels_follow_the_chain_that_is_selected(visit: Visiting) -> None:
    client = visit("body")
    page = client.viewer.page
    client.set("chain", "left arm")
    until(lambda: page.session.selected == "left arm")
    goal = page.session.chain.goal
    until(lambda: bool(np.allclose(client.widget("goal").value, goal, atol=1e-6)))
    until(lambda: "left_elbow" in client.widget("joint").options)
    client.set("with", "fabrik")
    until(lambda: page._other.visible)


def test_serving_ends_a_while_after_the_last_page_was_closed(visit: Visiting) -> None:
    first = visit("arm")
    viewer = first.viewer
    waiting = Thread(target=viewer.wait, args=(2.0,), daemon=True)
    waiting.start()
    until(lambda: viewer.pages == 1)
    second = Client(viewer)
    first.close()
    until(lambda: viewer.pages == 1)
    waiting.join(3.0)
    assert waiting.is_alive()  # a second page keeps it
    second.close()
    until(lambda: viewer.pages == 0)
    again = Client(viewer)  # somebody loads the page anew
    waiting.join(3.0)
    assert waiting.is_alive()
    again.close()
    waiting.join(PATIENCE)
    assert not waiting.is_alive()


def test_a_path_that_plays_takes_the_handle_along(visit: Visiting) -> None:
    client = visit("planar")
    page = client.viewer.page
    gizmo = page.goals["planar"]
    client.set("play", True)
    until(lambda: page.session.frame > 1)
    client.set("play", False)
    until(lambda: np.allclose(gizmo._handle.position, to_page(page.session.chain.goal)))


def test_a_handle_that_is_held_is_left_to_who_holds_it(visit: Visiting) -> None:
    client = visit("planar")
    page = client.viewer.page
    handle, goal = page.goals["planar"]._handle, np.array([0.0, 1.4, 0.9])
    beside = goal + np.array([0.3, 0.0, 0.0])  # off the plane, where the goal does not go
    client.drag("/planar-goal", to_page(beside))
    until(lambda: np.allclose(page.session.chain.goal, goal))
    page.act(lambda: None)
    np.testing.assert_allclose(handle.position, to_page(beside))
    client.drag("/planar-goal", to_page(beside), over=True)
    until(lambda: np.allclose(handle.position, to_page(goal)))


def test_an_option_by_joint_and_a_limit_are_set_from_the_page(visit: Visiting) -> None:
    client = visit("arm")
    session = client.viewer.page.session
    client.set("elbow", 0.5)
    until(lambda: session.chain.setup.settings.stiffness == {"elbow": 0.5})
    client.set("choose", True)
    until(lambda: "choose pose" in labels(client))
    client.set("choose pose", True)
    until(lambda: session.chain.setup.settings.model_dump()["choose"]["pose"] == {})
    client.set("limit", "cone")
    until(lambda: session.chain.setup.own[0] is not None)
    until(lambda: "swing" in labels(client))
    client.set("swing", (60.0, 35.0))
    until(lambda: (session.chain.setup.own[0] or {})["swing"] == (60.0, 35.0))
    client.set("limit", "ranges")
    until(lambda: session.chain.setup.own[0] is None)
