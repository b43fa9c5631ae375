"""The viewer in a real browser: the page loads, a drag moves the limb, switches switch.

Needs a Chromium on the PATH and the extra `browser`. The picture is kept in the folder that
`LIMBIK_PICTURES` names, else in the test's own.
"""

import os
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik.core.scene import read_scene
from limbik.core.solving import solve_scene
from limbik.plugins.viewer.axes import from_page, to_page
from limbik.plugins.viewer.session import LAST
from limbik.tests.viewer.process import viewing
from limbik.tests.viewer.scenes import Opened

playwright = pytest.importorskip("playwright.sync_api", reason="the extra 'browser' is missing")
pytest.importorskip("viser", reason="the extra 'view' is not installed")

from limbik.plugins.viewer.server import Viewer  # noqa: E402 - after viser is known to be there

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
WIDE, HIGH = 1400, 860  # narrower, and the panel covers the picture
PATIENCE = 60.0  # [s]; without a GPU everything is slow
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="no chromium on the PATH"),
]


class Visit:
    """A page in the browser, and the server's side of it."""

    def __init__(self, viewer: Viewer, browser: Any) -> None:
        self.viewer, self.session = viewer, viewer.page.session
        self.outside: list[str] = []
        self.errors: list[str] = []
        self.page = browser.new_page(viewport={"width": WIDE, "height": HIGH})
        self.page.on("request", lambda request: self._look_at(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(f"{viewer.url}/?fixedDpr=1")
        drawn(self.page)
        self.until(lambda: bool(viewer.page.server.get_clients()))

    def _look_at(self, url: str) -> None:
        if not url.startswith((self.viewer.url, "data:", "blob:")):
            self.outside.append(url)

    def until(self, true: Callable[[], bool]) -> None:
        """Wait until something is so, and let the page run meanwhile."""
        assert self.came(true, PATIENCE)

    def came(self, true: Callable[[], bool], patience: float) -> bool:
        """Wait for something for a while; tell whether it came."""
        end = time.monotonic() + patience
        while not true():
            if time.monotonic() > end:
                return False
            self.page.wait_for_timeout(50)
        return True

    def pixel(self, place: Any) -> tuple[float, float]:
        """Where on the page a place of the page's world is."""
        (client,) = self.viewer.page.server.get_clients().values()
        camera = client.camera
        ahead = camera.look_at - camera.position
        ahead /= np.linalg.norm(ahead)
        right = np.cross(ahead, camera.up_direction)
        right /= np.linalg.norm(right)
        away = np.asarray(place) - camera.position
        size = 0.5 * HIGH / np.tan(camera.fov / 2.0) / (away @ ahead)
        return WIDE / 2 + size * (away @ right), HIGH / 2 - size * (away @ np.cross(right, ahead))

    def pull(self, axis: int, pixels: float) -> None:
        """Drag the goal by one of its arrows; tried again until it moves along that one.

        A drag that misses all arrows turns the camera, one may hit another arrow.
        """
        (gizmo,) = self.viewer.page.goals.values()
        for share in (0.75, 0.85, 0.65, 0.9, 0.6) * 3:
            before = self.session.chain.goal.copy()
            start = to_page(before)
            arrow = gizmo._size * np.eye(3)[axis]
            x, y = self.pixel(start + share * arrow)
            x0, y0 = self.pixel(start)
            way = np.array([x - x0, y - y0]) / np.hypot(x - x0, y - y0)
            mouse = self.page.mouse
            mouse.move(x, y)
            self.page.wait_for_timeout(150)
            mouse.down()
            for step in range(1, 9):
                mouse.move(*(np.array([x, y]) + way * pixels * step / 8.0))
                self.page.wait_for_timeout(40)
            mouse.up()
            self.came(lambda: not np.allclose(self.session.chain.goal, before), 2.0)  # noqa: B023
            self.page.wait_for_timeout(500)
            moved = np.abs(to_page(self.session.chain.goal) - start)
            if moved[axis] > 0.0 and moved.argmax() == axis:
                assert np.delete(moved, axis).max() < 1e-6 * moved[axis]
                return
        pytest.fail(f"arrow {axis} could not be grabbed")

    def tab(self, name: str) -> None:
        self.page.get_by_role("tab", name=name, exact=True).click()

    def choose(self, now: str, wanted: str) -> None:
        """Choose from the list that shows what is chosen now."""

        boxes = self.page.locator("input:visible")

        def shown() -> list[str]:
            values: list[str] = boxes.evaluate_all("all => all.map(one => one.value)")
            return values

        self.until(lambda: now in shown())
        boxes.nth(shown().index(now)).click()
        self.page.get_by_role("option", name=wanted, exact=True).click()

    def picture(self, path: Path) -> None:
        self.page.wait_for_timeout(500)
        self.page.screenshot(path=path)


def drawn(page: Any) -> None:
    """Wait until a page shows its panels."""
    page.get_by_role("tab", name="Pose", exact=True).wait_for(timeout=1e3 * PATIENCE)


Visiting = Callable[[str], Visit]


@pytest.fixture
def visit(opened: Opened) -> Iterator[Visiting]:
    with playwright.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM)
        viewers = []

        def visit(name: str) -> Visit:
            viewers.append(Viewer(opened(name), port=0))
            return Visit(viewers[-1], browser)

        yield visit
        browser.close()
        for viewer in viewers:
            viewer.close()


def test_a_person_drags_switches_and_looks_at_stages(visit: Visiting, tmp_path: Path) -> None:
    seen = visit("arm")
    session = seen.session

    for axis, pixels in ((1, -40.0), (0, 40.0)):
        seen.pull(axis, pixels)
        end = from_page(seen.viewer.page.drawings["arm"].limb._joints.batched_positions)[-1]
        np.testing.assert_allclose(end, session.chain.goal, atol=0.02)

    seen.tab("Solver")
    seen.choose("nth-root", "two-bone")
    seen.until(lambda: session.chain.setup.chosen("initial_bend")["use"] == "two-bone")

    seen.tab("Pose")
    slider = seen.page.get_by_role("slider").first
    slider.focus()
    slider.press("Home")
    seen.until(lambda: session.stage == 0)
    slider.press("ArrowRight")
    slider.press("ArrowRight")
    seen.until(lambda: session.stage == 2)
    slider.press("End")
    seen.until(lambda: session.stage == LAST)

    folder = Path(os.environ.get("LIMBIK_PICTURES", tmp_path))
    seen.picture(folder / "viewer-arm.png")
    assert (folder / "viewer-arm.png").stat().st_size > 10_000
    assert seen.errors == []
    assert seen.outside == []


def test_scene_and_picture_can_be_taken_away(visit: Visiting, tmp_path: Path) -> None:
    seen = visit("leg-pole")
    seen.pull(0, 40.0)
    seen.tab("Show")
    for button, ending in (("save as scene", "yaml"), ("save picture", "png")):
        seen.page.get_by_role("button", name=button).click()
        link = seen.page.get_by_role("link", name=f"leg-pole-view.{ending}")
        with seen.page.expect_download() as coming:
            link.click(timeout=1e3 * PATIENCE)
        coming.value.save_as(tmp_path / f"saved.{ending}")
    (again,) = solve_scene(read_scene(tmp_path / "saved.yaml"))
    (shown,) = seen.session.solve().values()
    np.testing.assert_array_equal(again.angles, shown.angles)
    assert (tmp_path / "saved.png").read_bytes().startswith(b"\x89PNG")
    assert seen.outside == []


def test_the_command_ends_with_its_last_page_and_not_with_a_reload() -> None:
    with playwright.sync_playwright() as play, viewing("arm") as (process, url):
        browser = play.chromium.launch(executable_path=CHROMIUM)
        first = browser.new_page()
        first.goto(url)
        drawn(first)
        first.reload()
        drawn(first)
        second = browser.new_page()
        second.goto(url)
        drawn(second)
        first.close()
        second.wait_for_timeout(7e3)  # longer than the server goes on without a page
        assert process.poll() is None
        second.close()
        out, err = process.communicate(timeout=PATIENCE)
        browser.close()
    assert process.returncode == 0
    assert out == ""
    assert err.endswith("limbik: the last page was closed\n")
