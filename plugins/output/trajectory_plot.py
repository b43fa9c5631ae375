"""Draw a motion: its path, speed and acceleration, and each joint's angle between its limits."""

from typing import TYPE_CHECKING, Any

import numpy as np

from limbik.core.scene import Scene
from limbik.plugins.output.plot import (
    FAINT,
    FINAL,
    GOAL,
    INK,
    LIMIT,
    LINE,
    LOOK,
    PAPER,
    SPACE,
    new_figure,
    picture,
)
from limbik.plugins.output.trajectory_files import axis_angles, axis_names
from limbik.plugins.paths.joints import JointMotion
from limbik.plugins.paths.program import Stretch, Trajectory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_POINTS = 4000  # a line in a picture needs no more
MOST_NAMES = 16  # key points with their names beside them
COLUMNS = 6  # of joint pictures
SHADES = {"corner": "#fdf0d5", "arc": "#e8f3ec", "spline": "#e6eefa", "turn": "#f3e8f7"}


def draw_motion(
    scene: Scene, trajectory: Trajectory, motion: JointMotion, form: str = "png"
) -> bytes:
    """Draw a motion.

    Args:
        scene: Where it comes from.
        trajectory: The plan.
        motion: Its samples, solved.
        form: `png`, `svg` or `pdf`.

    Returns:
        The file's content.
    """
    from matplotlib import rc_context

    with rc_context(LOOK):
        return picture(_figure(scene, trajectory, motion), form)


def _figure(scene: Scene, trajectory: Trajectory, motion: JointMotion) -> "Figure":
    axes = scene.chain.moving_axes
    rows = -(-len(axes) // COLUMNS)
    height = 7.7 + 2.1 * rows
    figure = new_figure(14.0, height)
    ratios = [6.0, 2.1 * rows]
    outer = figure.add_gridspec(2, 1, height_ratios=ratios, hspace=0.26)
    top = outer[0].subgridspec(2, 2, width_ratios=(1.1, 1.0), wspace=0.06, hspace=0.16)
    every = max(len(motion.samples) // MOST_POINTS, 1)
    _draw_path(figure.add_subplot(top[:, 0], projection="3d"), trajectory, motion, every)
    speed = figure.add_subplot(top[0, 1])
    _draw_speed(speed, trajectory, motion, every)
    _draw_acceleration(figure.add_subplot(top[1, 1], sharex=speed), motion, every)
    below = outer[1].subgridspec(rows, min(COLUMNS, len(axes)), wspace=0.32, hspace=0.5)
    for k, (joint, axis) in enumerate(axes):
        place = figure.add_subplot(below[k // COLUMNS, k % COLUMNS])
        span = (scene.chain.low[joint, axis], scene.chain.high[joint, axis])
        _draw_joint(place, motion, k, axis_names(scene.chain)[k], np.degrees(span), every)
    _title(figure, scene, trajectory, motion)
    edge = 0.5 / height
    figure.subplots_adjust(0.045, edge, 0.985, 1.0 - 1.45 / height)
    return figure


def _title(figure: "Figure", scene: Scene, trajectory: Trajectory, motion: JointMotion) -> None:
    high = figure.get_figheight()
    text = f"{scene.name}: {trajectory.duration:.2f} s, {len(motion.samples)} samples"
    figure.suptitle(text, fontsize=13, color=INK, y=1.0 - 0.18 / high, va="top")
    count = len(motion.failures)
    outcome, color = "every sample reached, within limits and speeds", GOAL
    if count:
        more = f", and {count - 1} more" if count > 1 else ""
        outcome, color = f"{motion.failures[0]}{more}", LIMIT
    figure.text(0.5, 1.0 - 0.52 / high, outcome, ha="center", va="top", color=color)


def _draw_path(axes: Any, trajectory: Trajectory, motion: JointMotion, every: int) -> None:
    """Draw the path in space, its colour the speed, with key points and failed samples."""
    from matplotlib.ticker import MaxNLocator
    from mpl_toolkits.mplot3d.art3d import Line3DCollection

    places = motion.samples.positions[::every][:, SPACE]
    points = np.array([point.position for point in trajectory.key_points])[:, SPACE]
    everything = np.concatenate([places, points])
    low, high = everything.min(axis=0), everything.max(axis=0)
    extent = float((high - low).max()) or 1.0
    spare = np.maximum(0.4 * extent - (high - low), 0.0) / 2.0 + 0.06 * extent
    low, high = low - spare, high + spare
    floor = places.copy()
    floor[:, 2] = low[2]
    axes.plot(*floor.T, color="#dfe4ea", lw=1.6, zorder=1)
    pieces = Line3DCollection(np.stack([places[:-1], places[1:]], axis=1), cmap="viridis", lw=2.4)
    pieces.set_array(motion.samples.speeds[::every][:-1])
    axes.add_collection3d(pieces)
    axes.figure.colorbar(
        pieces, ax=axes, shrink=0.5, pad=0.0, aspect=28, label="speed [length/s]", location="left"
    )
    axes.plot(*points.T, "o", ms=5.5, mfc=PAPER, mec=INK, mew=1.2, zorder=8)
    _name_points(axes, trajectory, points)
    for failure in motion.failures:
        where = motion.samples.positions[failure.first : failure.last + 1 : every][:, SPACE]
        axes.plot(*where.T, ".", ms=5, color=LIMIT, zorder=9)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.05)
    axes.view_init(elev=22, azim=-62)
    for axis, letter in ((axes.xaxis, "x"), (axes.yaxis, "z"), (axes.zaxis, "y")):
        axis.set_major_locator(MaxNLocator(5))
        axis.set_tick_params(labelsize=7, pad=-2)
        axis.set_label_text(letter, fontsize=9, color=FAINT)
        axis.labelpad = -6


def _name_points(axes: Any, trajectory: Trajectory, points: Any) -> None:
    """Write names beside the key points, each once."""
    seen: set[str] = set()
    for point, place in zip(trajectory.key_points, points, strict=True):
        if point.name and point.name not in seen and len(seen) < MOST_NAMES:
            seen.add(point.name)
            axes.text(*place, f"  {point.name}", fontsize=7.5, color=INK, zorder=10)


def _shade(axes: Any, stretches: list[Stretch]) -> None:
    """Lay a colour under corners, arcs, splines and turns, and name each once on top."""
    joined: list[tuple[float, float, str, int]] = []
    for stretch in stretches:
        last = joined[-1] if joined else None
        if last and last[2:] == (stretch.shape, stretch.move) and stretch.start <= last[1] + 1e-9:
            joined[-1] = (last[0], stretch.end, stretch.shape, stretch.move)
        else:
            joined.append((stretch.start, stretch.end, stretch.shape, stretch.move))
    for start, end, shape, _ in joined:
        if shape in SHADES:
            axes.axvspan(start, end, color=SHADES[shape], lw=0, zorder=0)
        spot = (0.5 * (start + end), 1.0)
        axes.annotate(
            shape, spot, (0, 3), ("data", "axes fraction"), "offset points",
            ha="center", fontsize=7, color=FAINT, rotation=40 if shape == "corner" else 0,
        )  # fmt: skip


def _draw_speed(axes: Any, trajectory: Trajectory, motion: JointMotion, every: int) -> None:
    """Draw the speed along the path and the limit of each move."""
    samples = motion.samples
    _shade(axes, trajectory.stretches())
    for piece, start in zip(trajectory.pieces, trajectory.starts.tolist(), strict=True):
        t = start
        for span in piece.spans:
            length = sum(phase.duration for phase in span.phases)
            rates = getattr(span.source, "rates", None)
            if rates is not None and piece.legs[0].moves:
                axes.hlines(rates.speed, t, t + length, color=LIMIT, lw=1.0, ls=(0, (4, 2)))
            t += length
    axes.plot(samples.times[::every], samples.speeds[::every], color=FINAL, lw=1.6)
    _dress(axes, "speed [length/s]; dashed: the move's limit")
    axes.tick_params(labelbottom=False)
    axes.set_ylim(bottom=0.0)


def _draw_acceleration(axes: Any, motion: JointMotion, every: int) -> None:
    """Draw the size of the acceleration and its part along the path."""
    samples = motion.samples
    whole = samples.accelerations()
    speed = samples.speeds
    along = (whole * samples.velocities).sum(axis=1) / np.maximum(speed, 1e-12)
    sideways = np.sqrt(np.maximum((whole**2).sum(axis=1) - along**2, 0.0))
    standing = speed <= 1e-6 * max(float(speed.max()), 1e-300)  # there is no direction of travel
    if standing.any() and len(speed) > 1:
        along[standing] = (np.linalg.norm(whole, axis=1) * np.sign(np.gradient(speed)))[standing]
        sideways[standing] = 0.0
    times = samples.times[::every]
    axes.plot(times, along[::every], color=FINAL, lw=1.4, label="along the path")
    axes.plot(times, sideways[::every], color="#e69f00", lw=1.2, label="sideways")
    axes.legend(loc="upper right", ncols=2, frameon=False, fontsize=8, labelcolor=INK)
    _dress(axes, "acceleration [length/s²]")
    axes.margins(y=0.18)
    axes.set_xlabel("time [s]", fontsize=8, color=FAINT)


def _draw_joint(axes: Any, motion: JointMotion, k: int, name: str, span: Any, every: int) -> None:
    """Draw one angle between its limits; where it fails in red."""
    samples = motion.samples
    angles = axis_angles(motion)[:, k]
    axes.plot(samples.times[::every], angles[::every], color=FINAL, lw=1.5)
    for failure in motion.failures:
        if failure.joint == name:
            part = slice(failure.first, failure.last + 1)
            axes.plot(samples.times[part], angles[part], color=LIMIT, lw=2.4)
    for limit in span:
        if np.isfinite(limit):
            axes.axhline(limit, color=LIMIT, lw=1.0, ls=(0, (4, 2)))
    if np.isfinite(span).all():
        room = 0.06 * float(span[1] - span[0])
        axes.set_ylim(min(span[0], angles.min()) - room, max(span[1], angles.max()) + room)
    _dress(axes, f"{name} [°]")


def _dress(axes: Any, title: str) -> None:
    axes.set_title(title, fontsize=8.5, color=INK, loc="left", pad=30 if "limit" in title else 4)
    axes.grid(True)
    axes.tick_params(labelsize=7, length=0)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.spines["left"].set_color(LINE)
