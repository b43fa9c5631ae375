"""How many reachable goals chains of swing-twist cones reach: `python benchmarks/cones.py`."""

import time

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.jointlimits import margin_of
from limbik.core.kernels.rotation import hpb_to_matrix, matrix_to_hpb, multiply, turn_by
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.solver import Solver

CASES = (
    (3, (60.0, 40.0), (-30.0, 45.0)),
    (4, (60.0, 40.0), (-30.0, 45.0)),
    (4, (30.0, 30.0), (0.0, 0.0)),
    (4, (90.0, 0.0), (-5.0, 5.0)),
    (9, (25.0, 25.0), (-10.0, 10.0)),
)
GOALS = 1000


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


def main() -> None:
    """Print one row a chain."""
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


if __name__ == "__main__":
    main()
