"""Pose goals by `refine`: how many reachable poses are reached, how fast, and how paths go.

python benchmarks/pose_goals.py
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import process_time

import numpy as np

from limbik import PoseSolver
from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.rotation import Array
from limbik.core.scene import read_scene

CONFIGS = Path(__file__).parents[1] / "configs"
GOALS = 1000
ROUNDS = 5
EXACT = 1e-6  # [m] and [rad]
LEAST = 0.999
WALKS, ARMS = 60, 30
ZERO = (0.0, 0.0, 0.0)


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
    """Return the shortest CPU time of several runs [s]; one thread works."""
    times = []
    for _ in range(ROUNDS):
        start = process_time()
        function()
        times.append(process_time() - start)
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


def follow(name: str) -> None:
    """Print what becomes of walks through 98 % of every range, a small step a sample."""
    chain = read_scene(CONFIGS / name).chain
    solver = PoseSolver(chain, tolerance=EXACT * chain.length, angle=EXACT)
    middle, half = (chain.high + chain.low) / 2.0, 0.98 * (chain.high - chain.low) / 2.0
    time = np.arange(2000)[:, None, None] * 0.004
    reached, jumps, seconds = 0, 0, 0.0
    for seed in range(WALKS):
        rng = np.random.default_rng(seed)
        phase, rate = rng.uniform(0.0, 6.3, half.shape), rng.uniform(0.3, 1.0, half.shape)
        way = middle + half * np.sin(phase + rate * time)
        places, turns = (part[:, -1] for part in forward_kinematics(chain, way))
        start = process_time()
        found = solver.follow(places, turns, near=way[0])
        seconds += process_time() - start
        reached += int(np.sum(found.reached))
        jumps += int(np.sum(found.jumped))
    count = WALKS * len(time)
    print(f"{name}, walks: {reached} of {count} samples reached, {jumps} jumps told, ", end="")
    print(f"{seconds / count * 1e6:.1f} µs a sample")


def any_arm(rng: np.random.Generator, hinges: int, width: float) -> Chain:
    """Return an arm of hinges about any axes, with any offsets and ranges of a width [rad]."""
    joints = []
    for k in range(hinges):
        low = rng.uniform(-np.pi, np.pi - width)
        spans = [(0.0, 0.0)] * 3
        spans[rng.integers(3)] = (low, low + width)
        frozen = rng.choice([0.0, np.pi / 2, -np.pi / 2], 3)
        joints.append(Joint(f"j{k}", tuple(rng.uniform(-0.5, 0.5, 3)), tuple(frozen), ZERO, *spans))
    return Chain([*joints, Joint("end", (0.0, 0.0, 0.3), ZERO, ZERO, *[(0.0, 0.0)] * 3)])


def measure_any() -> None:
    """Print the share reached on arms made at random."""
    rng = np.random.default_rng(1)
    for hinges in (6, 7, 9):
        for width in (1.0, 2.5, 5.5):
            met = []
            for _ in range(ARMS):
                chain = any_arm(rng, hinges, width)
                poses = reachable(chain, 100, int(rng.integers(1 << 30)))
                met.append(np.mean(PoseSolver(chain, EXACT, EXACT).solve_many(*poses).reached))
            ranges = f"ranges of {np.degrees(width):.0f}°"
            print(f"{ARMS} arms of {hinges} hinges, {ranges}: {np.mean(met):.2%} reached")


if __name__ == "__main__":
    good = [measure("arm7.yaml", 1.0), measure("weld.yaml", 0.01)]
    follow("arm7.yaml")
    follow("weld.yaml")
    measure_any()
    raise SystemExit(not all(good))
