"""How evenly a limb of many bones curves."""

import numpy as np

from limbik.core.rotation import Array
from limbik.plugins.judging.run import NotJudged, Run

BENT = np.radians(5.0)  # less total bend says nothing about its share [rad]


def _bones(run: Run) -> Array:
    """Bones of a length from the bend root on, (m, bones, 3) [length]."""
    root = run.settings.bend_reference - 1
    bones = np.diff(run.solution.positions[:, root:], axis=1)
    bones = bones[:, np.linalg.norm(bones[0], axis=1) > 0.0]
    if bones.shape[1] < 3:
        raise NotJudged("a curve needs at least three bones")
    return np.asarray(bones)


def bends(run: Run) -> Array:
    """Bend of every joint inside the limb, (m, joints) [rad], where it is bent at all."""
    bones = _bones(run)
    sine = np.linalg.norm(np.cross(bones[:, :-1], bones[:, 1:]), axis=2)
    found = np.arctan2(sine, (bones[:, :-1] * bones[:, 1:]).sum(2))
    found = found[found.sum(axis=1) > BENT]
    if not len(found):
        raise NotJudged("the limb is never bent")
    return np.asarray(found)


def s_shape(run: Run) -> float:
    """How far from its middle the limb changes the side it bends to, at most [lengths].

    A limb that bends to one side only counts as 0.5.
    """
    bones = _bones(run)
    sizes = np.linalg.norm(bones[0], axis=1)
    turns = np.cross(bones[:, :-1], bones[:, 1:])
    strongest = np.linalg.norm(turns, axis=2).argmax(axis=1)
    side = turns[np.arange(len(turns)), strongest]
    bend = (turns * side[:, None]).sum(axis=2)
    joints = np.cumsum(sizes)[:-1] / sizes.sum()
    return max(_off_middle(row, joints) for row in bend)


def _off_middle(bend: Array, joints: Array) -> float:
    """Where a bend along the joints' places passes through zero, counted from the middle."""
    crossed = np.flatnonzero(bend[:-1] * bend[1:] < 0.0)
    if not len(crossed):
        return 0.5
    share = bend[crossed] / (bend[crossed] - bend[crossed + 1])
    places = joints[crossed] + share * (joints[crossed + 1] - joints[crossed])
    return float(np.abs(places - 0.5).max())


def curl(run: Run) -> float:
    """Share of the last joint in the whole bend times the number of joints; 1 = even [-]."""
    found = bends(run)
    return float((found[:, -1] / found.mean(axis=1)).max())


def unevenness(run: Run) -> float:
    """Standard deviation of the joints' bends over their mean [-]."""
    found = bends(run)
    return float((found.std(axis=1) / found.mean(axis=1)).max())
