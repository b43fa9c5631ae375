"""All measures, with names, units and the numbers they are quoted by."""

from collections.abc import Callable
from dataclasses import dataclass
from math import degrees

import numpy as np

from limbik.core.rotation import Array
from limbik.plugins.judging.curve import curl, s_shape, unevenness
from limbik.plugins.judging.latency import latency
from limbik.plugins.judging.limits import chatter, limit_excess
from limbik.plugins.judging.mirror import asymmetry
from limbik.plugins.judging.mixing import mix_detour
from limbik.plugins.judging.motion import accelerations, gains, plane_speeds, pops
from limbik.plugins.judging.optimum import limit_error
from limbik.plugins.judging.reach import excess_errors, false_statuses, reach_errors
from limbik.plugins.judging.replay import drift, flips, history
from limbik.plugins.judging.roundtrip import round_trip
from limbik.plugins.judging.run import NotJudged, Run
from limbik.plugins.judging.smoothness import roughness
from limbik.plugins.judging.soundness import stretch, unsound_poses


@dataclass(frozen=True, slots=True)
class Metric:
    """A measure of a solved path; smaller is better.

    Attributes:
        name: Key in the scene's `judge` section.
        number: M1 to M23, as the documentation lists them.
        unit: For people.
        meaning: One line.
        measure: Gives the value, or raises `NotJudged`.
        on_path: Whether it says something only where the goals are a path.
    """

    name: str
    number: str
    unit: str
    meaning: str
    measure: Callable[[Run], float]
    on_path: bool = False


def _at(
    share: float, measure: Callable[[Run], Array], factor: float = 1.0
) -> Callable[[Run], float]:
    """Take a percentile of a measure that gives many values; 100 is the largest."""
    return lambda run: factor * float(np.percentile(measure(run), share))


def _times(factor: float, measure: Callable[[Run], float]) -> Callable[[Run], float]:
    return lambda run: factor * measure(run)


def _not_yet(reason: str) -> Callable[[Run], float]:
    def refuse(run: Run) -> float:
        raise NotJudged(reason)

    return refuse


_DEG = degrees(1.0)

METRICS: tuple[Metric, ...] = (
    Metric(
        "reach_error_p95", "M1", "% L", "miss of goals within reach", _at(95, reach_errors, 100)
    ),
    Metric("reach_error", "M1", "% L", "largest of these", _at(100, reach_errors, 100)),
    Metric(
        "excess_error", "M2", "% L", "miss beyond the unavoidable", _at(100, excess_errors, 100)
    ),
    Metric(
        "limit_error",
        "M2",
        "% L",
        "miss beyond the best of long solves",
        _times(100, limit_error),
    ),
    Metric(
        "gain_p95", "M3", "rad/L", "joint turn over the goal's way", _at(95, gains), on_path=True
    ),
    Metric("gain", "M3", "rad/L", "largest of these", _at(100, gains), on_path=True),
    Metric(
        "acceleration",
        "M4",
        "°/s²",
        "of a joint, largest",
        _at(100, accelerations, _DEG),
        on_path=True,
    ),
    Metric(
        "acceleration_p99", "M4", "°/s²", "of a joint", _at(99, accelerations, _DEG), on_path=True
    ),
    Metric("pops", "M5", "", "turns that stand out from those around", pops, on_path=True),
    Metric("flips", "M6", "", "jumps that no finer path removes", flips, on_path=True),
    Metric(
        "roughness",
        "M7",
        "",
        "log jerk of the middle joint less the goal's",
        roughness,
        on_path=True,
    ),
    Metric("chatter", "M8", "1/s", "reversals of a limited axis", chatter, on_path=True),
    Metric("limit_excess", "M9", "°", "beyond a limit", _times(_DEG, limit_excess)),
    Metric(
        "history",
        "M10",
        "°",
        "pose change by the order of goals",
        _times(_DEG, history),
    ),
    Metric(
        "drift",
        "M11",
        "°",
        "first pose after the path, 1000 times",
        _times(_DEG, drift),
    ),
    Metric(
        "round_trip",
        "M12",
        "°",
        "pose change, IK to FK and back",
        _times(_DEG, round_trip),
    ),
    Metric("asymmetry", "M13", "L", "distance from the mirror image", asymmetry),
    Metric(
        "swivel_error",
        "M14",
        "°",
        "bend plane against a recorded one",
        _not_yet("a scene holds no recorded limb to compare with"),
    ),
    Metric(
        "plane_speed_p95",
        "M15",
        "°/s",
        "of the bend plane",
        _at(95, plane_speeds, _DEG),
        on_path=True,
    ),
    Metric("curl", "M16", "", "last joint's share of the bend, 1 = even", curl),
    Metric("unevenness", "M17", "", "spread of the joints' bends", unevenness),
    Metric("s_shape", "M17", "L", "change of the bend's side from the middle", s_shape),
    Metric("mix_detour", "M18", "", "way from IK to FK over the straight one", mix_detour),
    Metric(
        "rate_dependence",
        "M19",
        "°",
        "pose change by the frame rate",
        _not_yet("smoothing counts solves, not seconds; only the caller knows the rate"),
    ),
    Metric("false_statuses", "M20", "", "goals whose status is not true", false_statuses),
    Metric("unsound_poses", "M21", "", "not finite or no rotation", unsound_poses),
    Metric("stretch", "M22", "L", "change of a bone's length", stretch),
    Metric(
        "latency",
        "M23",
        "ms",
        "95 % of single solves are faster",
        _times(1000.0, latency),
    ),
)

BY_NAME = {metric.name: metric for metric in METRICS}
