"""What trajectories take from scipy, imported on first use; scipy is an extra."""

from functools import cache
from typing import Any

from limbik.core.errors import EnvironmentProblem

_MISSING = "trajectories need scipy: pip install 'limbik[trajectory]'"


@cache
def cubic_spline_class() -> Any:
    """Return `scipy.interpolate.CubicSpline`.

    Raises:
        EnvironmentProblem: scipy is not installed.
    """
    try:
        from scipy.interpolate import CubicSpline
    except ImportError as error:
        raise EnvironmentProblem(_MISSING) from error
    return CubicSpline


@cache
def rotation_class() -> Any:
    """Return `scipy.spatial.transform.Rotation`; raises as `cubic_spline_class`."""
    try:
        from scipy.spatial.transform import Rotation
    except ImportError as error:
        raise EnvironmentProblem(_MISSING) from error
    return Rotation
