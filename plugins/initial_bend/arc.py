"""An arc whose end lies exactly on the goal: what `solved-arc` and `uniform-arc` share.

The bones' angles are an amplitude times a shape. The larger the amplitude, the nearer the end
comes to the root, so one search finds the amplitude that fits a goal; the whole arc is then turned
so that its end lies on the line root→goal. A shape cannot close completely (it would coil up
instead); goals nearer than it comes are reached from its tightest arc by the smallest turns.
"""

from math import atan2, cos, inf, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TIGHTEST = 0.1  # the shape alone comes this near to the root and not nearer [-]
FLATTEST = -0.08  # slope of the reach over the opening where a shape is no longer followed [1/rad]
SEARCHES = 60  # steps of a search, halving at worst
STEPS = 8  # goals on the way from the tightest arc inward
POLISH = 40  # steps on the last of them
CLOSE = 1e-15  # misses below it are rounding [-]


def bend_to(lengths: Array, reach_ratio: float, angles: Array) -> None:
    """Turn a shape into the angles of an arc that ends on the goal.

    A goal out of reach leaves the bones straight; one inside the hole that a bone longer than all
    others together leaves is approached as near as the bones come.

    Args:
        lengths: (m,) over their total [-].
        reach_ratio: Distance root to goal over that total [-].
        angles: (m,) IN: the shape, OUT: each bone's angle from the line root→goal [rad].
    """
    bones = angles.shape[0]
    low, high, longest = inf, -inf, 0.0
    for bone in range(bones):
        longest = max(longest, lengths[bone])
        if lengths[bone] > 0.0:
            low, high = min(low, angles[bone]), max(high, angles[bone])
    reach = max(reach_ratio, 2.0 * longest - 1.0)
    opening = high - low
    if reach >= 1.0 or not opening > 0.0:
        for bone in range(bones):
            angles[bone] = 0.0
        return
    tightest = tightest_opening(lengths, angles, opening)
    nearest, _ = reach_and_slope(lengths, angles, tightest / opening)
    closest = max(nearest, TIGHTEST)
    amplitude = find_amplitude(lengths, angles, max(reach, closest), tightest / opening)
    for bone in range(bones):
        angles[bone] *= amplitude
    turn_to_line(lengths, angles)
    if reach < closest:
        fold(lengths, closest, reach, angles)


def reach_and_slope(lengths: Array, shape: Array, amplitude: float) -> tuple[float, float]:
    """Return root to end of an arc over the bones' total, and its slope over the amplitude."""
    x, y, dx, dy = 0.0, 0.0, 0.0, 0.0
    for bone in range(shape.shape[0]):
        angle = amplitude * shape[bone]
        c, s = lengths[bone] * cos(angle), lengths[bone] * sin(angle)
        x, y = x + c, y + s
        dx, dy = dx - shape[bone] * s, dy + shape[bone] * c
    reach = sqrt(x * x + y * y)
    return reach, (x * dx + y * dy) / reach if reach > 0.0 else 0.0


def tightest_opening(lengths: Array, shape: Array, opening: float) -> float:
    """Return the angle between the outermost bones up to which an arc follows its shape [rad].

    Up to half a turn the end always comes nearer. Beyond, the shape is followed while that stays
    so: until the slope flattens or the end is near the root.
    """
    at = pi
    reach, slope = reach_and_slope(lengths, shape, at / opening)
    step = pi / 8.0
    while reach > TIGHTEST and slope < FLATTEST * opening and at < 2.0 * pi:
        at += step
        reach, slope = reach_and_slope(lengths, shape, at / opening)
    if at == pi or not slope >= FLATTEST * opening:
        return at
    below, above = at - step, at
    for _ in range(SEARCHES):
        middle = 0.5 * (below + above)
        _, slope = reach_and_slope(lengths, shape, middle / opening)
        if slope < FLATTEST * opening:
            below = middle
        else:
            above = middle
    return below


def find_amplitude(lengths: Array, shape: Array, reach: float, most: float) -> float:
    """Return the amplitude at which the end is `reach` away from the root.

    Newton's steps, halving where one would leave the interval that holds the answer.
    """
    below, above = 0.0, most
    amplitude = first_guess(lengths, shape, reach, most)
    for _ in range(SEARCHES):
        here, slope = reach_and_slope(lengths, shape, amplitude)
        miss = here - reach
        if abs(miss) < CLOSE:
            break
        if miss > 0.0:
            below = amplitude
        else:
            above = amplitude
        amplitude = amplitude - miss / slope if slope < 0.0 else below
        if not below < amplitude < above:
            amplitude = 0.5 * (below + above)
    return amplitude


def first_guess(lengths: Array, shape: Array, reach: float, most: float) -> float:
    """Return the amplitude of a slight arc: reach² = 1 - amplitude² x variance of the shape."""
    mean, square = 0.0, 0.0
    for bone in range(shape.shape[0]):
        mean += lengths[bone] * shape[bone]
        square += lengths[bone] * shape[bone] * shape[bone]
    variance = square - mean * mean
    if not variance > 0.0:
        return 0.5 * most
    return min(sqrt((1.0 - reach * reach) / variance), 0.9 * most)


def turn_to_line(lengths: Array, angles: Array) -> None:
    """Turn all bones together so that the end lies on the line of angle 0."""
    x, y = 0.0, 0.0
    for bone in range(angles.shape[0]):
        x += lengths[bone] * cos(angles[bone])
        y += lengths[bone] * sin(angles[bone])
    turn = atan2(y, x)
    for bone in range(angles.shape[0]):
        angles[bone] -= turn


def fold(lengths: Array, start: float, reach: float, angles: Array) -> None:
    """Bring the end along the line from one distance to a nearer one by the smallest turns."""
    for step in range(1, STEPS + 1):
        move_end(lengths, start + (reach - start) * step / STEPS, angles)
    for _ in range(POLISH):
        if move_end(lengths, reach, angles) < CLOSE:
            return


def move_end(lengths: Array, reach: float, angles: Array) -> float:
    """Turn the bones so that the end comes to a place on the line; one step of least squares.

    Returns:
        How far the end was from there before [-].
    """
    miss_x, miss_y = reach, 0.0
    xx, xy, yy = 0.0, 0.0, 0.0
    for bone in range(angles.shape[0]):
        c, s = lengths[bone] * cos(angles[bone]), lengths[bone] * sin(angles[bone])
        miss_x, miss_y = miss_x - c, miss_y - s
        xx, xy, yy = xx + s * s, xy - s * c, yy + c * c
    miss = sqrt(miss_x * miss_x + miss_y * miss_y)
    # Where all bones lie on one line the end cannot move along it; a little damping by the miss
    # keeps the step bounded there and costs nothing near the goal.
    damping = 0.01 * miss * miss
    xx, yy = xx + damping, yy + damping
    size = xx * yy - xy * xy
    if not size > 0.0:
        return miss
    u, v = (yy * miss_x - xy * miss_y) / size, (xx * miss_y - xy * miss_x) / size
    for bone in range(angles.shape[0]):
        c, s = lengths[bone] * cos(angles[bone]), lengths[bone] * sin(angles[bone])
        angles[bone] += c * v - s * u
    return miss


def even_weights(weights: Array) -> float:
    """Return what to add to the weights: 1 where all are 0, since only their ratios count.

    Numbers so small that their squares vanish count as 0.
    """
    for bone in range(weights.shape[0]):
        if abs(weights[bone]) > 1e-100:
            return 0.0
    return 1.0
