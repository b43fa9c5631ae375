"""What is drawn, in which colours; and what can be taken away: a scene, a picture."""

from io import BytesIO
from typing import Any

from viser import GuiEvent

from limbik.plugins.viewer.controls import Control
from limbik.plugins.viewer.export import scene_text
from limbik.plugins.viewer.looks import LINES, SHOWN_AT_FIRST
from limbik.plugins.viewer.page import Page
from limbik.plugins.viewer.session import PARTS, Shown
from limbik.plugins.viewer.status import angles_markdown
from limbik.plugins.viewer.widgets import add_control

PICTURE = (1600, 1000)
PATIENCE = 30.0  # [s] that a page may take to draw itself


class ShowPanel:
    """Switches, colours, files.

    Args:
        page: What it is about.
    """

    def __init__(self, page: Page) -> None:
        self._page, self._session = page, page.session
        gui = page.server.gui
        with gui.add_folder("lines"):
            for line in LINES:
                self._add_line(line)
        limits = Control(("limits",), "bool", text="ranges of the joints as arcs")
        first = next(iter(page.drawings.values()))
        add_control(gui, limits, first.with_limits, self._set_limits)
        rotate = Control(
            ("turn the goal",), "bool", text="rings to turn the goal by; moves a rotor"
        )
        add_control(gui, rotate, False, self._set_rotates)
        with gui.add_folder("angles", expand_by_default=False):
            self._angles = gui.add_markdown("")
        gui.add_button("save as scene", hint="a YAML file with one goal").on_click(self._save_scene)
        gui.add_button("save picture", hint="a PNG file, as seen here").on_click(self._save_picture)

    def update(self, shown: dict[str, Shown], dragged: bool) -> None:
        """Show a solve."""
        if not dragged:
            self._angles.content = angles_markdown(shown[self._session.chain.name])

    def _add_line(self, line: str) -> None:
        gui = self._page.server.gui

        def show(control: Control, value: Any) -> bool:
            def change() -> None:
                part = line.removesuffix(" component")
                if part in PARTS:
                    self._session.parts -= {part}
                    self._session.parts |= {part} if value else set()
                for drawing in self._page.drawings.values():
                    drawing.lines[line].visible = value

            return self._page.act(change)

        add_control(gui, Control((line,), "bool"), line in SHOWN_AT_FIRST, show)

        def paint(event: GuiEvent[Any]) -> None:
            with self._session.lock:
                for drawing in self._page.drawings.values():
                    drawing.colour_line(line, event.target.value)

        gui.add_rgb("in", LINES[line]).on_update(paint)

    def _set_limits(self, control: Control, value: Any) -> bool:
        for drawing in self._page.drawings.values():
            drawing.with_limits = bool(value)
        return self._page.act(lambda: None)

    def _set_rotates(self, control: Control, value: Any) -> bool:
        for gizmo in self._page.goals.values():
            gizmo.rotates = bool(value)
        return True

    def _save_scene(self, event: GuiEvent[Any]) -> None:
        if event.client is not None:
            with self._session.lock:
                text = scene_text(self._session)
            event.client.send_file_download(f"{self._session.name}-view.yaml", text.encode())

    def _save_picture(self, event: GuiEvent[Any]) -> None:
        if event.client is not None:
            content = picture(event.client)
            event.client.send_file_download(f"{self._session.name}-view.png", content)


def picture(client: Any, size: tuple[int, int] = PICTURE) -> bytes:
    """Return what a page shows as a PNG file.

    Args:
        client: viser's, of the page.
        size: Width and height [pixels].
    """
    from PIL import Image

    width, height = size
    pixels = client.get_render(height, width, transport_format="png", timeout=PATIENCE)
    shown = Image.fromarray(pixels)
    paper = Image.new("RGB", shown.size, "white")
    paper.paste(shown, mask=shown.getchannel("A") if shown.mode == "RGBA" else None)
    content = BytesIO()
    paper.save(content, "PNG", optimize=True)
    return content.getvalue()
