"""A turn past a limit stops at the nearer end, and a mix goes the short way round."""

from typing import Any

import numpy as np
import pytest

from limbik.core.chain import Chain, Joint
from limbik.tests.limbs import joint, solver


@pytest.mark.parametrize("clamp", ["plain", "re-aim"])
@pytest.mark.parametrize(("start", "asked", "stops"), [(160, 182, 170), (-10, -100, -20)])
def test_a_turn_over_180_degrees_stops_at_the_limit_it_runs_into(
    clamp: str, start: float, asked: float, stops: float
) -> None:
    """Wrapped to -178° it would be cut to the far end of -20°..170°."""
    hinge = Joint.degrees(
        "hinge",
        rest=(start, 0.0, 0.0),
        heading=(-20.0, 170.0),
        pitch=(-80.0, 80.0),
        bank=(0.0, 0.0),
    )
    chain = Chain([hinge, Joint("tip", (0.0, 0.0, 10.0))])
    heading = np.radians(asked)
    goal = [-10.0 * np.sin(heading), 0.0, 10.0 * np.cos(heading)]
    solution = solver(chain, max_iterations=-1, clamp=clamp).solve(goal)
    assert np.degrees(solution.angles[0]) == pytest.approx([stops, 0.0, 0.0], abs=1e-9)


def test_a_free_axis_of_a_limited_joint_is_mixed_the_short_way_round() -> None:
    """The bank has no range: halfway from 170° to -170° is 180°, not 0° (3D A-45)."""
    limits: Any = ((-30.0, 30.0), (-30.0, 30.0), None)
    chain = Chain(
        [
            joint("root", (0.0, 0.0, 0.0), *limits),
            Joint("a", (0, 0, 10.0)),
            Joint("b", (0, 0, 10.0)),
        ]
    )
    offsets = np.radians([[0.0, 0.0, -170.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    options: dict[str, Any] = {"reference_axis": "free", "twist": 170.0, "aim_twist": True}
    aim = {"max_iterations": -1, "fk_strength": 0.0}
    twisted = solver(chain, **options, **aim).solve((0.0, 0.0, 15.0), fk_offsets=offsets)
    assert np.degrees(twisted.angles[0, 2]) == pytest.approx(170.0)
    mixed = solver(chain, **options, **aim, fk_mix=0.5).solve((0, 0, 15.0), fk_offsets=offsets)
    assert abs(np.degrees(mixed.angles[0, 2])) == pytest.approx(180.0)
