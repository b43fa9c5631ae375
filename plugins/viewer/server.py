"""The server of the page: on this machine only unless asked, without a request to the outside."""

import socket
from contextlib import redirect_stdout
from importlib.util import find_spec
from io import StringIO
from ipaddress import ip_address
from time import monotonic, sleep

from limbik.core.errors import EnvironmentProblem, Fault, InputError
from limbik.plugins.viewer.session import Session

LOOPBACK = "127.0.0.1"
PORT = 8080
LOOK = 0.25  # [s] from one look for pages to the next


def check_viewer() -> None:
    """Refuse, before anything else is done, a machine without viser.

    Raises:
        EnvironmentProblem: It is not installed.
    """
    if find_spec("viser") is None:
        raise EnvironmentProblem("the viewer needs viser: pip install 'limbik[view]'")


def is_loopback(host: str) -> bool:
    """Look whether an address can be listened at, and whether only this machine reaches it.

    Raises:
        InputError: It is no address of this machine.
    """
    try:
        family, *_, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
        with socket.socket(family) as trial:
            trial.bind(address)
    except OSError as error:
        message = f"cannot listen at '{host}': {error.strerror or error}"
        hint = f"{LOOPBACK} is this machine alone, 0.0.0.0 all that reach it"
        raise InputError(Fault("host", message, "--host", hint=hint)) from error
    return ip_address(address[0]).is_loopback


class Viewer:
    """A session on a page, served until it is closed.

    Args:
        session: What is shown.
        host: Address to listen at, that `is_loopback` has looked at.
        port: Port to begin looking for a free one at; 0 for any.

    Attributes:
        page: The page.
        url: Its address.
    """

    def __init__(self, session: Session, host: str = LOOPBACK, port: int = PORT) -> None:
        from viser import ViserServer

        from limbik.plugins.viewer.page import Page
        from limbik.plugins.viewer.pose_panel import PosePanel
        from limbik.plugins.viewer.show_panel import ShowPanel
        from limbik.plugins.viewer.solver_panel import SolverPanel

        session.solve(stages=True)  # compiles, before anybody is let in
        with redirect_stdout(StringIO()):  # its greeting
            self._server = ViserServer(host, port, label="limbik", verbose=False)
        gui = self._server.gui
        gui.configure_theme(show_share_button=False, show_logo=False, brand_color=(11, 61, 145))
        gui.set_panel_label(session.name)
        self.page: Page = Page(self._server, session)
        tabs = gui.add_tab_group()
        names = ("Pose", "Solver", "Options", "Joints", "Show")
        pose, solver, options, joints, show = (tabs.add_tab(name) for name in names)
        solving = SolverPanel(self.page, solver, options, joints)
        with pose:
            self._pose = PosePanel(self.page, solving.rebuild)
        with show:
            shown = ShowPanel(self.page)
        for panel in (self._pose, solving, shown):
            self.page.add_panel(panel)
        self.url = f"http://{host}:{self._server.get_port()}"

    @property
    def pages(self) -> int:
        """How many pages are open, also those that have not drawn anything yet."""
        return len(self._server._websock_server._live_connections)

    def wait(self, timeout: float) -> None:
        """Serve until there was a page and then none for a while.

        Args:
            timeout: How long to go on without a page [s]; 0 goes on until interrupted.
        """
        left: float | None = None  # when the last page was there
        while timeout <= 0.0 or left is None or monotonic() - left < timeout:
            sleep(LOOK)
            if self.pages:
                left = monotonic()

    def close(self) -> None:
        """Stop serving and playing."""
        self._pose.close()
        self.page.close()
        with redirect_stdout(StringIO()):  # its farewell
            self._server.stop()
