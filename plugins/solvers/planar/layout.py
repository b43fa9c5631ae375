"""The arrays a planar solve runs on."""

from typing import NamedTuple

from limbik.core.rotation import Array


class Links(NamedTuple):
    """A planar chain of n links, base at the origin."""

    lengths: Array
    """(n,) [length]."""
    low: Array
    """Limits of the relative angles, (n,) [rad]; -inf where free. Link 0's is to the ground."""
    high: Array
    """As `low`."""


class Scratch(NamedTuple):
    """The working pose of n links; made by `new_scratch`."""

    relative: Array
    """Angle of each link to the one before, (n,) [rad]."""
    angle: Array
    """Angle of each link to the ground, (n,) [rad]."""
    x: Array
    """Places of the joints and the tip, (n + 1,) [length]."""
    y: Array
    trial: Array
    """Relative angles being tried, (n,) [rad]."""
    best: Array
    """Best relative angles so far, (n,) [rad]."""
    near: Array
    """Relative angles the answer shall be near to, (n,) [rad]."""


METHODS = (
    "ccd",
    "ccd-limit",
    "ccd-limit-chase",
    "fabrik",
    "fabrik-limit",
    "fabrik-limit-forward",
    "fabrik-limit-child",
    "ccd-nearest",
    "fabrik-both",
)
"""Names of the sweeps, in the order of their numbers; the first seven are the article's."""

ARTICLE = METHODS[:7]
"""Those of the article."""

CCD, CCD_LIMIT, CCD_CHASE, FABRIK, FABRIK_LIMIT, FABRIK_FORWARD, FABRIK_CHILD = range(7)
CCD_NEAREST, FABRIK_BOTH = 7, 8
