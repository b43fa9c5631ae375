"""What bars a step at joints' own limits: directions square to each other, then the joint holds."""

import numpy as np
import pytest

from limbik.core.kernels.own import LIMIT
from limbik.core.rotation import Array
from limbik.plugins.finish import bars
from limbik.plugins.finish.linkage import (
    ACTIVE,
    AXES,
    BARRED,
    KNOWN,
    OWN,
    OWN_MARGIN,
    ROOM,
    TRIAL,
    WAY,
    WIDTH,
)

OUT = np.array([[1.0, 0.0, 0.0], [0.8, 0.6, 0.0], [0.0, 0.6, 0.8]])


def row() -> Array:
    """One joint with a limit that may turn all ways."""
    scratch = np.random.default_rng(1).normal(size=(1, WIDTH))
    bars.forget(scratch)
    bars.unbar(0, scratch)
    scratch[0, ACTIVE : ACTIVE + 3] = scratch[0, OWN + LIMIT] = 1.0
    return scratch


def test_no_motion_is_left_along_any_direction_that_was_barred_and_the_third_holds() -> None:
    scratch = row()
    for count, out in enumerate(OUT[:2], 1):
        bars._bar(tuple(out), 0, scratch)
        motions = scratch[0, AXES : AXES + 9].reshape(3, 3)
        np.testing.assert_allclose(OUT[:count] @ motions, 0.0, atol=1e-12)
        np.testing.assert_allclose(OUT[:count] @ scratch[0, WAY : WAY + 3], 0.0, atol=1e-12)
        assert np.linalg.norm(motions) > 0.1
    basis = scratch[0, BARRED : BARRED + 6].reshape(2, 3)
    np.testing.assert_allclose(basis @ basis.T, np.eye(2), atol=1e-12)
    bars._bar(tuple(OUT[2]), 0, scratch)
    assert not scratch[0, ACTIVE : ACTIVE + 3].any()


def test_a_direction_that_is_barred_already_holds_the_joint() -> None:
    scratch = row()
    for _ in range(2):
        bars._bar(tuple(OUT[0]), 0, scratch)
    assert not scratch[0, ACTIVE : ACTIVE + 3].any()


def test_a_limit_is_asked_only_about_what_is_not_known(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    monkeypatch.setattr(bars, "own_task", lambda task, *_: asked.append(task))
    scratch = row()
    scratch[0, ROOM] = 0.1
    assert not bars.bar_ways_out(scratch)
    scratch[0, KNOWN : KNOWN + 3] = scratch[0, TRIAL : TRIAL + 3] = OUT[1]
    assert bars.bar_ways_out(scratch)
    assert not asked
    scratch[0, OWN_MARGIN] = -0.2
    bars.accept(scratch)
    assert not scratch[0, KNOWN : KNOWN + 6].any()
    assert scratch[0, ROOM] == -0.2
    bars.bar_ways_out(scratch)
    assert len(asked) == 1
