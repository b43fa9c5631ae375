"""Read the joints of a URDF robot: strictly, on the standard library, never following a mesh.

Only kinematics is read: names, parents, origins, axes, limits. Numbers stay as the file has them,
right-handed, metres and radians.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from limbik.core.errors import Fault, InputError, shortlist
from limbik.core.rotation import Array
from limbik.core.scenemodel import FARTHEST
from limbik.core.yamlscalars import looks_like_number
from limbik.plugins.formats.markup import MOST_BYTES, Element, read_bounded, read_xml

TYPES: Final = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
_ENDLESS: Final = 1e300  # a limit may be absurdly wide; a number without end is none
_UNEXPANDED = re.compile(r"\$\(|\$\{")


@dataclass(frozen=True, eq=False)
class UrdfJoint:
    """A joint as the file has it.

    Attributes:
        name: Its name.
        kind: One of `TYPES`.
        parent: Name of the link it is fastened to.
        child: Name of the link it carries.
        place: Origin in the parent link's frame, (3,) [m].
        turn: Roll, pitch, yaw of the origin, (3,) [rad].
        axis: Unit axis in the joint's frame, (3,).
        limit: Lower and upper limit [rad or m]; None where it has none.
        mimics: Name of the joint whose value it copies, or empty.
        element: Where it stands in the file.
    """

    name: str
    kind: str
    parent: str
    child: str
    place: Array
    turn: Array
    axis: Array
    limit: tuple[float, float] | None
    mimics: str
    element: Element

    @property
    def is_hinge(self) -> bool:
        """Whether it turns about one axis."""
        return self.kind in ("revolute", "continuous")


@dataclass(frozen=True, eq=False)
class Robot:
    """The kinematics of a robot.

    Attributes:
        name: Its name; that of the file if the file gives none.
        links: Names of the links, in the order of the file.
        joints: By the name of the link they carry.
        notes: What was assumed.
    """

    name: str
    links: tuple[str, ...]
    joints: dict[str, UrdfJoint]
    notes: tuple[str, ...]

    @property
    def roots(self) -> tuple[str, ...]:
        """Links that no joint carries."""
        return tuple(link for link in self.links if link not in self.joints)

    def up_from(self, link: str) -> list[str]:
        """Give a link and all it hangs from, upward; a robot has no loops."""
        way = [link]
        while way[-1] in self.joints:
            way.append(self.joints[way[-1]].parent)
        return way


def read_urdf(path: Path) -> Robot:
    """Read a robot.

    Raises:
        InputError: With every fault that could be found, each with file, line and column.
    """
    content = read_bounded(path, MOST_BYTES)
    root = read_xml(content, str(path))
    faults: list[Fault] = []
    if root.tag != "robot":
        message = f"a URDF file starts with <robot>, this one with <{root.tag[:40]}>"
        raise InputError(root.fault("urdf", message))
    _refuse_xacro(root)
    notes = []
    name = root.attributes.get("name", "").strip()
    if not name:
        notes.append(f"the robot has no name; it is called '{path.stem}' after its file")
    links = _links(root, faults)
    joints = list(_joints(root, links, faults, notes))
    carried = _carried(joints, faults)
    _refuse_loops(carried, faults)
    if not links and not faults:
        faults.append(root.fault("urdf", "the robot has no links"))
    if faults:
        raise InputError(shortlist(faults))
    return Robot(name or path.stem, tuple(links), carried, tuple(notes))


def _refuse_xacro(root: Element) -> None:
    for element in root.walk():
        unexpanded = element.tag.startswith("xacro:")
        if element.tag in ("joint", "origin", "axis", "limit", "parent", "child", "link"):
            unexpanded |= any(map(_UNEXPANDED.search, element.attributes.values()))
        if unexpanded:
            message = "this is xacro, not yet URDF: expand it first"
            hint = "xacro in.xacro > out.urdf"
            raise InputError(element.fault("xacro", message, hint=hint))


def _links(root: Element, faults: list[Fault]) -> dict[str, Element]:
    links: dict[str, Element] = {}
    for element in root.children:
        if element.tag != "link":
            continue
        name = _name(element, faults)
        if name in links:
            message = f"the link '{name}' is given twice, first at line {links[name].line}"
            faults.append(element.fault("duplicate-name", message, "name"))
        links.setdefault(name, element)
    return links


def _name(element: Element, faults: list[Fault]) -> str:
    name = element.attributes.get("name", "").strip()
    if not name:
        faults.append(element.fault("missing-key", f"this <{element.tag}> has no name"))
    return name


def _joints(
    root: Element, links: dict[str, Element], faults: list[Fault], notes: list[str]
) -> Iterator[UrdfJoint]:
    seen: dict[str, Element] = {}
    for element in root.children:
        if element.tag != "joint":
            continue
        name = _name(element, faults)
        if name in seen:
            message = f"the joint '{name}' is given twice, first at line {seen[name].line}"
            faults.append(element.fault("duplicate-name", message, "name"))
        seen.setdefault(name, element)
        before = len(faults)
        joint = _Joint(element, name, faults.append).read(links)
        if len(faults) == before:
            if joint.kind == "revolute" and joint.limit == (0.0, 0.0):
                notes.append(f"joint '{name}': its limits are 0 and 0, so it is locked")
            yield joint


class _Joint:
    """Reads one joint and says what is wrong with it."""

    def __init__(self, element: Element, name: str, say: Callable[[Fault], None]) -> None:
        self._element, self._name, self._say = element, name, say

    def read(self, links: dict[str, Element]) -> UrdfJoint:
        element = self._element
        kind = element.attributes.get("type", "")
        if kind not in TYPES:
            known = ", ".join(TYPES[:-1])
            message = f"joint '{self._name}': the type must be one of {known}, not '{kind[:40]}'"
            self._say(element.fault("choice", message, "type"))
        origin = element.find("origin")
        mimic = element.find("mimic")
        return UrdfJoint(
            self._name,
            kind,
            self._link("parent", links),
            self._link("child", links),
            self._three(origin, "xyz", (0.0, 0.0, 0.0)),
            self._three(origin, "rpy", (0.0, 0.0, 0.0)),
            self._axis(kind),
            self._limit(kind),
            mimic.attributes.get("joint", "?") if mimic else "",
            element,
        )

    def _link(self, which: str, links: dict[str, Element]) -> str:
        element = self._element.find(which)
        name = element.attributes.get("link", "").strip() if element else ""
        if element is None or not name:
            message = f"joint '{self._name}' has no {which} link"
            self._say((element or self._element).fault("missing-key", message))
        elif name not in links:
            message = f"joint '{self._name}': there is no link '{name}'"
            self._say(element.fault("unknown-link", message, "link"))
        return name

    def _three(self, element: Element | None, attribute: str, default: tuple[float, ...]) -> Array:
        text = element.attributes.get(attribute) if element else None
        if element is None or text is None:
            return np.array(default)
        parts = text.split()
        if len(parts) != 3:
            message = f"joint '{self._name}': {attribute} must be three numbers, not {len(parts)}"
            self._say(element.fault("length", message, attribute))
            return np.array(default)
        numbers = [self._number(element, attribute, part) for part in parts]
        return np.array(default if None in numbers else numbers, np.float64)

    def _number(
        self, element: Element, attribute: str, text: str, most: float = FARTHEST
    ) -> float | None:
        """Read a number; a fault is said and None returned."""
        if not looks_like_number(text):
            message = f"joint '{self._name}': {attribute}: not a number: '{text[:40]}'"
            self._say(element.fault("number", message, attribute))
            return None
        value = float(text)
        if abs(value) > most:
            message = f"joint '{self._name}': {attribute}: must be at most {most:g} in size"
            self._say(element.fault("range", message, attribute))
            return None
        return value

    def _axis(self, kind: str) -> Array:
        element = self._element.find("axis")
        axis = self._three(element, "xyz", (1.0, 0.0, 0.0))
        length = float(np.linalg.norm(axis))
        if length > 1e-9:
            return axis / length
        if element is not None and kind in ("revolute", "continuous", "prismatic"):
            message = f"joint '{self._name}': the axis has no length"
            self._say(element.fault("axis", message, "xyz"))
        return np.array([1.0, 0.0, 0.0])

    def _limit(self, kind: str) -> tuple[float, float] | None:
        if kind not in ("revolute", "prismatic"):
            return None
        element = self._element.find("limit")
        if element is None:
            message = f"joint '{self._name}' is {kind} and has no <limit>"
            hint = "a joint that turns without end is continuous" if kind == "revolute" else ""
            self._say(self._element.fault("missing-key", message, hint=hint))
            return None
        low, high = (
            self._number(element, side, element.attributes.get(side, "0").strip(), _ENDLESS)
            for side in ("lower", "upper")
        )
        if low is None or high is None:
            return None
        if low > high:
            message = f"joint '{self._name}': the lower limit {low:g} is above the upper {high:g}"
            self._say(element.fault("range", message, "lower"))
        return low, high


def _carried(joints: list[UrdfJoint], faults: list[Fault]) -> dict[str, UrdfJoint]:
    carried: dict[str, UrdfJoint] = {}
    for joint in joints:
        if joint.child in carried:
            other = carried[joint.child].name
            message = (
                f"the link '{joint.child}' hangs from two joints, '{other}' and '{joint.name}'"
            )
            faults.append(joint.element.fault("loop", message))
        carried.setdefault(joint.child, joint)
    return carried


def _refuse_loops(carried: dict[str, UrdfJoint], faults: list[Fault]) -> None:
    sound: set[str] = set()
    for start in carried:
        way: dict[str, None] = {}
        here = start
        while here in carried and here not in sound:
            if here in way:
                message = f"the link '{here}' hangs from itself"
                faults.append(carried[here].element.fault("loop", message))
                break
            way[here] = None
            here = carried[here].parent
        sound.update(way)
