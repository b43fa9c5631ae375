"""Left and right exchanged: names, options, and the solution of a mirrored problem (M-14).

A mirrored chain with mirrored goals has the mirrored poses for its answers, so a solution is
mirrored instead of solved again; whatever options and strategies it was solved with, they were
the same ones, mirrored.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from limbik.core.binding import Bound
from limbik.core.chain import Chain
from limbik.core.frames import Y_UP, mirror_hpb
from limbik.core.posegoals import PoseSolution
from limbik.core.settings import Settings
from limbik.core.solution import Solution
from limbik.core.solution2d import PlanarSolution
from limbik.core.strategy import mirrored

_ACROSS: Final = {"x+": "x-", "x-": "x+"}
_WORDS: Final = (("Left", "Right"), ("left", "right"), ("LEFT", "RIGHT"))
_LETTERS: Final = (("L", "R"), ("l", "r"))


def mirrored_solution(solution: Solution) -> Solution:
    """Return a solution mirrored in the world's YZ plane, joints named for their new side.

    Args:
        solution: With a leading goal axis or without; its trace and continuity are dropped.
    """
    chain = solution.chain.mirrored()
    names = side_swapped(chain.names)
    joints = [replace(joint, name=name) for joint, name in zip(chain.joints, names, strict=True)]
    bend_angle = -np.asarray(solution.bend_angle)
    mirrored = replace(
        solution,
        chain=Chain(joints, chain.base_position, chain.base_turn),
        goal=Y_UP.points(solution.goal),
        angles=mirror_hpb(solution.angles),
        positions=Y_UP.points(solution.positions),
        rotations=Y_UP.rotations(solution.rotations),
        bend_vector=Y_UP.points(solution.bend_vector),
        bend_angle=bend_angle if bend_angle.ndim else float(bend_angle),
        continuity=None,
        trace=None,
    )
    if isinstance(mirrored, PoseSolution):
        return replace(mirrored, goal_rotation=Y_UP.rotations(mirrored.goal_rotation))
    return _mirrored_plane(mirrored) if isinstance(mirrored, PlanarSolution) else mirrored


def _mirrored_plane(solution: PlanarSolution) -> PlanarSolution:
    """Mirror what only the 2D solver gives; planar angles count toward the pole and stay."""
    line, bend = (Y_UP.points(solution.plane[..., axis]) for axis in (0, 1))
    rotor, goal = solution.rotor, solution.goal_rotation
    return replace(
        solution,
        plane=np.stack([line, bend, np.cross(line, bend)], -1),
        pole=Y_UP.points(solution.pole),
        rotor=None if rotor is None else Y_UP.rotations(rotor),
        goal_rotation=None if goal is None else Y_UP.rotations(goal),
    )


def mirrored_settings(settings: Settings, strategies: Mapping[str, Bound]) -> Settings:
    """Return the options of a mirrored chain, with which it takes the mirrored poses.

    Args:
        settings: The options.
        strategies: What they choose, by slot; marked `Sided` is what they change in the mirror.
    """
    given = settings.model_dump(exclude_unset=True)
    changes: dict[str, Any] = {}
    for slot, bound in strategies.items():
        image = mirrored(bound.params)
        if image != bound.params._asdict():
            changes[slot] = {"use": bound.name, **image}
    if settings.twist:
        changes["twist"] = -settings.twist
    if settings.reference_axis in _ACROSS:
        changes["reference_axis"] = _ACROSS[settings.reference_axis]
    cone = settings.forbidden_cone
    if cone is not None and cone.axis in _ACROSS:
        changes["forbidden_cone"] = {**cone.model_dump(), "axis": _ACROSS[cone.axis]}
    if settings.choose is not None and settings.choose.pose is not None:
        pose = {name: (-h, p, -b) for name, (h, p, b) in settings.choose.pose.items()}
        changes["choose"] = {**settings.choose.model_dump(), "pose": pose}
    return Settings(**{**given, **changes})


def side_swapped(names: Sequence[str]) -> list[str]:
    """Exchange left and right in names, as in LeftFoot, foot.L, l_foot, LThumb.

    All stay as they are if two would become the same.
    """
    swapped = [_other_side(name) for name in names]
    return swapped if len(set(swapped)) == len(set(names)) else list(names)


def _other_side(name: str) -> str:
    for left, right in _WORDS:
        if left in name or right in name:
            return _exchanged(f"{left}|{right}", name, left, right)
    for left, right in _LETTERS:
        letter = f"(?:{left}|{right})"
        alone = rf"(?<![A-Za-z0-9]){letter}(?![A-Za-z0-9])"
        first_of_words = rf"(?<![A-Za-z0-9]){letter}(?=[A-Z][a-z])"
        between = rf"(?<=_){letter}(?=_|$)|(?<![A-Za-z0-9]){letter}(?=_)"
        changed = _exchanged(f"{alone}|{first_of_words}|{between}", name, left, right)
        if changed != name:
            return changed
    return name


def _exchanged(pattern: str, name: str, left: str, right: str) -> str:
    other = {left: right, right: left}
    return re.sub(pattern, lambda found: other[found.group()], name)
