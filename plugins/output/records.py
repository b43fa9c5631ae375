"""Results for machines: JSON objects and CSV rows. Angles in degrees, full precision."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from limbik.core.body import BodySolution, bodies_met, chain_solutions
from limbik.core.bodyscene import BodyScene
from limbik.core.errors import Fault, InputError, LimbikError, PluginError
from limbik.core.goals import PLACE
from limbik.core.posegoals import PoseSolution
from limbik.core.scene import Scene
from limbik.core.solution import Solution
from limbik.core.solution2d import PlanarSolution, PlaneFrom
from limbik.core.solving import are_met
from limbik.plugins.output.encoding import csv_text
from limbik.plugins.output.servo import ServoPose


def solve_record(
    scene: Scene,
    solutions: Sequence[Solution],
    stages: bool = False,
    servos: Sequence[ServoPose] = (),
) -> dict[str, Any]:
    """Describe what became of every goal of a scene.

    Args:
        scene: The scene.
        solutions: One solution a goal.
        stages: Whether to put in the pose of every stage; the solutions need their traces then.
        servos: One servo pose a goal, or none.
    """
    goals = [
        _goal_record(name, solution, stages)
        for name, solution in zip(scene.goal_names, solutions, strict=True)
    ]
    for record, pose in zip(goals, servos, strict=False):
        record["servo"] = servo_record(pose)
    return {
        "status": "ok" if are_met(scene, solutions) else "unreached",
        "scene": scene.document.name,
        "joints": list(scene.chain.names),
        "goals": goals,
    }


def body_record(
    scene: BodyScene, found: Sequence[BodySolution], stages: bool = False
) -> dict[str, Any]:
    """Describe what became of every frame of a scene with several chains.

    Args:
        scene: The scene.
        found: One solution a frame.
        stages: As in `solve_record`.
    """
    chains = []
    for part, solutions in zip(scene.parts, chain_solutions(found).values(), strict=True):
        record = solve_record(part.scene, solutions, stages)
        chains.append({"name": part.name, "joints": record["joints"], "goals": record["goals"]})
    return {
        "status": "ok" if bodies_met(scene, found) else "unreached",
        "scene": scene.document.name,
        "skeleton": {"joints": list(scene.skeleton.names), "parents": list(scene.skeleton.parents)},
        "chains": chains,
        "frames": [
            {"name": name, "positions": body.positions.tolist()}
            for name, body in zip(scene.frame_names, found, strict=True)
        ],
    }


def _goal_record(name: str, solution: Solution, stages: bool) -> dict[str, Any]:
    record: dict[str, Any] = {
        "name": name,
        "position": solution.goal.tolist(),
        "status": status_label(solution),
        "reached": bool(solution.reached),
        "remark": solution.remark,
        "distance": float(solution.distance),
        "nearest": None if solution.nearest is None else float(solution.nearest),
        "iterations": int(solution.iterations),
        "angles": np.degrees(solution.angles).tolist(),
        "positions": solution.positions.tolist(),
        "bend_vector": solution.bend_vector.tolist(),
        "at_limits": list(solution.limits_touched()),
    }
    if isinstance(solution, PoseSolution):
        record["goal_rotation"] = solution.goal_rotation.tolist()
        record["rotation_error"] = float(np.degrees(solution.rotation_error))
        record["jumped"] = bool(solution.jumped)
    if isinstance(solution, PlanarSolution):
        record["planar"] = {
            "angles": np.degrees(solution.planar_angles).tolist(),
            "plane": solution.plane.T.tolist(),
            "plane_from": PlaneFrom(int(solution.plane_from)).label,
            "pole": solution.pole.tolist(),
            "rotor": None if solution.rotor is None else solution.rotor.T.tolist(),
            "goal_axes": None
            if solution.goal_rotation is None
            else solution.goal_rotation.T.tolist(),
        }
    if stages and solution.trace is not None:
        record["stages"] = [
            {
                "name": stage.name,
                "angles": np.degrees(stage.angles).tolist(),
                "positions": stage.positions.tolist(),
            }
            for stage in solution.trace
        ]
    return record


def check_record(scenes: Sequence[Scene | BodyScene]) -> dict[str, Any]:
    """Describe scenes that were found good."""
    return {
        "status": "ok",
        "scenes": [
            _counts(s) if isinstance(s, Scene) else {**_body_counts(s), "chains": _parts(s)}
            for s in scenes
        ],
    }


def _counts(scene: Scene) -> dict[str, Any]:
    joints = list(scene.chain.names)
    return {"file": scene.document.name, "joints": joints, "goals": len(scene.goals)}


def _body_counts(scene: BodyScene) -> dict[str, Any]:
    joints = list(scene.skeleton.names)
    return {"file": scene.document.name, "joints": joints, "frames": len(scene.frame_names)}


def _parts(scene: BodyScene) -> list[dict[str, Any]]:
    return [{"name": p.name, "joints": list(p.scene.chain.names)} for p in scene.parts]


def failure_record(error: BaseException, status: str) -> dict[str, Any]:
    """Describe a failure; the faults of an `InputError` keep their places."""
    if isinstance(error, InputError):
        return {"status": status, "errors": [_fault_record(fault) for fault in error.faults]}
    fault = {"code": status, "message": str(error) or type(error).__name__}
    if isinstance(error, PluginError):
        fault |= {"plugin": error.plugin, "strategy": error.strategy, "slot": error.slot}
    elif not isinstance(error, LimbikError):
        fault["message"] = f"{type(error).__name__}: {error}"
    return {"status": status, "errors": [fault]}


def _fault_record(fault: Fault) -> dict[str, Any]:
    return {
        "code": fault.code,
        "message": fault.message,
        "key": fault.key,
        "file": fault.file,
        "line": fault.line,
        "column": fault.column,
        "hint": fault.hint,
    }


def solve_rows(scene: Scene, solutions: Sequence[Solution]) -> str:
    """Write a CSV table, one line a goal; its columns name, x, y, z make it a goal file again."""
    head = ["name", *PLACE, "status", "distance", "iterations", *scene.chain.axis_names]
    rows = []
    for name, solution in zip(scene.goal_names, solutions, strict=True):
        ending = [status_label(solution), float(solution.distance), int(solution.iterations)]
        angles = np.degrees(solution.angles).ravel().tolist()
        rows.append([name, *solution.goal.tolist(), *ending, *angles])
    return csv_text(head, rows)


def status_label(solution: Solution) -> str:
    """Give the status of one solution as a word."""
    return str(getattr(solution.status, "label", solution.status))


def outcome(solution: Solution) -> str:
    """Give the status for people, with what else they should know."""
    label = status_label(solution)
    return f"{label} ({solution.remark})" if solution.remark else label


def servo_record(pose: ServoPose) -> dict[str, Any]:
    """Describe servo commands for machines, angles in degrees."""
    return {
        "commands": [
            {
                "joint": command.joint,
                "axis": command.axis,
                "id": command.id,
                "angle": float(np.degrees(command.angle)),
                "tick": command.tick,
                "achieved": float(np.degrees(command.achieved)),
            }
            for command in pose.commands
        ],
        "achieved": np.degrees(pose.angles).tolist(),
        "position": pose.position.tolist(),
        "distance": pose.distance,
    }
