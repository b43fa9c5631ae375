"""A trajectory and its joint motion as CSV, JSON, NPZ and TUM poses (J-08). Angles in degrees."""

from typing import Any

import numpy as np

from limbik.core.chain import AXES, Chain
from limbik.core.frames import Z_UP
from limbik.core.rotation import Array, matrix_to_quaternion
from limbik.core.scene import Scene
from limbik.plugins.output.encoding import csv_text, npz_bytes
from limbik.plugins.output.servo_motion import ServoMotion
from limbik.plugins.paths.joints import JointMotion
from limbik.plugins.paths.program import Trajectory
from limbik.plugins.paths.quaternions import continuous
from limbik.plugins.paths.samples import Samples

POSE = ("x", "y", "z", "qw", "qx", "qy", "qz")
MOTION = ("speed", "distance", "reached")


def axis_names(chain: Chain) -> list[str]:
    """Return names such as `elbow pitch` of the moving axes."""
    return [f"{chain.names[joint]} {AXES[axis]}" for joint, axis in chain.moving_axes]


def axis_angles(motion: JointMotion) -> Array:
    """Return the moving axes' angles in degrees, (m, k)."""
    joints, axes = np.array(motion.solution.chain.moving_axes, int).reshape(-1, 2).T
    return np.degrees(motion.angles[:, joints, axes])


def motion_rows(motion: JointMotion, servos: ServoMotion | None = None) -> str:
    """Write a CSV table, one line a sample: time, pose, speed, distance left, angles [deg].

    With servos their ticks follow.
    """
    samples, chain = motion.samples, motion.solution.chain
    titles = [] if servos is None else servos.titles
    head = ["time", *POSE, *MOTION, *axis_names(chain), *titles]
    reached = np.asarray(motion.solution.reached, int).tolist()
    ticks = [[]] * len(samples) if servos is None else servos.ticks.tolist()
    table = zip(_table(motion, samples).tolist(), reached, ticks, strict=True)
    return csv_text(head, ([*row[:10], done, *row[10:], *told] for row, done, told in table))


def _table(motion: JointMotion, samples: Samples) -> Array:
    return np.column_stack(
        [
            samples.times,
            samples.positions,
            samples.quaternions,
            samples.speeds,
            np.asarray(motion.solution.distance),
            axis_angles(motion),
        ]
    )


def motion_arrays(motion: JointMotion, servos: ServoMotion | None = None) -> bytes:
    """Write a compressed NPZ file; angles in radians like all arrays of limbik."""
    samples, solution = motion.samples, motion.solution
    arrays: dict[str, Any] = {
        "times": samples.times,
        "positions": samples.positions,
        "quaternions": samples.quaternions,
        "velocities": samples.velocities,
        "speeds": samples.speeds,
        "angles": motion.angles,
        "joint_speeds": motion.speeds,
        "distance": np.asarray(solution.distance),
        "reached": np.asarray(solution.reached),
        "orientation_error": motion.orientation_error,
        "joints": np.array(solution.chain.names),
    }
    if servos is not None:
        arrays |= {"servo_ids": servos.ids, "servo_ticks": servos.ticks}
    return npz_bytes(arrays)


def tum_rows(samples: Samples, right_handed: bool = False) -> str:
    """Write TUM poses, a line each: time x y z qx qy qz qw.

    Args:
        samples: The poses.
        right_handed: Convert them to the right-handed world with Z up.
    """
    places, turned = samples.positions, samples.quaternions
    if right_handed:
        places = Z_UP.points(places)
        turned = continuous(matrix_to_quaternion(Z_UP.rotations(samples.rotations)))
    table = np.column_stack([samples.times, places, turned[:, [1, 2, 3, 0]]])
    head = "# timestamp x y z qx qy qz qw\n"
    return head + "".join(" ".join(map(repr, row)) + "\n" for row in table.tolist())


def motion_record(
    scene: Scene, trajectory: Trajectory, motion: JointMotion, servos: ServoMotion | None = None
) -> dict[str, Any]:
    """Describe a motion: duration, what limits it, overlaps, failures, and the samples."""
    record: dict[str, Any] = {
        "status": "failures" if motion.failures else "ok",
        "scene": scene.document.name,
        "duration": trajectory.duration,
        "samples": len(motion.samples),
        "warnings": list(trajectory.warnings),
        "stretches": [stretch._asdict() for stretch in trajectory.stretches()],
        "overlaps": [
            {
                "move": done.move,
                "time": done.time,
                "ramp": done.ramp,
                "cut": done.cut,
                "peak": done.peak,
                "overrun": done.overrun,
            }
            for done in trajectory.overlaps
        ],
        "failures": [failure_record(failure) for failure in motion.failures],
        "orientation_solved": motion.is_posed,
        "largest_orientation_error": float(np.degrees(motion.orientation_error.max())),
    }
    names = ["time", *POSE, "speed", "distance", *axis_names(scene.chain)]
    columns = _table(motion, motion.samples).T.tolist()
    record["columns"] = dict(zip(names, columns, strict=True))
    record["columns"]["reached"] = np.asarray(motion.solution.reached, bool).tolist()
    if servos is not None:
        record["columns"] |= dict(zip(servos.titles, servos.ticks.T.tolist(), strict=True))
        record["largest_servo_distance"] = float(servos.distance.max())
    return record


def failure_record(failure: Any) -> dict[str, Any]:
    """Describe one failure, with its sentence."""
    return {
        "kind": failure.kind,
        "joint": failure.joint,
        "first": failure.first,
        "last": failure.last,
        "start": failure.start,
        "end": failure.end,
        "position": list(failure.position),
        "message": str(failure),
    }
