"""Planning and sampling a program against scipy's spline and SLERP alone, in one run.

python benchmarks/bench_trajectory.py
"""

from collections.abc import Callable
from time import perf_counter

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from limbik.plugins.paths.moves import Junction, Move
from limbik.trajectory import Arc, Blend, KeyPoint, Limits, Line, Spline, plan

SAMPLES = 10_000
MOST = 2.5  # times scipy alone
ROUNDS = 60

rng = np.random.default_rng(7)
PLACES = np.cumsum(rng.uniform(-1.0, 1.0, (10, 3)) + np.array([1.0, 0.0, 0.0]), axis=0)
TURNS = Rotation.random(10, random_state=7)
QUATERNIONS = TURNS.as_quat()[:, [3, 0, 1, 2]]


def scipy_alone() -> None:
    steps, times = np.arange(10.0), np.linspace(0.0, 9.0, SAMPLES)
    CubicSpline(steps, PLACES, bc_type="natural")(times)
    Slerp(steps, TURNS)(times)


def limbik_program() -> None:
    p = [KeyPoint.from_quaternion(*pair) for pair in zip(PLACES, QUATERNIONS, strict=True)]
    corner = Blend(0.1)
    steps: list[Move | Junction] = [Line(p[1]), corner, Arc(p[2], p[3]), corner, Line(p[4]), corner]
    steps += [Spline(p[5:9]), corner, Line(p[9])]
    planned = plan(p[0], steps, Limits(0.5, 1.0))
    planned.at(np.linspace(0.0, planned.duration, SAMPLES))


def best(function: Callable[[], None]) -> float:
    function()
    return min(_timed(function) for _ in range(ROUNDS))


def _timed(function: Callable[[], None]) -> float:
    start = perf_counter()
    function()
    return perf_counter() - start


if __name__ == "__main__":
    alone, program = best(scipy_alone), best(limbik_program)
    print(f"scipy alone    {alone * 1e3:7.2f} ms")
    print(f"limbik program {program * 1e3:7.2f} ms, {program / alone:.2f} times (at most {MOST})")
    raise SystemExit(program > MOST * alone)
