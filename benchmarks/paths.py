"""How steadily limbs follow straight paths all over their reach, in and out of their limits.

The table of docs/naturalness.md: `python benchmarks/paths.py`, about a minute.
"""

from typing import Any

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.rotation import Array, hpb_to_matrix
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.tests.kinds import CHAINS
from limbik.tests.limbs import ARM_OPTIONS

PATHS, FRAMES = 20, 400
LARGE = 20.0  # [deg]; a turn of a joint from frame to frame that is a change of fold
RANGE = (-25.0, 25.0)

LIMBS: tuple[tuple[str, Chain, dict[str, Any]], ...] = (
    ("arm", CHAINS["arm"], {}),
    ("arm, bend set the elbow's way", CHAINS["arm"], ARM_OPTIONS),
    ("leg", CHAINS["leg"], {}),
    (
        "spine of 8 joints, 25° about every axis",
        Chain([Joint.degrees(f"v{k}", (0, 0, min(k, 1)), (0, 0, 0), (0, 0, 0), *[RANGE] * 3)
               for k in range(8)]),
        {},
    ),
)  # fmt: skip
WAYS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("finish: newton", {}),
    ("finish: {use: newton, fold: home}", {"finish": {"use": "newton", "fold": "home"}}),
    ("start: current", {"start": "current"}),
)


def paths(length: float) -> Array:
    """Return straight paths between places 0.3 to 1 L from the root, (PATHS, FRAMES, 3)."""
    random = np.random.default_rng(3)
    share = np.linspace(0.0, 1.0, FRAMES)[:, None]
    found = []
    for _ in range(PATHS):
        ways = random.normal(size=(2, 3))
        ways *= (random.uniform(0.3, 1.0, 2) / np.linalg.norm(ways, axis=1))[:, None]
        found.append(length * ((1.0 - share) * ways[0] + share * ways[1]))
    return np.array(found)


def turns(angles: Array) -> Array:
    """Return the largest turn of a joint from frame to frame [deg], (PATHS, FRAMES - 1)."""
    poses = hpb_to_matrix(angles)[:, :, :-1]
    chords = np.linalg.norm(poses[:, 1:] - poses[:, :-1], axis=(3, 4)) / np.sqrt(8.0)
    most: Array = np.degrees(2.0 * np.arcsin(np.minimum(chords, 1.0))).max(axis=2)
    return most


def main() -> None:
    """Print the table in Markdown."""
    registry = Registry(third_party=False)
    print(f"| limb | option | reached of {PATHS * FRAMES:,} | both reached | both not | one |")
    print("|---|---|---|---|---|---|")
    for limb, chain, options in LIMBS:
        ways = paths(chain.length)
        for title, way in WAYS:
            solver = Solver(
                chain, registry=registry, tolerance=1e-4 * chain.length, **options, **way
            )
            followed = [solver.follow(goals) for goals in ways]
            angles = np.array([solution.angles for solution in followed])
            status = np.array([solution.status for solution in followed])
            reached = status == Status.REACHED
            large = turns(angles) > LARGE
            ends = 0 + reached[:, 1:] + reached[:, :-1]
            counts = " | ".join(str(np.count_nonzero(large & (ends == n))) for n in (2, 0, 1))
            print(f"| {limb} | `{title}` | {np.count_nonzero(reached):,} | {counts} |")


if __name__ == "__main__":
    main()
