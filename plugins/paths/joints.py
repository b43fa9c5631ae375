"""Joint motion: every sample solved in order, and what is wrong with it, by time and place (J-07).

A solver of pose goals, such as `refine`, is given position and orientation; any other one the
positions, and its end joint takes the orientations over as far as `end_orientation` and its limits
let it. How far the end's orientation differs is told by `orientation_error`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import AXES, Chain
from limbik.core.errors import Fault, InputError
from limbik.core.posegoals import PoseBatch, PoseSolution
from limbik.core.rotation import Array, matrix_to_hpb, matrix_to_quaternion
from limbik.core.solution import Continuity, Solution, Status
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.plugins.paths.quaternions import half_angle, short_way
from limbik.plugins.paths.samples import Samples

Kind = Literal["out-of-reach", "blocked", "stopped", "jump", "limit", "speed"]
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
        kind: `out-of-reach`, `blocked`, `stopped` (all three not reached), `jump` (no way leads on
            from the pose before), `limit` or `speed`.
        first, last: Indices of the samples.
        start, end: Their times [s].
        position: The goal where it is worst, (x, y, z) [length].
        worst: There: distance left [length], angle jumped or past the limit [rad], or speed
            [rad/s].
        allowed: What would be right: tolerance, 0, or the speed limit.
        joint: Joint and axis, such as `elbow pitch`; empty if it is the end.
        turned: Largest angle left to the orientation [rad], where the end is not on a pose goal.
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
    turned: float = 0.0

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
        if self.kind == "jump":
            return f"the arm has to change its fold: {self.joint} jumps by {worst:.3g}°"
        aside = f", turned off by {np.degrees(self.turned):.3g}°" if self.turned else ""
        return f"{_WORDS[self.kind]}, {self.worst:.3g} away, at most {self.allowed:.3g}{aside}"


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
    def is_posed(self) -> bool:
        """Whether the orientation was solved for."""
        return isinstance(self.solution, PoseSolution)

    @property
    def orientation_error(self) -> Array:
        """Angle between the end's orientation and the one asked for, (m,) [rad]."""
        found = matrix_to_quaternion(self.solution.rotations[:, -1])
        return 2.0 * half_angle(found, short_way(found, self.samples.quaternions))


def joint_motion(
    samples: Samples,
    solver: Solver | PoseBatch,
    speed_limits: Mapping[str, float] | None = None,
    continuity: Continuity | None = None,
) -> JointMotion:
    """Solve every sample of a trajectory with the continuity of the one before, and check it.

    Args:
        samples: The trajectory.
        solver: Chain and options; a solver of pose goals solves the orientation too.
        speed_limits: Largest speed of a joint's axes by the joint's name [rad/s].
        continuity: State before the first sample.

    Raises:
        InputError: A speed limit names no joint or is not above 0.
        PluginError: A strategy failed.
    """
    chain = solver.chain
    allowed = _allowed(chain, speed_limits or {})
    solution, tolerance = _solved(samples, solver, continuity)
    angles = _unwound(chain, solution.angles)
    in_plane = isinstance(solver, Solver2D)
    found = [
        *_unreached(samples, solution, tolerance),
        *_jumps(samples, solution, angles),
        *(() if in_plane else _past_limits(samples, chain, solution.angles)),
        *_too_fast(samples, chain, angles, allowed),
    ]
    ordered = tuple(sorted(found, key=lambda failure: (failure.first, failure.joint)))
    return JointMotion(samples, angles, solution, ordered)


def _solved(
    samples: Samples, solver: Solver | PoseBatch, continuity: Continuity | None
) -> tuple[Solution, float]:
    """Return the solution of all samples and the distance that counts as reached [length]."""
    if isinstance(solver, Solver):
        turns = matrix_to_hpb(samples.rotations) if solver.settings.end_orientation else None
        found = solver.follow(samples.positions, continuity=continuity, goal_turns=turns)
        return found, solver.settings.tolerance
    near = None if continuity is None else continuity.angles
    posed = solver.solve_poses(samples.positions, samples.rotations, True, near)
    return posed, solver.tolerance


def _allowed(chain: Chain, limits: Mapping[str, float]) -> Array:
    allowed: Array = np.full(len(chain), np.inf)
    for name, limit in limits.items():
        if name not in chain.names:
            message = f"no joint is called '{name}'; known: {', '.join(chain.names)}"
            raise InputError(Fault("unknown-joint", message, key="joint_speeds"))
        if not limit > 0.0:
            message = f"the speed limit of '{name}' must be above 0, not {limit:g}"
            raise InputError(Fault("range", message, key="joint_speeds"))
        allowed[chain.names.index(name)] = limit
    return allowed


def _unwound(chain: Chain, angles: Array) -> Array:
    """Take jumps of full turns out of the axes that may turn all round (D-10)."""
    free = chain.high - chain.low >= TURN - 1e-6
    return np.where(free, np.unwrap(angles, axis=0), angles)


def _unreached(samples: Samples, solution: Solution, tolerance: float) -> list[Failure]:
    distance, status = np.asarray(solution.distance), np.asarray(solution.status)
    turned = np.zeros(len(samples))
    if isinstance(solution, PoseSolution):
        turned = np.asarray(solution.rotation_error)
    found: list[Failure] = []
    for number, kind in _KINDS.items():
        for run in _runs(kind, status == number, distance, tolerance, "", samples):
            largest = float(turned[run.first : run.last + 1].max())
            found.append(replace(run, turned=largest))
    return found


def _jumps(samples: Samples, solution: Solution, angles: Array) -> list[Failure]:
    if not isinstance(solution, PoseSolution):
        return []
    steps = np.abs(np.diff(angles, axis=0, prepend=angles[:1]))
    found: list[Failure] = []
    for row in np.flatnonzero(solution.jumped).tolist():
        joint, axis = np.unravel_index(steps[row].argmax(), steps[row].shape)
        name = f"{solution.chain.names[joint]} {AXES[axis]}"
        here = np.arange(len(samples)) == row
        found += _runs("jump", here, steps[:, joint, axis], 0.0, name, samples)
    return found


def _past_limits(samples: Samples, chain: Chain, angles: Array) -> list[Failure]:
    past = np.maximum(angles - chain.high, chain.low - angles)
    return _by_axis("limit", past > ROUNDING, past, np.zeros(len(chain)), chain, samples)


def _too_fast(samples: Samples, chain: Chain, angles: Array, allowed: Array) -> list[Failure]:
    if not np.isfinite(allowed).any():
        return []
    speeds = np.abs(_rates(samples.times, angles))
    fast = speeds > allowed[:, None] * (1.0 + ROUNDING)
    return _by_axis("speed", fast, speeds, allowed, chain, samples)


def _rates(times: Array, angles: Array) -> Array:
    if len(times) < 2:
        return np.zeros_like(angles)
    gaps = np.maximum(np.diff(times), 1e-300)
    rates = np.diff(angles, axis=0) / gaps[:, None, None]
    return np.concatenate([rates[:1], rates])


def _by_axis(
    kind: Kind, wrong: NDArray[np.bool_], sizes: Array, allowed: Array, chain: Chain, at: Samples
) -> list[Failure]:
    found: list[Failure] = []
    for joint, axis in np.argwhere(wrong.any(axis=0)).tolist():
        name = f"{chain.names[joint]} {AXES[axis]}"
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
