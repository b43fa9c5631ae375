"""Sessions of the scenes limbik ships."""

import pytest

from limbik.core.bodyscene import read_any
from limbik.core.registry import Registry
from limbik.plugins.viewer.session import Session
from limbik.tests.viewer.scenes import CONFIGS, Opened


@pytest.fixture(scope="session")
def registry() -> Registry:
    return Registry()


@pytest.fixture
def opened(registry: Registry) -> Opened:
    """Open one of the shipped scenes by its name."""
    return lambda name: Session(read_any(CONFIGS / f"{name}.yaml", registry), registry)
