"""The servos a user asks for, and their ticks in the files of `limbik bake`."""

import numpy as np

from limbik.core.bodyscene import BodyScene
from limbik.core.errors import Fault, InputError
from limbik.core.formats import Bake, Output, Values
from limbik.core.scene import Scene
from limbik.plugins.output.servo import Profile, read_profile
from limbik.plugins.output.servo_motion import servo_path


def servo_profile(
    source: str | None,
    scene: Scene | BodyScene,
    writer: Output | None = None,
    mirrored: bool = False,
) -> Profile | None:
    """Read the profile a user names; None for none.

    Args:
        source: As for `read_profile`.
        scene: What the servos move.
        writer: Of the file the ticks go into, if any.
        mirrored: Whether left and right are exchanged in that file.

    Raises:
        InputError: It is at fault, or what is baked has no place for ticks.
    """
    if source is None:
        return None
    faults = []
    if writer is not None and not writer.servos:
        message = f"{writer.name} files hold no servo ticks"
        faults.append(Fault("ending", message, "--servo", hint="write a .csv, .json or .npz"))
    if mirrored:
        faults.append(Fault("choice", "the servos are those of the scene's side", "--mirrored"))
    if isinstance(scene, BodyScene):
        faults.append(Fault("chains", "needs a scene with one chain", "--servo"))
    if isinstance(scene, BodyScene) or faults:
        raise InputError(faults)
    return read_profile(source, scene.chain)


def servo_values(profile: Profile, bake: Bake) -> Values:
    """Return what the servos are told in every frame.

    Raises:
        InputError: An angle is outside its servo's range.
    """
    solution = bake.solution
    times = np.arange(len(solution.goal), dtype=np.float64) * bake.frame_time
    found = servo_path(profile, solution.chain, solution.angles, solution.goal, times)
    return Values(tuple(found.titles), "ticks", found.ticks)
