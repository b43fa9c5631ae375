"""Swing-twist cones, what they reach and cost: `python benchmarks/cones.py`.

The first table is of reachable goals; the second puts a cone at the root of a limb beside the
limb's ranges, for goals all over its reach, by how they end.
"""

import time
from typing import Any

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.jointlimits import margin_of
from limbik.core.kernels.rotation import hpb_to_matrix, matrix_to_hpb, multiply, turn_by
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.tests.kinds import leg, spine
from limbik.tests.limbs import arm

CASES = (
    (3, (60.0, 40.0), (-30.0, 45.0)),
    (4, (60.0, 40.0), (-30.0, 45.0)),
    (4, (30.0, 30.0), (0.0, 0.0)),
    (4, (90.0, 0.0), (-5.0, 5.0)),
    (9, (25.0, 25.0), (-10.0, 10.0)),
)
GOALS = 1000
PLACES = 300
TURNS = 3
ARM_CONE = {"use": "cone", "swing": (85.0, 95.0), "twist": (-90.0, 90.0)}
LEG_CONE = {"use": "cone", "swing": (70.0, 40.0), "twist": (-45.0, 45.0)}
SPINE_CONE = {"use": "cone", "swing": (25.0, 25.0), "twist": (-25.0, 25.0)}


def goals_of(chain: Chain, swing: tuple[float, float], twist: tuple[float, float]) -> Array:
    """Ends of random poses inside the cones, even over each cone's area, (GOALS, 3) [length]."""
    random = np.random.default_rng(1)
    (a, b), ends = np.radians(swing), np.radians(twist)
    angles = np.zeros((GOALS, len(chain), 3))
    for row in range(GOALS):
        for joint in range(len(chain) - 1):
            size, around = np.sqrt(random.uniform()), random.uniform(0.0, 2.0 * np.pi)
            swung = turn_by((a * size * np.cos(around), b * size * np.sin(around), 0.0))
            bank = hpb_to_matrix((0.0, 0.0, random.uniform(*ends)))
            angles[row, joint] = matrix_to_hpb(multiply(swung, bank), 0.0)
    return forward_kinematics(chain, angles)[0][:, -1]


def with_cone(chain: Chain, cone: dict[str, Any], frozen: tuple[float, float, float]) -> Chain:
    """Return a chain whose root has a cone, turned by `frozen` [deg], in place of ranges."""
    root = chain.joints[0]
    turned = tuple(np.radians(frozen).tolist())
    return Chain([Joint(root.name, root.offset, frozen=turned, limit=cone), *chain.joints[1:]])


def places(chain: Chain) -> Array:
    """Points even over the ball that the chain could reach without limits, (PLACES, 3) [length]."""
    random = np.random.default_rng(3)
    ways = random.normal(size=(PLACES, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    far = 0.97 * chain.length * random.uniform(size=(PLACES, 1)) ** (1.0 / 3.0)
    return chain.joints[0].offset + far * ways


def seconds(solver: Solver, goals: Array) -> float:
    """Return what one goal costs, the best of a few turns."""
    best = np.inf
    for _ in range(TURNS):
        start = time.process_time()
        solver.solve_many(goals, threads=1)
        best = min(best, time.process_time() - start)
    return best / len(goals)


def beside_ranges(registry: Registry) -> None:
    """Print what a solve costs by how it ends, cones beside ranges."""
    vertebra = [Joint(f"v{k}", (0, 0, float(k > 0)), limit=SPINE_CONE) for k in range(5)]
    pairs = {
        "arm": (arm(), with_cone(arm(), ARM_CONE, (-35.0, 0.0, 0.0))),
        "leg": (leg(), with_cone(leg(), LEG_CONE, (0.0, -50.0, 0.0))),
        "spine of 5, all joints": (spine(5), Chain(vertebra)),
    }
    print("\n| limb | limits | reached | a solve | blocked | a solve |\n|---|---|---|---|---|---|")
    for name, chains in pairs.items():
        goals = places(chains[0])
        for kind, chain in zip(("ranges", "cone"), chains, strict=True):
            solver = Solver(chain, registry=registry, tolerance=1e-4 * chain.length)
            ends = np.asarray(solver.solve_many(goals, threads=1).status)
            row = f"| {name} | {kind}"
            for status in (Status.REACHED, Status.BLOCKED):
                chosen = goals[ends == status]
                row += f" | {len(chosen)} | {seconds(solver, chosen) * 1e6:.0f} us"
            print(row + " |", flush=True)


def main() -> None:
    """Print both tables."""
    registry = Registry(third_party=False)
    print("| joints | swing [deg] | twist [deg] | reached | worst past the cone [rad] | a solve |")
    print("|---|---|---|---|---|---|")
    for count, swing, twist in CASES:
        cone = {"use": "cone", "swing": swing, "twist": twist}
        parts = [Joint(f"j{k}", (0, 0, 1.0 if k else 0.0), limit=cone) for k in range(count - 1)]
        chain = Chain([*parts, Joint("end", (0.0, 0.0, 1.0))])
        solver = Solver(chain, registry=registry, tolerance=1e-4 * chain.length)
        goals = goals_of(chain, swing, twist)
        found = solver.solve_many(goals, threads=1)
        start = time.process_time()
        solver.solve_many(goals, threads=1)
        spent = (time.process_time() - start) / GOALS * 1e6
        worst = min(
            margin_of(limit, False, pose)
            for row in found.angles
            for limit, pose in zip(solver.limits, row, strict=True)
            if limit is not None
        )
        reached = 100.0 * float(np.mean(found.reached))
        print(
            f"| {count} | {swing[0]:g}, {swing[1]:g} | {twist[0]:g}..{twist[1]:g} "
            f"| {reached:.1f} % | {max(-worst, 0.0):.0e} | {spent:.0f} us |"
        )
    beside_ranges(registry)


if __name__ == "__main__":
    main()
