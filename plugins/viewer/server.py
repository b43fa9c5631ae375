"""The server of the page: on this machine only unless asked, without a request to the outside."""

from contextlib import redirect_stdout
from importlib.util import find_spec
from io import StringIO
from typing import TYPE_CHECKING

from limbik.core.errors import EnvironmentProblem
from limbik.plugins.viewer.session import Session

if TYPE_CHECKING:
    pass

LOOPBACK = "127.0.0.1"
PORT = 8080


def check_viewer() -> None:
    """Refuse, before anything else is done, a machine without viser.

    Raises:
        EnvironmentProblem: It is not installed.
    """
    if find_spec("viser") is None:
        raise EnvironmentProblem("the viewer needs viser: pip install 'limbik[view]'")


class Viewer:
    """A session on a page, served until it is closed.

    Args:
        session: What is shown.
        host: Address to listen at.
        port: Port to begin looking for a free one at; 0 for any.

    Attributes:
        page: The page.
        url: Its address.

    Raises:
        EnvironmentProblem: The address cannot be listened at.
    """

    def __init__(self, session: Session, host: str = LOOPBACK, port: int = PORT) -> None:
        from viser import ViserServer

        from limbik.plugins.viewer.page import Page
        from limbik.plugins.viewer.pose_panel import PosePanel
        from limbik.plugins.viewer.show_panel import ShowPanel
        from limbik.plugins.viewer.solver_panel import SolverPanel

        session.solve(stages=True)  # compiles, before anybody is let in
        try:
            with redirect_stdout(StringIO()):  # its greeting
                self._server = ViserServer(host, port, label="limbik", verbose=False)
        except OSError as error:
            reason = error.strerror or error
            raise EnvironmentProblem(f"cannot listen at {host}, port {port}: {reason}") from error
        gui = self._server.gui
        gui.configure_theme(show_share_button=False, show_logo=False, brand_color=(11, 61, 145))
        gui.set_panel_label(session.name)
        self.page: Page = Page(self._server, session)
        tabs = gui.add_tab_group()
        names = ("Pose", "Solver", "Options", "FK", "Show")
        pose, solver, options, fk, show = (tabs.add_tab(name) for name in names)
        solving = SolverPanel(self.page, solver, options, fk)
        with pose:
            self._pose = PosePanel(self.page, solving.rebuild)
        with show:
            shown = ShowPanel(self.page)
        for panel in (self._pose, solving, shown):
            self.page.add_panel(panel)
        self.url = f"http://{host}:{self._server.get_port()}"

    def wait(self) -> None:
        """Serve until the process is interrupted."""
        self._server.sleep_forever()

    def close(self) -> None:
        """Stop serving and playing."""
        self._pose.close()
        self.page.close()
        with redirect_stdout(StringIO()):  # its farewell
            self._server.stop()
