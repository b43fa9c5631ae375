"""Random chains, limits, goals and poles, degenerate ones among them (JUDGING S12)."""

from collections import Counter
from typing import Any

import numpy as np

from limbik.core.chain import Chain, Joint
from limbik.core.errors import ChainError
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.solution import Solution, Status
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D

Span = tuple[float, float] | None

BONES = (0.0, 1e-9, 1e-3, 1.0, 1.0)
TURNS = (0.0, 90.0, -90.0, 180.0, 45.0)
BENDS = ("nth-root", "solved-arc", "uniform-arc", "two-bone")
VECTORS: tuple[Any, ...] = ("manual", "auto", {"use": "global", "direction": (0.0, 0.0, 1.0)})


def fuzz(count: int, seed: int, registry: Registry) -> Counter[str]:
    """Solve random cases, a fifth of them in 2D, and look at what comes back.

    Args:
        count: Goals; each chain gets five.
        seed: Of everything.
        registry: Where the solvers find their strategies.

    Returns:
        Numbers of `cases` and of those that are `infinite`, `skewed` (no rotations), `stretched`
        (bones changed by more than 1e-9 of the length), `unlimited` (beyond a limit by more than
        1e-6°) or `false` (the status contradicts the pose); of each status.
    """
    random = np.random.default_rng(seed)
    tally: Counter[str] = Counter()
    while tally["cases"] < count:
        try:
            solver = _solver(_chain(random), random, registry)
        except ChainError:  # no length, or none from the bend root on
            continue
        goals = _goals(solver.chain, random)
        tally += _looked_over(solver, solver.solve_many(goals))
    return tally


def _looked_over(solver: Solver, found: Solution) -> Counter[str]:
    """Count what is wrong with a solution of many goals."""
    chain, reach = solver.chain, max(solver.chain.length, 1.0)
    finite = np.isfinite(found.angles).all((1, 2)) & np.isfinite(found.positions).all((1, 2))
    frames = found.rotations
    skew = np.abs(frames @ np.swapaxes(frames, -1, -2) - np.eye(3)).max((1, 2, 3))
    bones = np.linalg.norm(np.diff(found.positions, axis=1), axis=2)
    stretch = np.abs(bones - chain.lengths).max(axis=1) / reach
    angles, low, high = found.angles, chain.low, chain.high
    if isinstance(found, PlanarSolution):
        angles, (low, high) = found.planar_angles, found.planar_limits
    over = np.maximum(low - angles, angles - high).reshape(len(angles), -1).max(axis=1)
    ends = forward_kinematics(chain, found.angles)[0][:, -1]
    miss = np.linalg.norm(ends - found.goal, axis=1)
    status = np.asarray(found.status)
    said = (status == Status.REACHED) != (np.asarray(found.distance) < solver.settings.tolerance)
    said |= np.abs(miss - found.distance) > 1e-9 * reach + 1e-12 * np.abs(found.goal).max()
    return Counter(
        cases=len(found.goal),
        infinite=int((~finite).sum()),
        skewed=int((~(skew < 1e-9)).sum()),
        stretched=int((~(stretch < 1e-9)).sum()),
        unlimited=int((~(over < np.radians(1e-6))).sum()),
        false=int(said.sum()),
    ) + Counter({Status(kind).label: int((status == kind).sum()) for kind in Status})


def _solver(chain: Chain, random: np.random.Generator, registry: Registry) -> Solver:
    options: dict[str, Any] = {
        "initial_bend": BENDS[random.integers(len(BENDS))],
        "tolerance": 1e-4,
        "smoothing": float(random.choice([0.1, 1.0])),
        "soft_zone": float(random.choice([0.0, 0.05])),
        "reference_axis": str(random.choice(["free", "y-", "x+"])),
    }
    if random.random() < 0.2:
        positions, _ = forward_kinematics(chain, np.clip(chain.rest, chain.low, chain.high))
        # On the root, on the line to the end, or anywhere.
        poles = (positions[0], 2.0 * positions[-1] - positions[0], random.normal(size=3))
        del options["soft_zone"]
        pole = poles[random.integers(3)]
        return Solver2D(chain, registry=registry, pole=pole, finish="none", **options)
    options["finish"] = str(random.choice(["newton", "newton", "none"]))
    options["bend_vector"] = VECTORS[random.integers(len(VECTORS))]
    options["root_control"] = str(random.choice(["none", "suppress-flip", "prefer-flip"]))
    return Solver(chain, registry=registry, **options)


def _chain(random: np.random.Generator) -> Chain:
    joints = []
    for number in range(int(random.integers(2, 8))):
        bone = float(random.choice(BONES)) * float(random.uniform(0.2, 1.0)) if number else 0.0
        frozen = tuple(random.choice(TURNS, 3).tolist()) if random.random() < 0.3 else (0, 0, 0)
        spans = [_span(random) for _ in range(3)]
        joints.append(Joint.degrees(f"j{number}", (0, 0, bone), frozen, (0, 0, 0), *spans))
    return Chain(joints)


def _span(random: np.random.Generator) -> Span:
    """No limit, a fixed axis, one of hardly any width, the whole turn, or any."""
    kind = int(random.integers(6))
    low, high = sorted(random.uniform(-180.0, 180.0, 2).tolist())
    spans: tuple[Span, ...] = (None, (low, low), (low, min(low + 1e-8, 180.0)), (-180.0, 180.0))
    return spans[kind] if kind < len(spans) else (low, high)


def _goals(chain: Chain, random: np.random.Generator) -> Array:
    """A goal on the root, on a joint, a hair beside it, far off, and anywhere."""
    rest, _ = forward_kinematics(chain, np.clip(chain.rest, chain.low, chain.high))
    joint = rest[random.integers(len(rest))]
    way = random.normal(size=3)
    return np.stack([rest[0], joint, joint + 1e-10, 1e6 * way, 0.4 * chain.length * way])
