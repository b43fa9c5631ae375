"""Joint motion: every sample solved in order, and what is wrong with it, by time and place (J-07).

Goals are the positions of the samples. Their orientations are taken over by the end joint as far
as `end_orientation` and its limits let it; `orientation_error` tells what is left.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import AXES
from limbik.core.errors import Fault, InputError
from limbik.core.rotation import Array, matrix_to_hpb
from limbik.core.solution import Continuity, Solution, Status
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.plugins.paths.quaternions import from_matrix, half_angle, short_way
from limbik.plugins.paths.samples import Samples

Kind = Literal["out-of-reach", "blocked", "stopped", "limit", "speed"]
ROUNDING = 1e-9  # [rad]
TURN = 2.0 * np.pi
_KINDS: dict[Status, Kind] = {
    Status.OUT_OF_REACH: "out-of-reach",
    Status.BLOCKED: "blocked",
    Status.STOPPED: "stopped",
}
_WORDS = {
    "out-of-reach": "out of reach",
    "blocked": "blocked by joint limits",
    "stopped": "not reached",
}


@dataclass(frozen=True, slots=True)
class Failure:
    """Neighbouring samples with one thing wrong.

    Attributes:
        kind: `out-of-reach`, `blocked`, `stopped` (all three not reached), `limit` or `speed`.
        first, last: Indices of the samples.
        start, end: Their times [s].
        position: The goal where it is worst, (x, y, z) [length].
        worst: There: distance left [length], angle past the limit [rad], or speed [rad/s].
        allowed: What would be right: tolerance, 0, or the speed limit.
        joint: Joint and axis, such as `elbow pitch`; empty if it is the end.
    """

    kind: Kind
    first: int
    last: int
    start: float
    end: float
    position: tuple[float, float, float]
    worst: float
    allowed: float
    joint: str = ""

    def __str__(self) -> str:
        where = "({:.4g}, {:.4g}, {:.4g})".format(*self.position)
        when = f"{self.start:.4g} s" if self.first == self.last else f"{self.span} s"
        return f"{when} at {where}: {self._what()}"

    @property
    def span(self) -> str:
        """Start and end [s] as text."""
        return f"{self.start:.4g} to {self.end:.4g}"

    def _what(self) -> str:
        worst, allowed = np.degrees((self.worst, self.allowed))
        if self.kind == "speed":
            return f"{self.joint} turns at {worst:.4g}°/s, at most {allowed:.4g}°/s"
        if self.kind == "limit":
            return f"{self.joint} is {worst:.3g}° past its limit"
        return f"{_WORDS[self.kind]}, {self.worst:.3g} away, at most {self.allowed:.3g}"


@dataclass(frozen=True, eq=False)
class JointMotion:
    """Angles along a trajectory.

    Attributes:
        samples: What was asked for.
        angles: HPB without jumps of a full turn, (m, n, 3) [rad].
        solution: What the solver gave.
        failures: What is wrong, in the order of time; empty if nothing is.
    """

    samples: Samples
    angles: Array
    solution: Solution
    failures: tuple[Failure, ...]

    @property
    def speeds(self) -> Array:
        """Rates of the angles between samples, (m, n, 3) [rad/s]; the first are the second's."""
        return _rates(self.samples.times, self.angles)

    @property
    def orientation_error(self) -> Array:
        """Angle between the end's orientation and the one asked for, (m,) [rad]."""
        found = from_matrix(self.solution.rotations[:, -1])
        return 2.0 * half_angle(found, short_way(found, self.samples.quaternions))


def joint_motion(
    samples: Samples,
    solver: Solver,
    speed_limits: Mapping[str, float] | None = None,
    continuity: Continuity | None = None,
) -> JointMotion:
    """Solve every sample of a trajectory with the continuity of the one before, and check it.

    Args:
        samples: The trajectory.
        solver: Chain and options.
        speed_limits: Largest speed of a joint's axes by the joint's name [rad/s].
        continuity: State before the first sample.

    Raises:
        InputError: A speed limit names no joint or is not above 0.
        PluginError: A strategy failed.
    """
    allowed = _allowed(solver, speed_limits or {})
    turns = matrix_to_hpb(samples.rotations) if solver.settings.end_orientation else None
    solution = solver.follow(samples.positions, continuity=continuity, goal_turns=turns)
    angles = _unwound(solver, solution.angles)
    found = [
        *_unreached(samples, solver, solution),
        *(() if isinstance(solver, Solver2D) else _past_limits(samples, solver, solution.angles)),
        *_too_fast(samples, solver, angles, allowed),
    ]
    ordered = tuple(sorted(found, key=lambda failure: (failure.first, failure.joint)))
    return JointMotion(samples, angles, solution, ordered)


def _allowed(solver: Solver, limits: Mapping[str, float]) -> Array:
    allowed: Array = np.full(len(solver.chain), np.inf)
    for name, limit in limits.items():
        if name not in solver.chain.names:
            message = f"no joint is called '{name}'; known: {', '.join(solver.chain.names)}"
            raise InputError(Fault("unknown-joint", message, key="joint_speeds"))
        if not limit > 0.0:
            message = f"the speed limit of '{name}' must be above 0, not {limit:g}"
            raise InputError(Fault("range", message, key="joint_speeds"))
        allowed[solver.chain.names.index(name)] = limit
    return allowed


def _unwound(solver: Solver, angles: Array) -> Array:
    """Take jumps of full turns out of the axes that may turn all round (D-10)."""
    free = solver.chain.high - solver.chain.low >= TURN - 1e-6
    return np.where(free, np.unwrap(angles, axis=0), angles)


def _unreached(samples: Samples, solver: Solver, solution: Solution) -> list[Failure]:
    distance, status = np.asarray(solution.distance), np.asarray(solution.status)
    found: list[Failure] = []
    for number, kind in _KINDS.items():
        found += _runs(kind, status == number, distance, solver.settings.tolerance, "", samples)
    return found


def _past_limits(samples: Samples, solver: Solver, angles: Array) -> list[Failure]:
    past = np.maximum(angles - solver.chain.high, solver.chain.low - angles)
    return _by_axis("limit", past > ROUNDING, past, np.zeros(len(solver.chain)), solver, samples)


def _too_fast(samples: Samples, solver: Solver, angles: Array, allowed: Array) -> list[Failure]:
    if not np.isfinite(allowed).any():
        return []
    speeds = np.abs(_rates(samples.times, angles))
    fast = speeds > allowed[:, None] * (1.0 + ROUNDING)
    return _by_axis("speed", fast, speeds, allowed, solver, samples)


def _rates(times: Array, angles: Array) -> Array:
    if len(times) < 2:
        return np.zeros_like(angles)
    gaps = np.maximum(np.diff(times), 1e-300)
    rates = np.diff(angles, axis=0) / gaps[:, None, None]
    return np.concatenate([rates[:1], rates])


def _by_axis(
    kind: Kind, wrong: NDArray[np.bool_], sizes: Array, allowed: Array, solver: Solver, at: Samples
) -> list[Failure]:
    found: list[Failure] = []
    for joint, axis in np.argwhere(wrong.any(axis=0)).tolist():
        name = f"{solver.chain.names[joint]} {AXES[axis]}"
        limit = float(allowed[joint])
        found += _runs(kind, wrong[:, joint, axis], sizes[:, joint, axis], limit, name, at)
    return found


def _runs(
    kind: Kind, wrong: NDArray[np.bool_], sizes: Array, allowed: float, joint: str, at: Samples
) -> list[Failure]:
    """Make one failure of each run of neighbouring samples."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], wrong, [False]]).astype(np.int8)))
    found = []
    for first, behind in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        worst = first + int(sizes[first:behind].argmax())
        x, y, z = at.positions[worst].tolist()
        times = float(at.times[first]), float(at.times[behind - 1])
        size = float(sizes[worst])
        found.append(Failure(kind, first, behind - 1, *times, (x, y, z), size, allowed, joint))
    return found


def degrees_to_limits(speeds: Mapping[str, float]) -> dict[str, float]:
    """Return speed limits given in degrees per second in radians."""
    return {name: radians(speed) for name, speed in speeds.items()}
