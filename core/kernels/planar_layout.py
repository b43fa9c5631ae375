"""The flat arrays a 2D solve runs on, beside those both solvers share (000 §7.5).

The IK space has its origin at the base, X toward the goal, Y toward the pole, Z across both. Its XY
plane is the IK plane; planar joints are the joints seen along Z. Planar angles are positive from X
toward Y, that is toward the pole.
"""

from typing import NamedTuple

from limbik.core.rotation import Array

Vector = tuple[float, float, float]

FROM_POLE = 0  # where the IK plane comes from; the numbers of `limbik.core.solution2d.PlaneFrom`
KEPT = 1
FROM_REST = 2


class Planar(NamedTuple):
    """What only the 2D solver knows of a chain and its options."""

    low: Array
    """Planar limits, (n,) [rad]; -inf where free."""
    high: Array
    """Planar limits, (n,) [rad]; +inf where free."""
    support: int
    """First joint before the end that can turn; -1 = none. The bend starts there."""
    limited: bool
    """Whether any joint has a planar limit."""
    side: float
    """1 = bend toward the pole, -1 = away from it: the limits allow no other."""
    reference: int
    """Index of the bend reference joint."""
    axis_free: bool
    """Whether no axis is turned to the pole: the chain keeps its roll."""
    keeps_shape: bool
    """Whether the bend adds to the aim pose's planar angles; else it replaces them."""
    pole_turn: float
    """Turn of the IK plane from the pole about the line base to goal [rad]."""
    bound: Array
    """Bone angles of the initial bend at the bind, (n,) [rad]; they are taken off again."""
    rest_direction: Array
    """Unit vector base to end in the rest pose, world, (3,)."""
    rest_axis: Array
    """Reference axis in the rest pose, world, (3,)."""


class PlanarPose(NamedTuple):
    """Planar joints of a solve; allocated once, used for goal after goal."""

    places: Array
    """Positions in the IK space, (n, 3) [length]; x and y move, z stays."""
    lengths: Array
    """Planar length of the bone after each joint, (n,) [length]; 0 for the end."""
    along: Array
    """Planar length from the base to each joint, (n,) [length]."""
    before: Array
    """Angles of the bones from X in the aim pose, (n,) [rad]; the end's is that of its bone."""
    relative: Array
    """Angles from the bone before, (n,) [rad]."""
    after: Array
    """Angles of the bones from X, the sums of `relative`, (n,) [rad]."""
    offsets: Array
    """What FK offsets add to the relative angles, (n,) [rad]."""
    floor: Array
    """Least a relative angle may become in CCD, (n,) [rad]."""
    ceiling: Array
    """Most a relative angle may become in CCD, (n,) [rad]; keeps the chain curved one way."""
    violations: Array
    """Rounds in a row past a limit, (n,) integers."""
