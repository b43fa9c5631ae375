"""Compare the initial bends on a bowing spine and on random chains.

The tables of docs/naturalness.md.

python benchmarks/naturalness.py
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik import Chain, Joint, Registry, Solver
from limbik.plugins.judging.curve import curl, unevenness
from limbik.plugins.judging.run import Run

Array = NDArray[np.float64]

BENDS = ("nth-root", "solved-arc", "uniform-arc")
REGISTRY = Registry(third_party=False)


def chain(lengths: Array) -> Chain:
    """A chain of ball joints along z, as long as 1."""
    offsets = [(0.0, 0.0, 0.0), *((0.0, 0.0, float(x)) for x in lengths / lengths.sum())]
    return Chain([Joint(f"j{k}", offset) for k, offset in enumerate(offsets)])


def bow() -> Array:
    """Tip of an upright spine in a figure, 241 goals."""
    turn = np.linspace(0.0, 2.0 * np.pi, 241)
    return np.stack([0.45 * np.sin(turn), np.full(241, 0.8), 0.1 * np.sin(2 * turn)], axis=1)


def spine(bend: str, **options: Any) -> tuple[float, float, float]:
    """Largest miss [% L], curl and unevenness of a spine of six bones on its path."""
    given: dict[str, Any] = {"initial_bend": bend, "tolerance": 1e-4, "smoothing": 1.0} | options
    given |= {"bend_vector": {"use": "global", "direction": (0.0, 0.0, -1.0)}}
    solver = Solver(chain(np.ones(6)), registry=REGISTRY, **given)
    goals = bow()
    solution = solver.solve_many(goals)
    run = Run(solver, goals, np.zeros((7, 3)), False, 60.0, solution)
    return 100.0 * float(np.max(solution.distance)), curl(run), unevenness(run)


def random_misses(bend: str, count: int = 200) -> Array:
    """Misses before CCD [% L] of chains of 2 to 28 bones whose lengths differ up to threefold."""
    rng = np.random.default_rng(1)
    misses = []
    for _ in range(count):
        lengths = rng.uniform(0.5, 1.5, int(rng.integers(2, 29)))
        solver = Solver(
            chain(lengths), registry=REGISTRY, initial_bend=bend, max_iterations=0, tolerance=1e-9
        )
        way = rng.normal(size=3)
        least = max(0.0, 2.0 * lengths.max() / lengths.sum() - 1.0)
        goal = way / np.linalg.norm(way) * rng.uniform(least + 0.01, 0.99)
        misses.append(100.0 * float(solver.solve(goal).distance))
    return np.array(misses)


def main() -> None:
    """Print the table."""
    print("| initial bend | stages | miss, % L | curl | unevenness |")
    print("|---|---|---|---|---|")
    stages: dict[str, dict[str, Any]] = {
        "bend pose": {"max_iterations": 0},
        "CCD": {"max_iterations": 200, "finish": "none"},
        "CCD and finish": {"max_iterations": 200},
    }
    for bend in BENDS:
        for name, options in stages.items():
            miss, curled, uneven = spine(bend, **options)
            print(f"| {bend} | {name} | {miss:.2g} | {curled:.2f} | {uneven:.2f} |")
    print("\n| initial bend | median miss, % L | 95 % | largest |\n|---|---|---|---|")
    for bend in BENDS:
        misses = random_misses(bend)
        p50, p95 = np.percentile(misses, [50, 95])
        print(f"| {bend} | {p50:.2g} | {p95:.2g} | {misses.max():.2g} |")


if __name__ == "__main__":
    main()
