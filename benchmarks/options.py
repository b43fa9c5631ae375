"""What each option costs beside the base: `python benchmarks/options.py`.

1000 goals of an arm, 20 rounds each, in one thread. Base and option take turns, so that a machine
that is busy for a while slows both; the best of many turns counts.
"""

from time import process_time
from typing import Any

import numpy as np

from limbik.core.registry import Registry
from limbik.core.settings import Settings
from limbik.core.solver import Solver
from limbik.tests.limbs import ARM_OPTIONS, Array, arm, reachable

TURNS = 60
BASE: dict[str, Any] = {"tolerance": 1e-12, "max_iterations": 20, "finish": "none"}
EXTRAS: dict[str, dict[str, Any]] = {
    "plain clamp": {"clamp": "plain"},
    "auto bend": {"bend_vector": {"use": "auto", "angle": 180.0}},
    "global bend": {"bend_vector": {"use": "global", "direction": [0.0, -1.0, 0.0]}},
    "suppress flip": {"root_control": "suppress-flip"},
    "prefer flip": {"root_control": "prefer-flip"},
    "bank suppression": {"bank_suppression": "threshold"},
    "bank lock": {"bank_lock": True},
    "forbidden cone": {"forbidden_cone": {"axis": "y+", "half_angle": 40.0}},
    "bend smoothing": {"bend_smoothing": 5.0},
    "weights": {"weight_range": (-0.2, 0.3), "coefficient_base": 0.8},
    "off axis": {"off_axis": True},
    "violations": {"max_violations": 1000},
    "twist": {"twist": 20.0, "aim_twist": True},
    "fk mix": {"fk_mix": 0.1},
    "reach limit": {"reach_limit": True},
}


def seconds(solver: Solver, goals: Array) -> float:
    """Return how long the goals take once."""
    start = process_time()
    found = solver.solve_many(goals, threads=1)
    spent = process_time() - start
    assert np.isfinite(found.angles).all()
    return spent


def main() -> None:
    """Print the table in Markdown."""
    registry, goals = Registry(third_party=False), reachable(arm(), 1000, 12)
    base = Solver(arm(), Settings(**BASE, **ARM_OPTIONS), registry)
    print("| option | base [ms] | with it [ms] | cost |\n|---|---|---|---|")
    for name, extra in EXTRAS.items():
        solver = Solver(arm(), Settings(**(BASE | ARM_OPTIONS | extra)), registry)
        for each in (base, solver):
            seconds(each, goals)
        times = np.array([[seconds(base, goals), seconds(solver, goals)] for _ in range(TURNS)])
        before, after = times.min(axis=0)
        cost = 100 * (after / before - 1)
        print(f"| {name} | {before * 1e3:.1f} | {after * 1e3:.1f} | {cost:+.0f} % |", flush=True)


if __name__ == "__main__":
    main()
