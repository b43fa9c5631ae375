"""A motion as servos play it: the ticks of every sample (J-08)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import AXES, Chain
from limbik.core.errors import Fault, InputError, shortlist
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.plugins.output.servo import Profile, out_of_range
from limbik.plugins.paths.joints import JointMotion


@dataclass(frozen=True, eq=False)
class ServoMotion:
    """What k servos are told along a path.

    Attributes:
        names: Joint and axis of each servo, such as `elbow pitch`.
        ids: Their numbers, (k,).
        ticks: Goal positions, (m, k).
        distance: From the end, with the angles of whole ticks, to the path, (m,) [length].
    """

    names: tuple[str, ...]
    ids: NDArray[np.int64]
    ticks: NDArray[np.int64]
    distance: Array

    @property
    def titles(self) -> list[str]:
        """Names of the ticks' columns, such as `servo 3 elbow pitch`."""
        pairs = zip(self.ids.tolist(), self.names, strict=True)
        return [f"servo {number} {name}" for number, name in pairs]


def servo_motion(profile: Profile, motion: JointMotion) -> ServoMotion:
    """Turn a joint motion into servo commands; as `servo_path`."""
    samples, chain = motion.samples, motion.solution.chain
    return servo_path(profile, chain, motion.angles, samples.positions, samples.times)


def servo_path(
    profile: Profile, chain: Chain, angles: Array, places: Array, times: Array
) -> ServoMotion:
    """Turn the angles along a path into servo commands.

    Args:
        profile: Which servo turns what.
        chain: n joints.
        angles: HPB, (m, n, 3) [rad].
        places: Where the end shall be, (m, 3) [length].
        times: (m,) [s].

    Raises:
        InputError: An angle is outside its servo's range; every such joint is named with the
            first time.
    """
    held = angles.copy()
    names, columns, faults = [], [], list[Fault]()
    for (joint, axis), servo in profile.servos.items():
        name = f"{chain.names[joint]} {AXES[axis]}"
        turned = angles[:, joint, axis]
        ticks = np.array([servo.tick(angle) for angle in turned.tolist()], np.int64)
        wrong = np.flatnonzero([not servo.accepts(tick) for tick in ticks.tolist()])
        if len(wrong):
            first = wrong[0]
            when = f"{times[first]:.4g} s: "
            faults.append(out_of_range(name, float(turned[first]), servo, when))
        held[:, joint, axis] = [servo.angle(tick) for tick in ticks.tolist()]
        names.append(name)
        columns.append(ticks)
    if faults:
        raise InputError(shortlist(faults))
    ids = np.array([servo.id for servo in profile.servos.values()], np.int64)
    positions, _ = forward_kinematics(chain, held)
    distance = np.linalg.norm(positions[:, -1] - places, axis=1)
    return ServoMotion(tuple(names), ids, np.stack(columns, axis=-1), distance)
