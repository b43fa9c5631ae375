"""Pose goals by `refine`: how many of 1,000 reachable poses are reached, and how fast.

python benchmarks/pose_goals.py
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from limbik import PoseSolver
from limbik.core.chain import Chain
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.scene import read_scene

CONFIGS = Path(__file__).parents[1] / "configs"
GOALS = 1000
ROUNDS = 5
EXACT = 1e-6  # [m] and [rad]
LEAST = 0.999


def reachable(chain: Chain, count: int, seed: int = 1) -> tuple[Array, Array]:
    """Return positions and rotations of the end at random angles within the limits."""
    rng = np.random.default_rng(seed)
    angles = rng.uniform(chain.low, chain.high, (count, len(chain), 3))
    positions, rotations = forward_kinematics(chain, angles)
    return positions[:, -1].copy(), rotations[:, -1].copy()


def share_met(chain: Chain, angles: Array, places: Array, turns: Array, exact: float) -> float:
    """Return how many poses are met within the limits, by forward kinematics of their own."""
    positions, rotations = forward_kinematics(chain, angles)
    apart = np.linalg.norm(positions[:, -1] - places, axis=1)
    # For small angles the Frobenius norm of the difference is the angle times the root of 2.
    turned = np.linalg.norm(rotations[:, -1] - turns, axis=(1, 2)) / np.sqrt(2.0)
    inside = ((angles >= chain.low) & (angles <= chain.high)).all(axis=(1, 2))
    return float(((apart < exact) & (turned < EXACT) & inside).mean())


def best(function: Callable[[], object]) -> float:
    """Return the shortest of several runs [s]."""
    times = []
    for _ in range(ROUNDS):
        start = perf_counter()
        function()
        times.append(perf_counter() - start)
    return min(times)


def measure(name: str, unit: float) -> bool:
    """Print the figures of a scene's arm; its unit is so many metres."""
    chain = read_scene(CONFIGS / name).chain
    exact = EXACT / unit
    solver = PoseSolver(chain, tolerance=exact, angle=EXACT)
    places, turns = reachable(chain, GOALS)
    found = solver.solve_many(places, turns)
    share = share_met(chain, found.angles, places, turns, exact)
    told = float((np.asarray(found.status) == 0).mean())
    one = best(lambda: [solver.solve(places[k], turns[k]) for k in range(100)]) / 100
    many = best(lambda: solver.solve_many(places, turns)) / GOALS
    times = [best(partial(solver.solve, *pose)) for pose in zip(places, turns, strict=True)]
    lost = reachable(chain, GOALS, 2)[0]
    aside = best(lambda: solver.solve_many(lost, turns)) / GOALS
    print(f"{name}: {share:.1%} met to {EXACT:g} m and rad within limits, {told:.1%} told reached")
    slow = np.percentile(times, 99) * 1e6
    print(f"  {many * 1e6:.1f} µs a goal of many")
    print(f"  {one * 1e6:.0f} µs a single solve from Python, 99th percentile {slow:.0f} µs")
    print(f"  {aside * 1e6:.0f} µs a goal where most are not reachable")
    return share >= LEAST


if __name__ == "__main__":
    good = [measure("arm7.yaml", 1.0), measure("weld.yaml", 0.01)]
    raise SystemExit(not all(good))
