"""Planning and sampling a program against scipy's spline and SLERP alone, in one run.

python benchmarks/bench_trajectory.py
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, Slerp

from limbik import PoseSolver
from limbik.core.scene import read_scene
from limbik.core.solver import Solver
from limbik.plugins.paths.moves import Junction, Move
from limbik.plugins.paths.scene_program import scene_trajectory
from limbik.trajectory import (
    Arc,
    Blend,
    KeyPoint,
    Limits,
    Line,
    Samples,
    Spline,
    joint_motion,
    plan,
)

SAMPLES = 10_000
MOST = 2.5  # times scipy alone
MOST_MICROSECONDS = 40
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


def _timed(function: Callable[[], None]) -> float:
    start = perf_counter()
    function()
    return perf_counter() - start


def motion() -> tuple[float, float]:
    """Time of a sample of joint motion on the arm of configs/weld.yaml, the best of 5 [s].

    Returns:
        For positions alone, and for pose goals.
    """
    scene = read_scene(Path(__file__).parents[1] / "configs" / "weld.yaml")
    samples = scene_trajectory(scene).sample(0.002)
    tolerance = scene.settings.tolerance
    found = []
    for solver in (Solver(scene.chain, scene.settings), PoseSolver(scene.chain, tolerance)):
        run = partial(_solve, samples, solver)
        run()
        found.append(min(_timed(run) for _ in range(5)) / len(samples))
    return found[0], found[1]


def _solve(samples: Samples, solver: Solver | PoseSolver) -> None:
    joint_motion(samples, solver)


if __name__ == "__main__":
    scipy_alone()
    limbik_program()
    # One after the other in turn, so that what else the machine does hits both.
    pairs = [(_timed(scipy_alone), _timed(limbik_program)) for _ in range(ROUNDS)]
    alone, program = (min(times) for times in zip(*pairs, strict=True))
    sample, posed = motion()
    print(f"scipy alone    {alone * 1e3:7.2f} ms")
    print(f"limbik program {program * 1e3:7.2f} ms, {program / alone:.2f} times (at most {MOST})")
    print(f"joint motion   {sample * 1e6:7.1f} µs a sample (at most {MOST_MICROSECONDS})")
    print(f"  pose goals   {posed * 1e6:7.1f} µs a sample")
    raise SystemExit(program > MOST * alone or sample > MOST_MICROSECONDS * 1e-6)
