"""Whatever is asked, poses are poses, keep their limits, and the status is true.

`benchmarks/robustness.py` asks 10,000 cases.
"""

from limbik.core.registry import Registry
from limbik.tests.fuzz import fuzz

WRONGS = ("infinite", "skewed", "stretched", "unlimited", "false")


def test_random_chains_goals_and_poles_give_sound_poses() -> None:
    tally = fuzz(600, 12, Registry(third_party=False))
    assert {wrong: tally[wrong] for wrong in WRONGS} == dict.fromkeys(WRONGS, 0)
    assert tally["cases"] == 600
    for label in ("reached", "stopped", "out-of-reach", "blocked"):
        assert tally[label] > 0
