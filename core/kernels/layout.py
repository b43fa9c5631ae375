"""The flat arrays a 3D solve runs on: chain, options, strategies, working pose.

NamedTuples of arrays and numbers cost nothing in compiled code and keep their names there.
"""

from typing import NamedTuple

from limbik.core.rotation import Array

Vector = tuple[float, float, float]

IN_VAIN, LEAST_FOUND = 0, 1  # places of `Pose.verdict`


class Body(NamedTuple):
    """A chain of n joints."""

    offsets: Array
    """Positions in the parent's frame, (n, 3) [length]; joint 0's is from the base frame."""
    frozen: Array
    """Frozen rotations, (n, 3, 3)."""
    rest: Array
    """Initial angles inside the limits, HPB, (n, 3) [rad]."""
    low: Array
    """Limits, (n, 3) [rad]; -inf where free."""
    high: Array
    """Limits, (n, 3) [rad]; +inf where free."""
    operating: Array
    """Unit vectors that aim turns to the target, in each joint's frame, (n, 3)."""
    along: Array
    """Bone length from joint 0 to each joint along the chain, (n,) [length]."""
    base_position: Array
    """(3,) [length], world."""
    base_rotation: Array
    """Axes of the IK space in the world, (3, 3)."""


class Options(NamedTuple):
    """`Settings` as numbers: radians, flags."""

    full_fk: bool
    tolerance: float
    max_iterations: int
    smoothing: float
    max_violations: int
    held_base: int
    held_end: int
    bend_held_base: int
    bend_held_end: int
    coefficient_base: float
    weight_min: float
    weight_max: float
    root: int
    """Index of the bend root: the joint before the bend reference."""
    root_to_end: float
    """[length]"""
    axis_x: float
    """Reference axis in the reference joint's frame; both 0 = free."""
    axis_y: float
    twist: float
    aim_twist: bool
    off_axis: bool
    from_previous: bool
    bank_lock: bool
    cone_axis: int
    """0, 1, 2 = x, y, z; -1 = no forbidden cone."""
    cone_sign: float
    cone_angle: float
    cone_around: bool
    hold_bend: bool
    bend_smoothing: float
    plain_clamp: bool
    from_current: bool
    """Whether CCD starts from the pose before, where there is one, not from the bend pose."""
    soft_zone: float
    """Share of the reach from the bend root in which goals are pulled in; 0 = off."""
    limit_ease: float
    """Width of the zone before a limit in which CCD slows a joint [rad]; 0 = off."""
    fk_strength: float
    fk_mix: float


class Plugs(NamedTuple):
    """Native addresses of the chosen strategies and their parameters."""

    initial_bend: int
    bend_vector: int
    root_control: int
    bank_suppression: int
    finish: int
    params: Array
    """One row a slot in the order above, (5, 16)."""
    own: Array
    """What is each joint's own, columns as in `limbik.core.kernels.own`, (n, WIDTH)."""


class Choice(NamedTuple):
    """What few solves ask for, see `limbik.core.kernels.solve_fully`."""

    by: int
    """How to choose among solutions: 0 = take the first, see `limbik.core.kernels.choose`."""
    candidates: int
    pose_given: bool
    pose: Array
    """Reference pose if given, (n, 3) [rad]."""
    weights: Array
    """(n,) [-]"""
    end_orientation: float
    """Share of the goal's orientation that the end takes over; 0 = off."""


class Pose(NamedTuple):
    """What a solve works on; allocated once, used for goal after goal."""

    angles: Array
    """HPB, (n, 3) [rad]; true for limited joints, renewed for free ones where needed."""
    relative: Array
    """Rotations of the angles, (n, 3, 3)."""
    parent: Array
    """World frames before a joint's own turn: parent world x frozen, (n, 3, 3)."""
    world: Array
    """World rotations, (n, 3, 3)."""
    positions: Array
    """World positions, (n, 3) [length]."""
    low: Array
    """Effective limits of this solve, (n, 3) [rad]."""
    high: Array
    """Effective limits of this solve, (n, 3) [rad]."""
    free: Array
    """Whether a joint has no limit at all now, (n,) of 0 or 1."""
    moves: Array
    """Whether a joint has an axis that is not fixed, (n,) of 0 or 1."""
    hinged: Array
    """Whether a joint has a fixed axis and a free one, (n,) of 0 or 1."""
    violations: Array
    """Turns in a row that asked for more than the limits, (n,) integers."""
    bones: Array
    """Bone lengths from the root over root-to-end length, weights, angles [rad], (3, n)."""
    directions: Array
    """Each joint's direction to the end in the aim pose, world, (n, 3); off-axis layout only."""
    own: Array
    """As in `Plugs`, with room to work in, (n, WIDTH)."""
    scratch: Array
    """Arguments of strategies, (8, 3)."""
    finish_rows: Array
    """What a finish works in, (n, 72)."""
    verdict: Array
    """Whether a finish tried all in vain, and the least distance it found [length], (2,)."""


class Bend(NamedTuple):
    """The plane a solve bends in, IK space."""

    aim: Vector
    """Unit vector root to goal in the aim pose."""
    vector: Vector
    """Unit bend vector across the aim."""
