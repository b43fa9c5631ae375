"""Write configs/walk.bvh, a walking clip made of arithmetic: two cycles at 30 frames a second.

python benchmarks/walk_clip.py

A body of 175 cm. The planted foot stands still, the swinging one lifts; knees and ankles follow by
the law of cosines. Right-handed, Y up, Z forward, X to the left, centimetres, as clips have it.
"""

from math import acos, atan2, degrees, hypot, pi, sin
from pathlib import Path

FILE = Path(__file__).parents[1] / "configs" / "walk.bvh"
RATE, CYCLE, CYCLES = 30, 1.1, 2
BONE, HIP, HALF, STANCE, LIFT = 43.0, 83.5, 15.0, 0.6, 9.0
SPEED = 2.0 * HALF / (STANCE * CYCLE)  # [cm/s]
# Name, offset from the joint before, how many of the open joints end after it, offset of its end.
BODY = [
    ("Hips", "0 0 0", 0, ""),
    ("LeftUpLeg", "9 -4 0", 0, ""),
    ("LeftLeg", f"0 {-BONE:g} 0", 0, ""),
    ("LeftFoot", f"0 {-BONE:g} 0", 3, "0 -6 13"),
    ("RightUpLeg", "-9 -4 0", 0, ""),
    ("RightLeg", f"0 {-BONE:g} 0", 0, ""),
    ("RightFoot", f"0 {-BONE:g} 0", 3, "0 -6 13"),
    ("Spine", "0 8 0", 0, ""),
    ("Chest", "0 18 0", 0, ""),
    ("Head", "0 30 0", 1, "0 20 0"),
    ("LeftArm", "18 24 0", 0, ""),
    ("LeftForeArm", "0 -30 0", 0, ""),
    ("LeftHand", "0 -26 0", 3, "0 -8 0"),
    ("RightArm", "-18 24 0", 0, ""),
    ("RightForeArm", "0 -30 0", 0, ""),
    ("RightHand", "0 -26 0", 6, "0 -8 0"),
]


def foot(phase: float) -> tuple[float, float, float]:
    """Forward and upward way of the ankle from the hip [cm], and the pitch of the foot [deg]."""
    if phase < STANCE:
        return HALF - 2.0 * HALF * phase / STANCE, -HIP + 4.0, 0.0
    u = (phase - STANCE) / (1.0 - STANCE)
    pull = 2.0 * HALF * (1.0 - STANCE) / STANCE  # the ground's speed, so that nothing jerks
    along = HALF * (2.0 * (3.0 * u**2 - 2.0 * u**3) - 1.0) - pull * (2.0 * u**3 - 3.0 * u**2 + u)
    lift = sin(pi * u) ** 2
    return along, -HIP + 4.0 + LIFT * lift, 25.0 * lift * (1.0 - u)


def leg(phase: float) -> list[float]:
    """Turns about X of hip, knee and ankle [deg]."""
    along, up, pitch = foot(phase)
    swing, bend = atan2(along, -up), acos(hypot(along, up) / (2.0 * BONE))
    hip, knee = -degrees(swing + bend), degrees(2.0 * bend)
    return [hip, knee, pitch - hip - knee]


def row(time: float) -> list[float]:
    """All channels of one frame."""
    phase = time / CYCLE % 1.0
    swing = sin(2.0 * pi * (phase + 0.1))
    turns = [0.0, *leg(phase), *leg((phase + 0.5) % 1.0), 2.0, 3.0, -4.0]
    turns += [22.0 * swing, -25.0 - 10.0 * swing, 0.0, -22.0 * swing, -25.0 + 10.0 * swing, 0.0]
    values = [0.0, HIP + 6.0, SPEED * time]
    for joint, turn in zip(BODY, turns, strict=True):
        twist = {"Spine": -3.0 * swing, "Chest": -4.0 * swing, "Head": 7.0 * swing}
        values += [0.0, turn, twist.get(joint[0], 0.0)]
    return values


def text() -> str:
    """The whole file."""
    lines, depth = ["HIERARCHY"], 0
    for name, offset, closed, site in BODY:
        tab = "  " * depth
        moves = "6 Xposition Yposition Zposition" if depth == 0 else "3"
        lines += [f"{tab}{'JOINT' if depth else 'ROOT'} {name}", f"{tab}{{"]
        lines += [f"{tab}  OFFSET {offset}"]
        lines += [f"{tab}  CHANNELS {moves} Zrotation Xrotation Yrotation"]
        depth += 1
        if site:
            lines += [f"{tab}  End Site", f"{tab}  {{", f"{tab}    OFFSET {site}", f"{tab}  }}"]
        for _ in range(closed):
            depth -= 1
            lines.append(f"{'  ' * depth}}}")
    lines += ["}"] * depth
    count = round(CYCLES * CYCLE * RATE)
    lines += ["MOTION", f"Frames: {count}", f"Frame Time: {1.0 / RATE:.9f}"]
    for frame in range(count):
        numbers = (f"{value:.6f}".rstrip("0").rstrip(".") for value in row(frame / RATE))
        lines.append(" ".join("0" if number == "-0" else number for number in numbers))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
