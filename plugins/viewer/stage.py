"""What surrounds the chains: floor, axes with their letters, the camera to begin with."""

from math import floor, log10
from typing import Any

import numpy as np
from viser import ViserServer

from limbik.core.rotation import Array
from limbik.plugins.viewer.axes import frame_to_page, to_page
from limbik.plugins.viewer.drawing import line_colours
from limbik.plugins.viewer.looks import TRIAD
from limbik.plugins.viewer.session import Session, Shown
from limbik.plugins.viewer.views import camera

ABOVE = 0.25  # that is seen above a goal, over the chain's length: its arrow


def set_stage(server: ViserServer, session: Session, shown: dict[str, Shown]) -> None:
    """Lay the floor, mark limbik's axes, place the camera."""
    points = seen_points(session, shown)
    low, high = points.min(0), points.max(0)
    size = float(np.linalg.norm(high - low)) or 1.0
    server.scene.set_up_direction("+y")
    server.scene.configure_default_lights(True, cast_shadow=False)
    cell = 10.0 ** floor(log10(size / 3.0))
    grid: dict[str, Any] = {
        "cell_size": cell,
        "section_size": 5.0 * cell,
        "width": 40.0 * cell,
        "height": 40.0 * cell,
        "cell_color": (232, 235, 239),
        "section_color": (214, 219, 226),
        "fade_distance": 3.0 * size,
    }
    if session.flat is None:
        foot = np.array([(low[0] + high[0]) / 2.0, low[1], (low[2] + high[2]) / 2.0])
        server.scene.add_grid("/floor", plane="xz", position=to_page(foot), **grid)
    else:
        behind = session.flat.origin - 0.05 * size * session.flat.axes[:, 2]
        server.scene.add_grid(
            "/floor",
            plane="xy",
            position=to_page(behind),
            wxyz=frame_to_page(session.flat.axes),
            **grid,
        )
    _triad(server, low - 0.06 * size * np.array([1.0, 0.0, 1.0]), 0.1 * size)
    view = camera(points, session.flat)
    start = server.initial_camera
    start.position, start.look_at = to_page(view.position), to_page(view.look_at)
    start.up, start.fov = np.array([0.0, 1.0, 0.0]), float(np.radians(view.field))
    start.near, start.far = 0.01 * size, 100.0 * size


def seen_points(session: Session, shown: dict[str, Shown]) -> Array:
    """Return what the camera shall see, (m, 3) [length]."""
    parts: list[Array] = []
    for name, one in shown.items():
        chained = session.chains[name]
        chain = one.solution.chain
        above = ABOVE * chain.length * np.array([0.0, 1.0, 0.0])
        parts += [one.positions, chain.rest_pose[0]]
        goals = chained.to_world(chained.goal)[None]
        if session.body is None and (session.follow or session.flat is not None):
            path = session.path.goals[name]
            away = np.linalg.norm(path - one.positions[0], axis=1)
            goals = np.concatenate([goals, path[away <= chain.length]])
        parts += [goals, goals + above]
        if chained.setup.in_plane:
            parts += [chained.pole(chained.setup)[None], one.positions[:1] + above]
    if session.whole is not None:
        parts.append(session.whole.positions)
    return np.concatenate(parts)


def _triad(server: ViserServer, place: Array, length: float) -> None:
    """Draw limbik's own axes with letters: a frame of the page would point x the other way."""
    ends = place + length * np.eye(3)
    lines = np.stack([np.stack([place, end]) for end in ends])
    server.scene.add_line_segments(
        "/axes",
        to_page(lines).astype(np.float32),
        line_colours(np.array(TRIAD)),
        thickness=3.0,
        thickness_units="screen",
    )
    for letter, end in zip("XYZ", place + 1.15 * length * np.eye(3), strict=True):
        server.scene.add_label(
            f"/axes/{letter}", letter, position=to_page(end), anchor="center-center"
        )
