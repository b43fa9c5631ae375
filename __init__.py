"""Inverse kinematics of limbs, spines and robot arms with plug-in strategies."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from limbik.core.body import BodyChain as BodyChain
    from limbik.core.body import BodySolver as BodySolver
    from limbik.core.bodyscene import read_body as read_body
    from limbik.core.chain import Chain as Chain
    from limbik.core.chain import Joint as Joint
    from limbik.core.controller import Controller as Controller
    from limbik.core.errors import LimbikError as LimbikError
    from limbik.core.hooks import hookimpl as hookimpl
    from limbik.core.match import Match as Match
    from limbik.core.match import convert_bend_vector as convert_bend_vector
    from limbik.core.match import match_fk as match_fk
    from limbik.core.match import match_ik as match_ik
    from limbik.core.pole import Pole as Pole
    from limbik.core.pole import PoleRotor as PoleRotor
    from limbik.core.registry import Registry as Registry
    from limbik.core.scene import read_scene as read_scene
    from limbik.core.settings import Settings as Settings
    from limbik.core.skeleton import JointSkeleton as JointSkeleton
    from limbik.core.solution import Continuity as Continuity
    from limbik.core.solution import Solution as Solution
    from limbik.core.solution import Status as Status
    from limbik.core.solver import Solver as Solver
    from limbik.core.solver2d import Solver2D as Solver2D
    from limbik.core.solving import solve_scene as solve_scene
    from limbik.core.strategy import Strategy as Strategy
    from limbik.plugins.solvers.refine.solver import PoseSolver as PoseSolver

__version__ = "0.1.0"

# Public names load on first use, so that `import limbik` stays light. The imports are absolute
# on purpose: pytest imports this file once more under the name of the checkout's folder.
_PUBLIC = {
    "BodyChain": "limbik.core.body",
    "BodySolver": "limbik.core.body",
    "Chain": "limbik.core.chain",
    "Continuity": "limbik.core.solution",
    "Controller": "limbik.core.controller",
    "Joint": "limbik.core.chain",
    "JointSkeleton": "limbik.core.skeleton",
    "Pole": "limbik.core.pole",
    "PoleRotor": "limbik.core.pole",
    "PoseSolver": "limbik.plugins.solvers.refine.solver",
    "LimbikError": "limbik.core.errors",
    "Match": "limbik.core.match",
    "Registry": "limbik.core.registry",
    "Settings": "limbik.core.settings",
    "Solution": "limbik.core.solution",
    "Solver": "limbik.core.solver",
    "Solver2D": "limbik.core.solver2d",
    "Status": "limbik.core.solution",
    "Strategy": "limbik.core.strategy",
    "convert_bend_vector": "limbik.core.match",
    "hookimpl": "limbik.core.hooks",
    "match_fk": "limbik.core.match",
    "match_ik": "limbik.core.match",
    "read_body": "limbik.core.bodyscene",
    "read_scene": "limbik.core.scene",
    "solve_scene": "limbik.core.solving",
}
__all__ = list(_PUBLIC)


def __getattr__(name: str) -> Any:
    """Load a public name on first use."""
    if name in _PUBLIC:
        return getattr(import_module(_PUBLIC[name]), name)
    raise AttributeError(f"module 'limbik' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*globals(), *_PUBLIC])
