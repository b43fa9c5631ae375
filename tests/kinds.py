"""Kinds of chains a solver must master: free, limited, hinged, planar, short and long."""

from limbik.core.chain import Chain, Joint
from limbik.tests.limbs import arm

FIXED = (0.0, 0.0)


def ball(joints: int) -> Chain:
    """Free joints, bones of 1."""
    return Chain([Joint(f"j{i}", (0, 0, 1.0 if i else 0.0)) for i in range(joints)])


def leg() -> Chain:
    """A human leg, 98 long; its knee bends one way."""
    turned = (0, -90, 0)
    return Chain(
        [
            Joint.degrees("hip", (10, 0, 0), turned, (0, 0, 0), (-40, 40), (-30, 110), (-45, 45)),
            Joint.degrees("knee", (0, 0, 42), heading=FIXED, pitch=(-145, 0), bank=FIXED),
            Joint.degrees("ankle", (0, 0, 40), heading=FIXED, pitch=(-40, 50), bank=(-20, 20)),
            Joint.degrees("toe", (0, 0, 16), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def six_hinges() -> Chain:
    """An industrial arm."""

    def roll(name: str, along: float, most: float) -> Joint:
        return Joint.degrees(name, (0, 0, along), heading=FIXED, pitch=FIXED, bank=(-most, most))

    def bend(name: str, along: float, low: float, high: float) -> Joint:
        return Joint.degrees(name, (0, 0, along), heading=FIXED, pitch=(low, high), bank=FIXED)

    return Chain(
        [
            roll("base", 0, 170),
            bend("shoulder", 40, -90, 110),
            bend("elbow", 45, -150, 60),
            roll("forearm", 20, 180),
            bend("wrist", 22, -115, 115),
            roll("flange", 8, 180),
            Joint.degrees("tool", (0, 5, 8), heading=FIXED, pitch=FIXED, bank=FIXED),
        ]
    )


def seven_hinges() -> Chain:
    """Roll and bend in turns, as robot arms with an elbow that swings; 100 long."""
    joints = []
    for number, along in enumerate((0, 20, 20, 20, 20, 10, 5)):
        bend = (-120.0, 120.0) if number % 2 else FIXED
        roll = FIXED if number % 2 else (-170.0, 170.0)
        name = f"hinge {number + 1}"
        joints.append(Joint.degrees(name, (0, 0, along), heading=FIXED, pitch=bend, bank=roll))
    return Chain(
        [*joints, Joint.degrees("tool", (0, 3, 4), heading=FIXED, pitch=FIXED, bank=FIXED)]
    )


def spine(joints: int) -> Chain:
    """Joints of 25 degrees about every axis, the root too."""
    bent = (-25, 25)
    return Chain(
        [
            Joint.degrees(f"v{i}", (0, 0, float(i > 0)), heading=bent, pitch=bent, bank=bent)
            for i in range(joints)
        ]
    )


def planar(links: int, low: float, high: float) -> Chain:
    """Hinges of one range in a plane."""
    joints = [
        Joint.degrees(f"j{i}", (0, 0, float(i > 0)), heading=FIXED, pitch=(low, high), bank=FIXED)
        for i in range(links)
    ]
    end = Joint.degrees("end", (0, 0, 1), heading=FIXED, pitch=FIXED, bank=FIXED)
    return Chain([*joints, end])


CHAINS = {
    "ball3": ball(3),
    "ball4": ball(4),
    "ball7": ball(7),
    "ball28": ball(28),
    "arm": arm(),
    "leg": leg(),
    "six hinges": six_hinges(),
    "seven hinges": seven_hinges(),
    "spine8": spine(8),
    "spine24": spine(24),
    "planar3": planar(3, 0, 120),
    "planar4": planar(4, 10, 100),
}
