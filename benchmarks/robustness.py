"""What limbik reaches, how truly it says so and how long that takes, beside the bare document.

The tables of docs/robustness.md: `python benchmarks/robustness.py`, about five minutes; `--short`
asks a tenth of the cases, `--only NAME` prints one table.
"""

import argparse
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from limbik.core.chain import Chain
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import Scene, read_scene
from limbik.core.solution import Status
from limbik.core.solver import Solver
from limbik.plugins.judging.catalogue import BY_NAME
from limbik.plugins.judging.run import NotJudged, Run, run_scene
from limbik.tests.decided import audit
from limbik.tests.fuzz import fuzz
from limbik.tests.kinds import CHAINS
from limbik.tests.limbs import ARM_OPTIONS, reachable

REGISTRY = Registry(third_party=False)
SCENES = sorted((Path(__file__).parents[1] / "configs" / "scenarios").glob("*.yaml"))
TOLERANCE = 1e-4  # of the length
BARE: dict[str, Any] = {"finish": "none", "initial_bend": "nth-root", "soft_zone": 0.0}
REPEATS = 7  # the best of so many is a goal's time

Rows = Iterator[tuple[str, ...]]


def solver(chain: Chain, **options: Any) -> Solver:
    """Return a solver with default settings but for the tolerance and what is given."""
    return Solver(chain, registry=REGISTRY, **({"tolerance": TOLERANCE * chain.length} | options))


def met(chain: Chain, goals: Array, **options: Any) -> tuple[float, float]:
    """Return goals met inside the limits [%] and the 95th percentile of the misses [% L].

    Not what the solver says: forward kinematics of its angles.
    """
    angles = solver(chain, **options).solve_many(goals).angles
    ends = forward_kinematics(chain, angles)[0][:, -1]
    miss = np.linalg.norm(ends - goals, axis=1) / chain.length
    inside = ((angles >= chain.low - 1e-9) & (angles <= chain.high + 1e-9)).all(axis=(1, 2))
    share = 100.0 * float((inside & (miss < TOLERANCE)).mean())
    return share, 100.0 * float(np.percentile(miss, 95))


def success(share: float) -> Rows:
    """Goals that are ends of random poses inside the limits."""
    yield ("chain", "reached", "bare document", "95 % miss", "bare document")
    for name, chain in CHAINS.items():
        goals = reachable(chain, round(1000 * share), 20)
        ours, bare = met(chain, goals), met(chain, goals, **BARE)
        shares = (f"{ours[0]:.1f} %", f"{bare[0]:.1f} %")
        yield (name, *shares, f"{_short(ours[1])} % L", f"{_short(bare[1])} % L")


def extension(share: float) -> Rows:
    """Goals all around at a share of the reach."""
    bare = "bare document"
    yield ("extension", "two bones", bare, "three bones", bare, "six bones", bare)
    ways = np.random.default_rng(1).normal(size=(round(1000 * share), 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    for far in (0.97, 0.98, 0.99, 0.995, 0.999):
        cells = []
        for name in ("ball3", "ball4", "ball7"):
            chain = CHAINS[name]
            goals = ways * chain.length * far
            cells += [f"{met(chain, goals, **each)[0]:.1f} %" for each in ({}, BARE)]
        yield (f"{100 * far:.1f} %", *cells)


def statuses(share: float) -> Rows:
    """Statuses of random chains of 2 to 4 joints against branch and bound."""
    yield ("joints", "cases", "reached", "blocked", "out of reach", "undecided", "false", "behind")
    for joints in (2, 3, 4):
        tally: Counter[str] = Counter()
        for seed in range(round(20 * share)):
            tally += audit(joints, 30, 1000 * joints + seed, REGISTRY)
        keys = ("cases", "reached", "blocked", "out-of-reach", "open", "false", "behind")
        yield (str(joints), *(f"{tally[key]:,}" for key in keys))


def times(share: float) -> Rows:
    """Single solves from Python, the best of several for every goal."""
    yield ("limb", "goals", "median", "99 %", "longest")
    limbs: tuple[tuple[str, str, dict[str, Any]], ...] = (
        ("arm", "arm", {}),
        ("arm, bend set the elbow's way", "arm", ARM_OPTIONS),
        ("leg", "leg", {}),
        ("six hinges", "six hinges", {}),
    )
    for title, name, options in limbs:
        chain = CHAINS[name]
        asked = solver(chain, **options)
        goals = reachable(chain, round(1000 * share), 20)
        yield (title, "reachable", *_percentiles(asked, goals, 1e6, "µs"))
        yield (title, "blocked", *_percentiles(asked, _blocked(asked, share), 1e3, "ms"))


def _blocked(asked: Solver, share: float) -> Array:
    """Goals spread over the reach that limits keep the limb from."""
    random = np.random.default_rng(4)
    ways = random.normal(size=(round(2000 * share), 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    goals = ways * asked.chain.length * random.random((len(ways), 1)) ** (1 / 3)
    found: Array = goals[np.asarray(asked.solve_many(goals).status) == Status.BLOCKED]
    return found[:200]


def _percentiles(asked: Solver, goals: Array, scale: float, unit: str) -> tuple[str, str, str]:
    best = np.full(len(goals), np.inf)
    for _ in range(REPEATS):
        for row, goal in enumerate(goals):
            start = perf_counter()
            asked.solve(goal)
            best[row] = min(best[row], perf_counter() - start)
    median, most = np.percentile(best, (50, 99)) * scale
    return f"{median:.3g} {unit}", f"{most:.3g} {unit}", f"{best.max() * scale:.3g} {unit}"


def scenarios(share: float) -> Rows:
    """Scenes of configs/scenarios with the metrics that tell most, and without the finish."""
    names = ("reach_error", "limit_error", "pops", "flips", "acceleration", "curl", "unevenness")
    units = (BY_NAME[name].unit for name in names)
    heads = (f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True))
    yield ("scene", "thresholds", *(head.replace("_", " ") for head in heads))
    for path in SCENES:
        scene = read_scene(path, REGISTRY)
        ours = run_scene(scene, REGISTRY)
        solver = ours.own_solver("bare document").altered(**BARE)
        bare = replace(ours, solver=solver, solution=ours.solve(ours.goals, ours.turns, solver))
        for title, run in ((path.stem, ours), ("... bare document", bare)):
            yield (title, _held(scene, run), *(_value(run, name) for name in names))


def _held(scene: Scene, run: Run) -> str:
    """Count the scene's thresholds a run holds."""
    most = {} if scene.judge is None else scene.judge.max
    values = {name: _measured(run, name) for name in most}
    held = sum(value is not None and value <= most[name] for name, value in values.items())
    return f"{held} of {len(most)}"


def _measured(run: Run, name: str) -> float | None:
    try:
        return BY_NAME[name].measure(run)
    except NotJudged:
        return None


def _value(run: Run, name: str) -> str:
    value = _measured(run, name)
    return "" if value is None else _short(value)


def _short(value: float) -> str:
    """Return a number as a table shows it."""
    return f"{value:,.0f}" if value >= 10.0 else "0" if value < 1e-6 else f"{value:.2g}"


def fuzzing(share: float) -> Rows:
    """Random chains, limits, goals, poles and options, degenerate ones among them."""
    keys = ("cases", "infinite", "skewed", "stretched", "unlimited", "false")
    yield ("cases", "not finite", "no rotations", "bones changed", "limits broken", "status false")
    tally = fuzz(round(10_000 * share), 12, REGISTRY)
    yield tuple(f"{tally[key]:,}" for key in keys)


TABLES: dict[str, Callable[[float], Rows]] = {
    "success": success,
    "extension": extension,
    "statuses": statuses,
    "times": times,
    "scenarios": scenarios,
    "fuzz": fuzzing,
}


def main() -> None:
    """Print the tables in Markdown."""
    parser = argparse.ArgumentParser(description="Reach, truth and time of limbik.")
    parser.add_argument("--short", action="store_true", help="a tenth of the cases")
    parser.add_argument("--only", choices=TABLES, help="one table")
    asked = parser.parse_args()
    for name, table in TABLES.items():
        if asked.only not in (None, name):
            continue
        print(f"\n## {name}\n")
        for number, cells in enumerate(table(0.1 if asked.short else 1.0)):
            print("| " + " | ".join(cells) + " |", flush=True)
            if number == 0:
                print("|---" * len(cells) + "|")


if __name__ == "__main__":
    main()
