"""The scenes limbik ships, and what opens them."""

from collections.abc import Callable
from pathlib import Path

from limbik.plugins.viewer.session import Session

CONFIGS = Path(__file__).parents[2] / "configs"
Opened = Callable[[str], Session]
"""Opens one of them by its name."""
