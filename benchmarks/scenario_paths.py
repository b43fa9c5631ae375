"""Write the goal paths of the scenes in configs/scenarios, in lengths of the limb.

python benchmarks/scenario_paths.py
"""

from collections.abc import Callable
from math import asin, cos, pi, radians, sin, sqrt
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parents[1] / "configs" / "scenarios"
RATE = 60

Point = tuple[float, float, float]


def walk(t: float) -> Point:
    """Foot from the hip: 1.1 s a cycle, 60 % of it on the ground at 0.985 to 0.995 of the leg."""
    half, stance = 0.175, 0.6
    phase = t / 1.1 % 1.0
    if phase < stance:
        along, lift = half - 2.0 * half * phase / stance, 0.0
    else:
        u = (phase - stance) / (1.0 - stance)
        pull = 2.0 * half * (1.0 - stance) / stance  # the ground's speed, so that nothing jerks
        rise = 3.0 * u**2 - 2.0 * u**3
        along = half * (2.0 * rise - 1.0) - pull * (2.0 * u**3 - 3.0 * u**2 + u)
        lift = 0.12 * sin(pi * u) ** 2
    reach = 0.99 + 0.005 * cos(2.0 * pi * phase / stance) * (phase < stance)
    reach += 0.005 * (phase >= stance)
    return 0.0, -sqrt(reach**2 - along**2) + lift, along


def across(t: float) -> Point:
    """Hand across the body in 3 s and back."""
    turn = pi * (t if t <= 3.0 else 6.0 - t) / 3.0
    return 0.62 * cos(turn) - 0.15, -0.15, 0.30 + 0.35 * sin(turn)


def circle(t: float) -> Point:
    """Round the shoulder in the sagittal plane in 4 s."""
    return 0.0, 0.8 * sin(pi * t / 2.0), 0.8 * cos(pi * t / 2.0)


def through(height: float) -> Callable[[float], Point]:
    """From front to back past the root in 2 s."""
    return lambda t: (0.0, height, 0.9 * cos(pi * t / 2.0))


def extension(t: float) -> Point:
    """0.85 to 1.15 of the reach and back in 2 s."""
    distance = 1.0 + 0.15 * sin(pi * (t - 0.5))
    return 0.36 * distance, -0.48 * distance, 0.8 * distance


def bow(t: float) -> Point:
    """Tip of an upright spine in a figure, 4 s."""
    return 0.45 * sin(pi * t / 2.0), 0.8, 0.1 * sin(pi * t)


def floor(t: float) -> Point:
    """Tip from upright down to the height of the root in an arc, 3 s."""
    return 0.0, 0.9 * cos(pi * t / 6.0), 0.9 * sin(pi * t / 6.0)


def sink(t: float) -> Point:
    """Tip of a spine sinking deeper than its joints allow and back, 4 s."""
    return 0.02 * sin(2.0 * pi * t), 0.80 + 0.13 * cos(pi * t / 2.0), 0.0


def nod(t: float) -> Point:
    """Tip of an upright spine that stays where it is but for a breath, 2 s."""
    return 0.0, 0.93 + 0.01 * sin(pi * t), 0.0


def bar(t: float) -> Point:
    """Left hand on a bar that turns 35 degrees each way, from a shoulder that leans, 4 s.

    The shoulder is 0.25 beside the spine, whose tip leans 0.15 forward; the bar turns about its
    middle, 0.7 in front of the upright spine's tip and 0.1 below.
    """
    lean, turn = 0.15 * sin(pi * t / 2.0), radians(35.0) * sin(pi * t)
    tilt = asin(lean)
    hand = 0.25 * cos(turn), -0.1 + 0.25 * sin(turn), 0.7
    x, y, z = hand[0] - 0.25, hand[1] + 1.0 - cos(tilt), hand[2] - lean
    return x, y * cos(tilt) + z * sin(tilt), z * cos(tilt) - y * sin(tilt)


def planted(t: float) -> Point:
    """A planted foot as a pelvis sees it that circles in 2 s, radius 0.08."""
    return 0.08 * cos(pi * t), -0.93, 0.08 * sin(pi * t)


def round_trip(count: int = 50, straight: int = 10) -> list[Point]:
    """Ends of random arms, the first of them dead straight."""
    rng = np.random.default_rng(10)
    way = rng.normal(size=(count, 3))
    far = np.where(np.arange(count) < straight, 1.0, rng.uniform(0.3, 0.98, count))
    way *= (far / np.linalg.norm(way, axis=1))[:, None]
    return [(x, y, z) for x, y, z in way.tolist()]


def overhead(t: float) -> Point:
    """Hand from the front over the shoulder to the back and again to the front, 4 s."""
    turn = 0.75 * pi * (1.0 - cos(pi * t / 2.0)) / 2.0
    return 0.05, 0.8 * sin(turn), 0.8 * cos(turn)


def keys(count: int = 120) -> list[Point]:
    """Places all over the reach, in no order."""
    rng = np.random.default_rng(9)
    way = rng.normal(size=(count, 3))
    way *= (rng.uniform(0.2, 0.95, count) / np.linalg.norm(way, axis=1))[:, None]
    return [(x, y, z) for x, y, z in way.tolist()]


def sampled(path: Callable[[float], Point], seconds: float) -> list[Point]:
    return [path(frame / RATE) for frame in range(round(seconds * RATE) + 1)]


def write(name: str, points: list[Point]) -> None:
    rows = [f"{k},{x:.6f},{y:.6f},{z:.6f}" for k, (x, y, z) in enumerate(points)]
    text = "\n".join(["name,x,y,z", *rows]).replace("-0.000000", "0.000000") + "\n"
    (FOLDER / f"{name}.csv").write_text(text, encoding="utf-8")


def main() -> None:
    write("walk", sampled(walk, 2.2))
    write("across", sampled(across, 6.0))
    write("circle", sampled(circle, 4.0))
    write("through", sampled(through(-0.15), 2.0))
    write("through-root", sampled(through(-0.001), 2.0))
    write("extension", sampled(extension, 2.0))
    write("bow", sampled(bow, 4.0))
    write("floor", sampled(floor, 3.0))
    write("sink", sampled(sink, 4.0))
    write("overhead", sampled(overhead, 4.0))
    write("keys", keys())
    write("nod", sampled(nod, 2.0))
    write("bar", sampled(bar, 4.0))
    write("planted", sampled(planted, 2.0))
    write("round-trip", round_trip())


if __name__ == "__main__":
    main()
