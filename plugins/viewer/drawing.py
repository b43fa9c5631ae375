"""A chain on the page: nodes made once and moved with every solve."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from viser import SceneApi

from limbik.core.rotation import Array
from limbik.core.solution import Solution
from limbik.core.solution2d import PlanarSolution
from limbik.plugins.viewer.arcs import arcs
from limbik.plugins.viewer.axes import to_page
from limbik.plugins.viewer.looks import (
    ARCS,
    BLOCKING,
    BONE,
    CONE,
    JOINT,
    LINES,
    REST,
    SHOWN_AT_FIRST,
    TRIAD,
    Colour,
)
from limbik.plugins.viewer.session import Session, Shown
from limbik.plugins.viewer.shapes import along, ball, bone, cone, segments

NOWHERE = np.zeros((1, 2, 3))
STANDS_OUT = 1.15  # size of a joint that blocks; others may be in the same place
MOST_ARCS = 8  # joints of a chain whose ranges are shown unasked


class Limb:
    """Bones and joints of one pose.

    Args:
        scene: Of the page.
        name: Of the node, like `/arm`.
        count: Number of joints.
        size: Thickness of a joint [length].
        colour: Of the bones.
    """

    def __init__(
        self, scene: SceneApi, name: str, count: int, size: float, colour: Colour = BONE
    ) -> None:
        self._size, still = size, np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
        self._drawn: tuple[Array, set[int]] = np.full((count, 3), np.nan), set()
        somewhere = np.zeros((count, 3))
        self._bones = scene.add_batched_meshes_simple(
            f"{name}/bones",
            *bone(),
            still[1:],
            somewhere[1:],
            batched_scales=np.ones((count - 1, 3)),
            batched_colors=colour,
            lod="off",
        )
        self._joints = scene.add_batched_meshes_simple(
            f"{name}/joints",
            *ball(),
            still,
            somewhere,
            batched_scales=np.full((count, 3), size),
            batched_colors=_joint_colours(count, set()),
            lod="off",
        )

    def update(self, positions: Array, blocking: set[int]) -> None:
        """Move it; joints that block are red.

        Args:
            positions: World, (n, 3) [length].
            blocking: Indices of joints.
        """
        if np.array_equal(positions, self._drawn[0]) and blocking == self._drawn[1]:
            return
        self._drawn = positions, blocking
        places = to_page(positions)
        ways = places[1:] - places[:-1]
        lengths = np.linalg.norm(ways, axis=1)
        thick = np.minimum(0.9 * self._size, 0.4 * lengths)
        self._bones.batched_positions = places[:-1].astype(np.float32)
        self._bones.batched_wxyzs = along(ways).astype(np.float32)
        self._bones.batched_scales = np.stack([thick, thick, lengths], 1).astype(np.float32)
        sizes = np.full((len(places), 3), self._size, np.float32)
        sizes[list(blocking)] *= STANDS_OUT
        self._joints.batched_positions = places.astype(np.float32)
        self._joints.batched_scales = sizes
        self._joints.batched_colors = _joint_colours(len(places), blocking)

    @property
    def visible(self) -> bool:
        """Whether it is to be seen."""
        return bool(self._bones.visible)

    @visible.setter
    def visible(self, visible: bool) -> None:
        self._bones.visible = self._joints.visible = visible


class ChainDrawing:
    """A chain with all that can be shown of its solve.

    Args:
        scene: Of the page.
        name: Of the node.
        shown: What it begins with.
        size: Thickness of a joint [length].
        plain: Whether ranges and bend direction wait until they are asked for.
    """

    def __init__(
        self, scene: SceneApi, name: str, shown: Shown, size: float, plain: bool = False
    ) -> None:
        self._size, self._reach = size, shown.solution.chain.length
        self.limb = Limb(scene, name, len(shown.positions), size)
        self.colours = dict(LINES)
        self.lines = {
            line: add_lines(
                scene, f"{name}/{line.replace(' ', '-')}", 2.5, line in SHOWN_AT_FIRST and not plain
            )
            for line in LINES
        }
        self._ranges = add_lines(scene, f"{name}/limits", 1.5)
        self._hands = add_lines(scene, f"{name}/hands", 4.0)
        self._rotor = add_lines(scene, f"{name}/rotor", 3.0)
        self._cone: Any = None
        self._cone_is: tuple[Any, ...] = ()
        self._scene, self._name = scene, name
        self.with_limits = not plain and len(shown.positions) <= MOST_ARCS
        self.update(shown)

    def update(self, shown: Shown) -> None:
        """Draw a solve."""
        solution = shown.solution
        self.limb.update(shown.positions, blocking(solution))
        self._draw_lines(shown)
        self._draw_limits(shown)
        self._draw_rotor(solution)
        self._draw_cone(shown)

    def colour_line(self, line: str, colour: Colour) -> None:
        """Give a line another colour."""
        self.colours[line] = colour
        handle = self.lines[line]
        handle.colors = line_colours(np.tile(colour, (len(handle.points), 1)))

    def _draw_lines(self, shown: Shown) -> None:
        for line, handle in self.lines.items():
            if handle.visible:
                found = self._line(line, shown)
                points = NOWHERE if found is None else to_page(found)
                _set(handle, points, np.tile(self.colours[line], (len(points), 1)))

    def _line(self, line: str, shown: Shown) -> Array | None:
        """Return the segments of a line; None where there is nothing to show."""
        solution, base = shown.solution, shown.positions[0]
        if line == "handle":
            return segments(np.stack([base, shown.positions[-1]]))
        if line == "pole":
            if not isinstance(solution, PlanarSolution):
                return None
            return segments(np.stack([base, solution.pole]))
        if line == "bend direction":
            bend = bend_direction(solution)
            return None if bend is None else self._arrow(*bend)
        part = shown.parts.get(line.removesuffix(" component"))
        return None if part is None else segments(part)

    def _arrow(self, place: Array, way: Array) -> Array:
        """Return the segments of an arrow: a shaft and four barbs."""
        length = 0.3 * self._reach
        tip = place + length * way
        side = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
        side /= np.linalg.norm(side)
        barbs = [side, -side, np.cross(way, side), -np.cross(way, side)]
        ends = [tip + 0.18 * length * (0.5 * barb - way) for barb in barbs]
        return np.array([[place, tip], *([tip, end] for end in ends)])

    def _draw_limits(self, shown: Shown) -> None:
        self._ranges.visible = self._hands.visible = self.with_limits
        if not self.with_limits:
            return
        found = arcs(shown, 3.2 * self._size)
        if not found:
            self._ranges.visible = self._hands.visible = False
            return
        lines = np.concatenate([arc.lines for arc in found])
        shades = [BLOCKING if arc.at_limit else ARCS[arc.axis] for arc in found]
        _set(self._ranges, to_page(lines), np.repeat(shades, [len(a.lines) for a in found], 0))
        _set(self._hands, to_page(np.stack([arc.hand for arc in found])), np.array(shades))

    def _draw_rotor(self, solution: Solution) -> None:
        rotor = solution.rotor if isinstance(solution, PlanarSolution) else None
        self._rotor.visible = rotor is not None
        if rotor is None:
            return
        base = solution.positions[0]
        axes = np.stack([np.stack([base, base + 5.0 * self._size * axis]) for axis in rotor.T])
        _set(self._rotor, to_page(axes), np.array(TRIAD))

    def _draw_cone(self, shown: Shown) -> None:
        """Draw the directions the bend vector may not take, from the base."""
        wanted = shown.setup.scene.settings.forbidden_cone
        chain = shown.solution.chain
        turned = () if wanted is None else (wanted.axis, wanted.half_angle, chain.base_turn)
        place = to_page(shown.positions[0])
        if turned != self._cone_is:
            self._cone_is = turned
            if self._cone is not None:
                self._cone.remove()
                self._cone = None
            if wanted is not None:
                axis = chain.base_rotation[:, "xyz".index(wanted.axis[0])]
                way = to_page(axis if wanted.axis[1] == "+" else -axis)
                vertices, faces = cone(np.radians(wanted.half_angle))
                self._cone = self._scene.add_mesh_simple(
                    f"{self._name}/forbidden",
                    0.35 * self._reach * vertices,
                    faces,
                    color=CONE,
                    opacity=0.25,
                    side="double",
                    wxyz=along(way[None])[0],
                )
        if self._cone is not None:
            self._cone.position = place


class SkeletonDrawing:
    """The bones of a body that no chain moves by itself.

    Args:
        scene: Of the page.
        session: What is shown.
    """

    def __init__(self, scene: SceneApi, session: Session) -> None:
        self._pairs: list[tuple[int, int]] = []
        if session.body is not None:
            limbs = [part.limb.at for part in session.body.parts]
            drawn = {pair for at in limbs for pair in pairwise(at)}
            above = session.body.skeleton.parents
            pairs = [(parent, joint) for joint, parent in enumerate(above) if parent >= 0]
            self._pairs = [pair for pair in pairs if pair not in drawn]
        self._lines = add_lines(scene, "/skeleton", 3.0)

    def update(self, session: Session) -> None:
        """Draw the last solve."""
        if session.whole is not None and self._pairs:
            ends = session.whole.positions[np.array(self._pairs)]
            _set(self._lines, to_page(ends), np.tile(REST, (len(ends), 1)))


def blocking(solution: Solution) -> set[int]:
    """Return the indices of joints that rest on an end of a range."""
    return {joint for joint, _ in solution.resting_axes()}


def bend_direction(solution: Solution) -> tuple[Array, Array] | None:
    """Return where the bend direction is shown, and the direction, world (E-12); None without."""
    way = solution.plane[:, 1] if isinstance(solution, PlanarSolution) else solution.bend_vector
    if not np.linalg.norm(way) > 0.5:
        return None
    return solution.positions[0], way


def _joint_colours(count: int, blocking: set[int]) -> NDArray[np.uint8]:
    shades = [BLOCKING if joint in blocking else JOINT for joint in range(count)]
    return np.array(shades, np.uint8)


def line_colours(colours: ArrayLike) -> NDArray[np.uint8]:
    """Return colours (m, 3) for the two ends of m segments; the page takes them as linear light."""
    linear = 255.0 * (np.asarray(colours) / 255.0) ** 2.2
    return np.repeat(np.round(linear).astype(np.uint8)[:, None], 2, axis=1)


def add_lines(scene: SceneApi, name: str, thickness: float, visible: bool = True) -> Any:
    """Add a node of lines, without any yet.

    It is made with an array of colours: the page shows none of a node that was made with one colour
    and got an array later.
    """
    return scene.add_line_segments(
        name,
        NOWHERE,
        line_colours(np.zeros((1, 3))),
        thickness=thickness,
        thickness_units="screen",
        visible=visible,
    )


def _set(handle: Any, points: Array, colours: Array) -> None:
    """Give a node of lines other points, and a colour for each of them."""
    handle.colors = line_colours(colours)
    handle.points = points.astype(np.float32)
