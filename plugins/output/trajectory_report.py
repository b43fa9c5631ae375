"""The command `trajectory`: plan, solve, write the files, tell what came of it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from limbik.core.errors import SceneError
from limbik.core.posegoals import PoseBatch
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.slots import SOLVER
from limbik.core.solution import Continuity
from limbik.core.solving import scene_solver
from limbik.core.whole import prepare
from limbik.plugins.output.files import write_whole
from limbik.plugins.output.plot import check_plot, form_of
from limbik.plugins.output.servo import read_profile
from limbik.plugins.output.servo_motion import ServoMotion, servo_motion
from limbik.plugins.paths.joints import JointMotion, degrees_to_limits, joint_motion
from limbik.plugins.paths.program import Trajectory
from limbik.plugins.paths.scene_program import scene_trajectory

MOST_LINES = 20  # failures listed; all are in the JSON


@dataclass(frozen=True)
class Files:
    """What to write where.

    Attributes:
        csv, npz, tum, plot: Paths, or None.
        right_handed: TUM poses in the right-handed world with Z up.
        servo: Profile of the servos whose ticks the files get, or None.
    """

    csv: Path | None = None
    npz: Path | None = None
    tum: Path | None = None
    plot: Path | None = None
    right_handed: bool = False
    servo: str | None = None


def run_trajectory(
    scene: Scene,
    registry: Registry,
    files: Files,
    dt: float | None,
    as_json: bool,
    before_solving: Callable[[], None],
) -> bool:
    """Run the command.

    Returns:
        Whether every sample is reached, within limits and speeds.

    Raises:
        SceneError: The scene has no trajectory or it is impossible.
        InputError: The time between samples or the picture's ending is wrong.
        EnvironmentProblem: scipy or matplotlib is missing, or a file cannot be written.
    """
    if files.plot is not None:
        check_plot(files.plot)
    profile = None if files.servo is None else read_profile(files.servo, scene.chain)
    posed = _pose_solver(scene)
    planned = scene_trajectory(scene, turning=posed is not None)
    section = scene.trajectory
    assert section is not None  # scene_trajectory has refused a scene without
    samples = planned.sample(section.dt if dt is None else dt)
    before_solving()
    solver = posed or scene_solver(scene, registry)
    pose = planned.key_points[0].angles
    before = Continuity.from_pose(pose) if posed is not None and pose is not None else None
    motion = joint_motion(samples, solver, degrees_to_limits(section.joint_speeds), before)
    servos = None if profile is None else servo_motion(profile, motion)
    _write(scene, planned, motion, servos, files)
    if as_json:
        from limbik.plugins.output.encoding import to_json
        from limbik.plugins.output.trajectory_files import motion_record

        print(to_json(motion_record(scene, planned, motion, servos)))
    else:
        print("\n".join(_lines(planned, motion, servos)))
    return not motion.failures


def _pose_solver(scene: Scene) -> PoseBatch | None:
    """Return the scene's solver if it solves pose goals, None for limbik's own.

    Raises:
        SceneError: The scene chooses another one.
    """
    if scene.solver is None:
        return None
    batch = prepare(scene.solver, scene.chain, scene.settings)
    if isinstance(batch, PoseBatch):
        return batch
    message = f"a trajectory needs 3d or a solver of pose goals, not '{scene.solver.name}'"
    raise SceneError([scene.document.fault("choice", message, (SOLVER.name,))])


def _write(
    scene: Scene,
    planned: Trajectory,
    motion: JointMotion,
    servos: ServoMotion | None,
    files: Files,
) -> None:
    from limbik.plugins.output import trajectory_files

    if files.csv is not None:
        write_whole(files.csv, trajectory_files.motion_rows(motion, servos))
    if files.npz is not None:
        write_whole(files.npz, trajectory_files.motion_arrays(motion, servos))
    if files.tum is not None:
        write_whole(files.tum, trajectory_files.tum_rows(motion.samples, files.right_handed))
    if files.plot is not None:
        from limbik.plugins.output.trajectory_plot import draw_motion

        write_whole(files.plot, draw_motion(scene, planned, motion, form_of(files.plot)))


def _lines(planned: Trajectory, motion: JointMotion, servos: ServoMotion | None) -> list[str]:
    """The report for people."""
    heads = f"{'start [s]':>9}  {'end [s]':>8}  {'move':>4}  {'shape':7} {'speed':>15}"
    lines = [f"{heads}  limited by"]
    for part in planned.stretches():
        speeds = f"{part.first_speed:.4g} to {part.last_speed:.4g}"
        place = f"{part.start:9.3f}  {part.end:8.3f}  {part.move:4d}"
        lines.append(f"{place}  {part.shape:7} {speeds:>15}  {part.limit}")
    for done in planned.overlaps:
        beside = f"passes the key point at {done.cut:.3g}, speed up to {done.peak:.4g}"
        lines.append(f"overlap after move {done.move}: {done.time:.3f} s, {beside}")
    lines += [f"warning: {text}" for text in planned.warnings]
    shown = motion.failures[:MOST_LINES]
    lines += [f"failed: {failure}" for failure in shown]
    if len(motion.failures) > len(shown):
        lines.append(f"failed: {len(motion.failures) - len(shown)} more, all with --json")
    if servos is not None:
        off = f"off the path by up to {servos.distance.max():.3g} as their ticks are whole"
        lines.append(f"{len(servos.ids)} servos, {off}")
    turned = float(np.degrees(motion.orientation_error.max()))
    aside = "" if motion.is_posed else " (not solved for)"
    lines.append(
        f"{planned.duration:.3f} s, {len(motion.samples)} samples, "
        f"{len(motion.failures)} failures; orientation off by up to {turned:.2g}°{aside}"
    )
    return lines
