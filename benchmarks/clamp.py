"""What re-aiming after a clamp gains over the plain per-axis clamp (3D A-33, A-51).

Solves reachable goals, ends of random poses inside the limits, and counts by forward kinematics
those whose end is within the tolerance and whose angles are inside the limits. CCD works alone,
without a finish. Prints a table in Markdown: `python benchmarks/clamp.py`; `--goals 100` for a
quicker one.
"""

import argparse
from typing import Any

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.solver import Solver
from limbik.tests.kinds import leg
from limbik.tests.limbs import arm

TOLERANCE = 0.01
ROUNDS = ((0.1, 20), (0.1, 100), (1.0, 20), (1.0, 100))
FIXED = (0.0, 0.0)


def six_hinges() -> Chain:
    """Return a small industrial arm of six hinges, stretched along X at zero; lengths in cm.

    From the base the hinges turn about the vertical, three times about one level axis, about the
    vertical and about the level axis, half a turn each way. Its bones run along X, across the
    joints' Z axes (`off_axis`).
    """

    def level(name: str, x: float, y: float) -> Joint:
        return Joint.degrees(name, (x, y, 0), heading=FIXED, pitch=FIXED, bank=(-180, 180))

    def upright(name: str, y: float, z: float) -> Joint:
        return Joint.degrees(name, (0, y, z), heading=(-180, 180), pitch=FIXED, bank=FIXED)

    return Chain(
        [
            upright("base", 8.9, 0),
            level("shoulder", 0, 0),
            level("elbow", 42.5, 0),
            level("wrist", 39.2, 0),
            upright("swivel", 0, 10.9),
            level("nod", 0, -9.5),
            Joint.degrees("tool", (0, 0, 8.2), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


CHAINS: dict[str, tuple[Chain, dict[str, Any]]] = {
    "arm": (arm(), {"bend_vector": {"use": "manual", "angle": 180.0}, "reference_axis": "y-"}),
    "leg": (leg(), {}),
    "six hinges": (
        six_hinges(),
        {"bend_reference": 2, "reference_axis": "free", "off_axis": True},
    ),
}


def reachable(chain: Chain, count: int, seed: int = 20) -> Array:
    """Return ends of random poses inside the limits, (count, 3)."""
    low, high = np.maximum(chain.low, -np.pi), np.minimum(chain.high, np.pi)
    poses = np.random.default_rng(seed).uniform(low, high, (count, len(chain), 3))
    ends: Array = forward_kinematics(chain, poses)[0][:, -1]
    return ends


def success(chain: Chain, angles: Array, goals: Array) -> tuple[float, float]:
    """Return the share of goals met inside the limits [%] and the 90th percentile distance."""
    ends = forward_kinematics(chain, angles)[0][:, -1]
    distance = np.linalg.norm(ends - goals, axis=1)
    inside = ((angles >= chain.low - 1e-9) & (angles <= chain.high + 1e-9)).all(axis=(1, 2))
    met = inside & (distance < TOLERANCE)
    return 100.0 * float(met.mean()), float(np.percentile(distance, 90))


def row(name: str, clamp: str, count: int, registry: Registry) -> str:
    """Return one row of the table."""
    chain, options = CHAINS[name]
    goals = reachable(chain, count)
    cells = []
    for smoothing, rounds in ROUNDS:
        solver = Solver(
            chain,
            registry=registry,
            finish="none",
            clamp=clamp,
            smoothing=smoothing,
            max_iterations=rounds,
            **options,
        )
        share, distance = success(chain, solver.solve_many(goals).angles, goals)
        cells.append(f"{share:.1f} % ({distance:.2g})")
    return f"| {name} | {clamp} | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Plain clamp against re-aim.")
    parser.add_argument("--goals", type=int, default=300)
    count = parser.parse_args().goals
    heads = [f"{smoothing}, {rounds}" for smoothing, rounds in ROUNDS]
    print("| chain | clamp | " + " | ".join(heads) + " |")
    print("|---|---" + "|---" * len(heads) + "|")
    registry = Registry(third_party=False)
    for name in CHAINS:
        for clamp in ("plain", "re-aim"):
            print(row(name, clamp, count, registry), flush=True)


if __name__ == "__main__":
    main()
