"""A scene's `trajectory` section becomes a planned `Trajectory`; faults point at their line."""

import re
from math import radians
from typing import Any

import numpy as np

from limbik.core.errors import Fault, InputError, SceneError
from limbik.core.rotation import hpb_to_matrix
from limbik.core.scene import Scene
from limbik.core.trajectorymodel import LimitsModel, PointModel, StepModel, TrajectoryModel
from limbik.core.wording import near_match
from limbik.core.yamlfile import KeyPath
from limbik.plugins.paths.keypoint import KeyPoint
from limbik.plugins.paths.moves import (
    Arc,
    ArcAbout,
    Blend,
    Junction,
    Limits,
    Line,
    Move,
    Overlap,
    Spline,
    Stop,
    Turn,
)
from limbik.plugins.paths.program import Trajectory, plan

ROOT = "trajectory"
_ACCELERATIONS = {"acceleration", "deceleration"}
_ANGLES = ("rotation_speed", "rotation_acceleration")


def scene_trajectory(scene: Scene, turning: bool = False) -> Trajectory:
    """Plan the trajectory of a scene.

    Args:
        scene: The scene.
        turning: Whether the end will be turned, so that every point needs an orientation.

    Raises:
        SceneError: The scene has none, a point is unknown or lacks something, or a move is
            impossible.
        EnvironmentProblem: scipy is not installed.
    """
    model = scene.trajectory
    if model is None:
        raise SceneError(scene.document.fault("missing-key", "key 'trajectory' is missing"))
    if model.limits.speed is None:
        message = "the trajectory's limits need a speed"
        raise SceneError(scene.document.fault("missing-key", message, (ROOT, "limits")))
    reader = _Reader(scene, model, turning)
    start = reader.point(model.start, (ROOT, "start"))
    steps = [reader.step(step, number) for number, step in enumerate(model.program)]
    try:
        return plan(start, steps, _limits(model.limits, None), model.order)
    except InputError as error:
        raise SceneError([reader.placed(fault) for fault in error.faults]) from error


def _has_orientation(given: PointModel) -> bool:
    return any((given.matrix, given.quaternion, given.euler, given.joints))


class _Reader:
    """Looks names up and builds moves."""

    def __init__(self, scene: Scene, model: TrajectoryModel, turning: bool) -> None:
        self.scene, self.model, self.turning = scene, model, turning
        self.known: dict[str, KeyPoint] = {}

    def point(self, name: str, path: KeyPath) -> KeyPoint:
        """Return the key point of a name."""
        if name not in self.known:
            given = self.model.points.get(name)
            if given is None and name not in self.scene.goal_names:
                names = [*self.model.points, *self.scene.goal_names]
                hint = near_match(name, names) or f"known: {', '.join(names[:12])}"
                message = f"no point or goal is called '{name}'"
                raise SceneError(
                    self.scene.document.fault("unknown-point", message, path, hint=hint)
                )
            given = given or PointModel()
            if self.turning and not self._is_oriented(name, given):
                message = f"'{name}' needs an orientation: the scene's solver turns the end to it"
                raise SceneError(self.scene.document.fault("missing-key", message, path))
            self.known[name] = self._made(name, given)
        return self.known[name]

    def _made(self, name: str, given: PointModel) -> KeyPoint:
        path: KeyPath = (ROOT, "points", name)
        try:
            if given.joints is not None:
                return KeyPoint.from_joints(self.scene.chain, self._angles(given, path), name)
            return self._given(name, given, path)
        except SceneError:
            raise
        except InputError as error:
            faults = [self.scene.document.fault(f.code, f.message, path) for f in error.faults]
            raise SceneError(faults) from error

    def _given(self, name: str, given: PointModel, path: KeyPath) -> KeyPoint:
        """Make a key point of numbers in the trajectory's frame; goals are limbik's own."""
        turned = self.model.frame == "right-handed"
        if given.matrix is not None:
            point = KeyPoint.from_matrix(given.matrix, name)
            return point.to_left_handed() if turned else point
        place = given.position if given.position is not None else (0.0, 0.0, 0.0)
        if given.euler is not None:
            angles = np.radians(given.euler)
            point = KeyPoint.from_euler(place, angles, given.convention or "", name)
        else:
            quaternion = given.quaternion or (1.0, 0.0, 0.0, 0.0)
            point = KeyPoint.from_quaternion(place, quaternion, name)
        point = point.to_left_handed() if turned else point
        if given.position is not None:
            return point
        if name not in self.scene.goal_names:
            message = f"it needs a position: no goal is called '{name}'"
            raise SceneError(self.scene.document.fault("missing-key", message, path))
        row = self.scene.goal_names.index(name)
        goal, turns = self.scene.goals[row], self.scene.goal_turns
        if turns is not None and not _has_orientation(given) and self._is_oriented(name, given):
            return KeyPoint.from_rotation(goal, hpb_to_matrix(turns[row]), name)
        return KeyPoint(goal, point.quaternion, name)

    def _is_oriented(self, name: str, given: PointModel) -> bool:
        """Whether a point has an orientation of its own or its goal's."""
        names, turns = self.scene.goal_names, self.scene.goal_turns
        if _has_orientation(given) or turns is None or name not in names:
            return _has_orientation(given)
        return given.position is None and not np.isnan(turns[names.index(name)]).any()

    def _angles(self, given: PointModel, path: KeyPath) -> Any:
        names, angles = self.scene.chain.names, np.array(self.scene.chain.rest)
        for joint, turn in (given.joints or {}).items():
            if joint not in names:
                hint = near_match(joint, list(names)) or f"known: {', '.join(names[:12])}"
                where = (*path, "joints", joint)
                message = f"no joint is called '{joint}'"
                raise SceneError(
                    self.scene.document.fault("unknown-joint", message, where, hint=hint)
                )
            angles[names.index(joint)] = np.radians(turn)
        return angles

    def step(self, step: StepModel, number: int) -> Move | Junction:
        """Make a move or a junction of a step."""
        kind, model = step.chosen
        path: KeyPath = (ROOT, "program", number, kind)
        if kind in ("stop", "blend", "overlap"):
            made: type[Any] = {"stop": Stop, "blend": Blend, "overlap": Overlap}[kind]
            junction: Junction = made(**model.model_dump())
            return junction
        limits = _limits(self.model.limits, model.limits)
        plain = model.model_dump(exclude={"limits", "to", "via", "through"})
        if kind == "arc_about":
            return ArcAbout(**{**plain, "angle": radians(plain["angle"])}, limits=limits)
        if kind == "spline":
            through = [
                self.point(name, (*path, "through", k)) for k, name in enumerate(model.through)
            ]
            return Spline(through, limits, **plain)
        to = self.point(model.to, (*path, "to"))
        if kind == "arc":
            return Arc(self.point(model.via, (*path, "via")), to, limits, **plain)
        return Turn(to, limits) if kind == "turn" else Line(to, limits)

    def placed(self, fault: Fault) -> Fault:
        """Point a fault of the planner at the step it names."""
        found = re.match(r"(?:(corner|overlap) between )?moves? (\d+)", fault.key)
        path: KeyPath = (ROOT, "program")
        if found:
            kinds = [step.chosen[0] for step in self.model.program]
            moves = [k for k, kind in enumerate(kinds) if kind not in ("stop", "blend", "overlap")]
            place = moves[int(found[2]) - 1] + bool(found[1])
            path = (*path, place, kinds[place])
        return self.scene.document.fault(fault.code, fault.message, path)


def _limits(program: LimitsModel, own: LimitsModel | None) -> Limits:
    """Lay a move's limits over the program's; ramp times and accelerations exclude each other."""
    given = program.model_dump(exclude_none=True)
    over = {} if own is None else own.model_dump(exclude_none=True)
    if "ramp_times" in over:
        given = {key: value for key, value in given.items() if key not in _ACCELERATIONS}
    if "acceleration" in over:
        given.pop("ramp_times", None)
    given |= over
    for name in _ANGLES:
        if name in given:
            given[name] = radians(given[name])
    return Limits(**given)
