"""The solver `refine`: any chain of six turning axes or more, by damped Newton steps (M-13).

A goal without an orientation is solved for its position alone. `PoseSolver` is the same from
Python:

```python
import numpy as np
from limbik import PoseSolver

solver = PoseSolver(chain, tolerance=1e-6, angle=1e-6)
solution = solver.solve([0.5, 0.4, 0.1], np.eye(3))
print(solution.status.label, solution.distance, solution.rotation_error)
```
"""

from collections.abc import Iterable
from math import radians
from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from limbik.core.chain import Chain
from limbik.core.errors import ChainError, Fault, InputError
from limbik.core.hooks import hookimpl
from limbik.core.posegoals import PoseBatch, PoseSolution
from limbik.core.rotation import Array
from limbik.core.settings import Settings
from limbik.core.solution import Status
from limbik.core.solveinput import checked
from limbik.core.strategy import Degrees, Strategy
from limbik.plugins.solvers.refine.hinges import read_hinges, read_joints, read_span

NAME = "refine"
LEAST_HINGES = 6
PRECISION = 1e-9  # share of the size, and angle [rad], at which a descent stops
SIZE = 0.5  # share of the chain's length that counts as much as a radian
SQUARE = 1e-6  # largest error of RᵀR that is taken for rounding of the input


class Search(NamedTuple):
    """How exactly and how long it searches."""

    angle: Annotated[
        float, Field(gt=0.0, le=180.0, description="that counts as reached [deg]"), Degrees
    ] = 0.01
    weight: Annotated[
        float, Field(ge=0.0, le=1.0, description="of the orientation; 0 = position alone")
    ] = 1.0
    steps: Annotated[int, Field(ge=1, le=1000, description="most steps of a descent")] = 60
    starts: Annotated[int, Field(ge=0, le=100_000, description="tried beside the pose before")] = (
        100
    )


class PoseSolver(PoseBatch):
    """Solves poses of the end for one chain; without state of its own.

    Args:
        chain: Six turning axes or more; also the end joint's own count.
        tolerance: Distance that counts as reached [length].
        angle: Angle that counts as reached [rad].
        weight: Of the orientation, 0 to 1: with less than 1 the end turns that share of the way
            from where the position alone leaves it.
        steps: Most steps of a descent.
        starts: How many are tried beside the pose before.

    Raises:
        ChainError: The chain has fewer turning axes.
        InputError: An argument is out of its range.
    """

    def __init__(
        self,
        chain: Chain,
        tolerance: float = 0.01,
        angle: float = radians(0.01),
        weight: float = 1.0,
        steps: int = 60,
        starts: int = 100,
    ) -> None:
        self.chain, self.tolerance, self.angle = chain, tolerance, angle
        self.weight, self.steps, self.starts = weight, steps, starts
        _check(self)
        self._hinges, self._joints = read_hinges(chain), read_joints(chain)
        count = len(self._joints.joint)
        if count < LEAST_HINGES:
            message = f"needs {LEAST_HINGES} axes that turn, or more; this chain has {count}"
            raise ChainError(f"{NAME} {message}")
        self._span = read_span(self._hinges)
        self._spacing = _spacing(count)

    def solve(
        self, goal: ArrayLike, rotation: ArrayLike | None = None, *, near: ArrayLike | None = None
    ) -> PoseSolution:
        """Put the chain's end on a goal, turned as asked.

        Args:
            goal: World position, (3,) [length].
            rotation: World rotation, (3, 3); None solves for the position alone.
            near: Pose to start from, HPB, (n, 3) [rad]; the rest pose if absent.

        Raises:
            InputError: An array is not finite, has another shape, or is no rotation.
        """
        turned = None if rotation is None else _rotations(rotation, (3, 3))[None]
        place = checked(goal, (3,), "goal")[None]
        found = self._run(place, turned, False, near).single(0)
        assert isinstance(found, PoseSolution)
        return found

    def solve_many(
        self,
        goals: ArrayLike,
        rotations: ArrayLike | None = None,
        *,
        near: ArrayLike | None = None,
    ) -> PoseSolution:
        """Solve goals that have nothing to do with each other; (m, 3) and (m, 3, 3), see `solve`.

        Returns:
            A solution whose arrays have a leading goal axis; bit for bit what `solve` gives.
        """
        return self._run(*_many(goals, rotations), False, near)

    def follow(
        self,
        goals: ArrayLike,
        rotations: ArrayLike | None = None,
        *,
        near: ArrayLike | None = None,
    ) -> PoseSolution:
        """Solve a path in order, each pose from the one before; arguments as of `solve_many`."""
        return self._run(*_many(goals, rotations), True, near)

    def solve_poses(
        self, goals: Array, rotations: Array | None, follow: bool, near: Array | None = None
    ) -> PoseSolution:
        """Solve poses, some without an orientation, see `limbik.core.posegoals.PoseBatch`."""
        return self._run(np.ascontiguousarray(goals, np.float64), rotations, follow, near)

    def _run(
        self, goals: Array, rotations: Array | None, follow: bool, near: ArrayLike | None
    ) -> PoseSolution:
        pose = self.chain.rest
        if near is not None:
            pose = checked(near, (len(self.chain), 3), "near")
        pose = np.clip(pose, self.chain.low, self.chain.high)
        start = pose[self._joints.joint, self._hinges.axis]
        asked = np.full((len(goals), 3, 3), np.nan)
        if rotations is not None and self.weight > 0.0:
            asked[:] = rotations
            if self.weight < 1.0:
                alone = self._solved(goals, np.full_like(asked, np.nan), follow, start)
                asked = _between(alone.rotations[:, -1], asked, self.weight)
        return self._solved(goals, asked, follow, start)

    def _solved(self, goals: Array, rotations: Array, follow: bool, start: Array) -> PoseSolution:
        from limbik.plugins.solvers.refine.place import Poses
        from limbik.plugins.solvers.refine.search import Effort, solve_goals

        length = SIZE * self.chain.length
        tolerance, angle = float(self.tolerance), float(self.angle)
        aimed = min(PRECISION, 0.5 * tolerance / length, 0.5 * angle)
        effort = Effort(tolerance, angle, aimed, length, self.steps, self.starts)
        count, joints = len(goals), len(self.chain)
        poses = Poses(
            np.empty((count, joints, 3)),
            np.empty((count, joints, 3)),
            np.empty((count, joints, 3, 3)),
        )
        numbers = np.empty((count, 5))
        fixed = self._hinges, self._joints, self._span, effort, self._spacing
        solve_goals(*fixed, goals, rotations, follow, start.copy(), poses, numbers)
        status, starts = numbers[:, :2].astype(np.int64).T
        errors, jumped = numbers[:, 3].copy(), numbers[:, 4] > 0.0
        rows = zip(status.tolist(), errors.tolist(), jumped.tolist(), strict=True)
        return PoseSolution(
            self.chain,
            goals,
            *poses,
            starts,
            numbers[:, 2].copy(),
            status,
            np.zeros((count, 3)),
            np.zeros(count),
            notes=tuple(self._note(*row) for row in rows),
            goal_rotation=rotations,
            rotation_error=errors,
            jumped=jumped,
        )

    def _note(self, status: int, error: float, jumped: bool) -> str:
        """Write what a reader should know beside the status."""
        if jumped:
            return "another fold than before"
        off = status != Status.REACHED and error > self.angle
        return f"turned off by {np.degrees(error):.3g}°" if off else ""


def _check(solver: PoseSolver) -> None:
    """Refuse what cannot be solved with; scenes are checked before."""
    for name, fits, right in (
        ("tolerance", 0.0 < solver.tolerance < np.inf, "above 0"),
        ("angle", 0.0 < solver.angle <= np.pi, "above 0, at most π"),
        ("weight", 0.0 <= solver.weight <= 1.0, "0 to 1"),
        ("steps", solver.steps >= 1, "1 or more"),
        ("starts", solver.starts >= 0, "0 or more"),
    ):
        if not fits:
            message = f"must be {right}, not {getattr(solver, name)}"
            raise InputError(Fault("range", message, name))


def _spacing(count: int) -> Array:
    """Return steps of a sequence that fills a box of so many sides evenly, shares of the sides.

    Powers of the generalised golden ratio, the root of x^(count + 1) = x + 1.
    """
    root = 2.0
    for _ in range(64):
        root = (1.0 + root) ** (1.0 / (count + 1))
    return np.asarray((1.0 / root) ** np.arange(1.0, count + 1.0))


def _many(goals: ArrayLike, rotations: ArrayLike | None) -> tuple[Array, Array | None]:
    places = checked(goals, (None, 3), "goals")
    if rotations is None:
        return places, None
    return places, _rotations(rotations, (len(places), 3, 3))


def _rotations(values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return rotation matrices, checked.

    Raises:
        InputError: They have another shape, or are no rotations.
    """
    turned = checked(values, shape, "rotations" if len(shape) > 2 else "rotation")
    skew = float(np.abs(np.swapaxes(turned, -1, -2) @ turned - np.eye(3)).max(initial=0.0))
    if skew > SQUARE or (np.linalg.det(turned) < 0.0).any():
        message = "columns must have length 1, stand at right angles and not mirror"
        raise InputError(f"rotation: its {message} (RᵀR is off by {skew:.2g})")
    return turned


def _between(first: Array, second: Array, share: float) -> Array:
    """Return rotations a share of the short way from some to others, (m, 3, 3); NaN stays."""
    from limbik.core.rotation import matrix_to_quaternion, quaternion_to_matrix
    from limbik.plugins.paths.quaternions import slerp

    asked = ~np.isnan(second[:, 0, 0])
    mixed = second.copy()
    ends = matrix_to_quaternion(first[asked]), matrix_to_quaternion(second[asked])
    mixed[asked] = quaternion_to_matrix(slerp(np.full(int(asked.sum()), share), *ends))
    return mixed


def prepare(chain: Chain, settings: Settings, params: Search) -> PoseSolver:
    """Make the solver ready.

    Raises:
        ChainError: The chain has fewer than six turning axes.
    """
    return PoseSolver(chain, settings.tolerance, **params._asdict())


@hookimpl
def limbik_solvers() -> Iterable[Strategy]:
    """Offer the solver."""
    return [Strategy(NAME, prepare, Search, "Position and orientation, six axes or more.")]
