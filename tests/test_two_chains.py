"""Two arms on one spine (JUDGING S7): the spine first, then each arm on the spine's end."""

from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from limbik.core.chain import Chain, Joint
from limbik.core.registry import Registry
from limbik.core.rotation import matrix_to_hpb
from limbik.core.solution import Solution
from limbik.core.solver import Solver

Array = NDArray[np.float64]
REGISTRY = Registry(third_party=False)
FRAMES = 61
MIRROR = np.array([-1.0, 1.0, 1.0])


def spine() -> Solver:
    """Three bones that stand, 1 long."""
    joints = [Joint("hips", frozen=(0, 90, 0)), Joint("waist", (0, 0, 0.4))]
    chain = Chain([*joints, Joint("chest", (0, 0, 0.3)), Joint("neck", (0, 0, 0.3))])
    options: dict[str, Any] = {"initial_bend": "uniform-arc", "tolerance": 1e-4}
    bend = {"use": "global", "direction": (0.0, 0.0, -1.0)}
    return Solver(chain, registry=REGISTRY, bend_vector=bend, **options)


def arm(body: Solution, frame: int, side: float) -> Solver:
    """An arm of length 1, its shoulder 0.25 beside the spine's end."""
    turn = np.degrees(matrix_to_hpb(body.rotations[frame, -1])).tolist()
    joints = [
        Joint("shoulder", (0.25 * side, 0, 0)),
        Joint.degrees("elbow", (0, 0, 0.52), heading=(0, 0), pitch=(0, 145), bank=(0, 0)),
        Joint("wrist", (0, 0, 0.48)),
    ]
    chain = Chain(joints, tuple(body.positions[frame, -1].tolist()), tuple(turn))
    return Solver(
        chain,
        registry=REGISTRY,
        initial_bend="solved-arc",
        tolerance=1e-4,
        reference_axis="y-",
        bend_vector={"use": "global", "direction": (0.3 * side, -1.0, -0.6)},
    )


def motion() -> tuple[Array, Array]:
    """Where the spine's end leans to, and where the hands are: on a bar that turns 35 degrees."""
    t = np.linspace(0.0, 2.0, FRAMES)
    lean = 0.15 * np.sin(pi * t)
    tip = np.stack([0 * t, np.sqrt(0.97**2 - lean**2), lean], axis=1)
    turn = np.radians(35.0) * np.sin(2 * pi * t)
    half = 0.3 * np.stack([np.cos(turn), np.sin(turn), 0 * t], axis=1)
    middle = np.array([0.0, 0.85, 0.65])
    return tip, np.stack([middle + half, middle - half])


def solve_all(tip: Array, hands: Array, sides: tuple[float, ...]) -> tuple[Solution, Array, float]:
    """Solve the spine, then the arms in the order of the sides; angles and the largest miss."""
    body = spine().solve_many(tip)
    angles, miss = np.zeros((2, FRAMES, 3, 3)), float(np.max(body.distance))
    for frame in range(FRAMES):
        for side in sides:
            which = int(side < 0.0)
            found = arm(body, frame, side).solve(hands[which, frame])
            angles[which, frame] = found.angles
            miss = max(miss, float(found.distance))
    return body, angles, miss


def test_both_hands_stay_on_a_turning_bar_while_the_spine_leans() -> None:
    """At most 0.1 % of the length off, in whichever order the arms are solved."""
    tip, hands = motion()
    _, angles, miss = solve_all(tip, hands, (1.0, -1.0))
    _, other_order, _ = solve_all(tip, hands, (-1.0, 1.0))

    assert miss <= 1e-3
    assert angles.tobytes() == other_order.tobytes()


def test_the_mirrored_motion_gives_the_mirrored_body() -> None:
    tip, hands = motion()
    body, angles, _ = solve_all(tip, hands, (1.0, -1.0))
    image, mirrored, _ = solve_all(tip * MIRROR, hands[::-1] * MIRROR, (1.0, -1.0))

    np.testing.assert_allclose(image.positions, body.positions * MIRROR, atol=1e-9)
    np.testing.assert_allclose(mirrored[::-1], angles * [-1.0, 1.0, -1.0], atol=1e-8)
