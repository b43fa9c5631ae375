"""Chains the tests share, and hypothesis strategies for chains, goals and settings.

The strategies mix uniform numbers with nearly degenerate and exactly degenerate ones.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st

from limbik.core.chain import Chain, Joint
from limbik.core.pose import forward_kinematics
from limbik.core.registry import Registry
from limbik.core.rotation import Array as Array
from limbik.core.settings import Settings
from limbik.core.solution import Solution
from limbik.core.solver import Solver

REGISTRY = Registry(third_party=False)
Z = (0.0, 0.0, 1.0)


def ball(*bones: float) -> Chain:
    """Return a chain of free joints along Z."""
    return Chain([Joint(f"j{k}", (0.0, 0.0, bone)) for k, bone in enumerate((0.0, *bones))])


def arm() -> Chain:
    """Return the golden cases' arm: 74 long, its elbow bends by pitch."""
    return Chain(
        [
            Joint.degrees(
                "shoulder", heading=(-130.0, 60.0), pitch=(-85.0, 85.0), bank=(-90.0, 90.0)
            ),
            Joint.degrees(
                "elbow",
                (0.0, 0.0, 30.0),
                heading=(0.0, 0.0),
                pitch=(0.0, 145.0),
                bank=(-80.0, 80.0),
            ),
            Joint.degrees(
                "wrist",
                (0.0, 0.0, 26.0),
                heading=(-30.0, 30.0),
                pitch=(-70.0, 70.0),
                bank=(0.0, 0.0),
            ),
            Joint.degrees("hand", (0.0, 0.0, 18.0), heading=(0, 0), pitch=(0, 0), bank=(0, 0)),
        ]
    )


ARM_OPTIONS: dict[str, Any] = {
    "bend_vector": {"use": "manual", "angle": 180.0},
    "reference_axis": "y-",
}
"""With them the arm bends the way its elbow can."""


def solver(chain: Chain, **options: Any) -> Solver:
    """Return a solver of the bare document's stages, with the built-in strategies only."""
    return Solver(chain, Settings(**({"finish": "none"} | options)), REGISTRY)


LIMB = ball(20.0, 20.0, 20.0)
GOAL = np.array([12.0, 9.0, 30.0])


def solve(chain: Chain = LIMB, goal: Any = GOAL, fk: Any = None, **options: Any) -> Solution:
    return solver(chain, **options).solve(goal, fk_offsets=fk)


def stages(
    chain: Chain = LIMB, goal: Any = GOAL, fk: Any = None, **options: Any
) -> dict[str, Array]:
    """Return angles [deg] by stage."""
    found = solver(chain, **options).solve(goal, fk_offsets=fk, trace=True)
    assert found.trace is not None
    return {stage.name: np.degrees(stage.angles) for stage in found.trace}


def rotations(angles: Array, chain: Chain = LIMB) -> Array:
    return forward_kinematics(chain, np.radians(angles))[1]


def reachable(chain: Chain, count: int, seed: int) -> Array:
    """Return ends of random poses inside the limits, (count, 3)."""
    rng = np.random.default_rng(seed)
    low = np.maximum(chain.low, -np.pi)
    high = np.minimum(chain.high, np.pi)
    positions, _ = forward_kinematics(chain, rng.uniform(low, high, (count, len(chain), 3)))
    ends: Array = positions[:, -1]
    return ends


def degrees_between(one: Array, other: Array) -> Array:
    """Return the angle between vectors along the last axis [deg]."""
    sine = np.linalg.norm(np.cross(one, other), axis=-1)
    angle: Array = np.degrees(np.arctan2(sine, np.sum(np.multiply(one, other), axis=-1)))
    return angle


def joint(name: str, offset: tuple[float, float, float], *spans: Any) -> Joint:
    """Return a joint with limits of heading, pitch and bank [deg]."""
    return Joint.degrees(name, offset, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), *spans)


ANGLES = st.one_of(
    st.floats(-180.0, 180.0),
    st.sampled_from([0.0, 90.0, -90.0, 180.0, -180.0, 1e-9, 90.0 - 1e-7, 179.9999999]),
)
ROUGH = st.floats(-170.0, 170.0).map(lambda value: round(value, 1))
BONES = st.one_of(st.floats(1.0, 30.0), st.sampled_from([10.0, 10.0, 1e-3, 1e-9, 0.0]))


@st.composite
def spans(draw: st.DrawFn) -> tuple[float, float] | None:
    """Draw a limit [deg]: none, wide, narrow, a point, the whole turn."""
    if draw(st.booleans()):
        return None
    low, high = sorted((draw(ANGLES), draw(ANGLES)))
    kind = draw(st.sampled_from(["as drawn", "fixed", "narrow", "whole"]))
    if kind == "fixed":
        return low, low
    if kind == "narrow":
        return low, min(low + 1e-8, 180.0)
    return (-180.0, 180.0) if kind == "whole" else (low, high)


@st.composite
def chains(draw: st.DrawFn, generic: bool = False) -> Chain:
    """Draw a chain of 3 to 6 joints; a generic one has long bones and rough angles."""
    count = draw(st.integers(3, 6))
    angle = ROUGH if generic else ANGLES
    bone = st.floats(5.0, 20.0).map(lambda value: round(value, 2)) if generic else BONES
    joints = []
    for number in range(count):
        turned = draw(st.booleans())
        limits = [draw(spans()) for _ in range(3)] if not generic else [_wide(draw) for _ in "hpb"]
        joints.append(
            Joint.degrees(
                f"j{number}",
                (0.0, 0.0, draw(bone) if number else 0.0),
                (draw(angle), draw(angle), draw(angle)) if turned and not generic else (0, 0, 0),
                (0.0, 0.0, 0.0),
                *limits,
            )
        )
    if not sum(each.offset[2] for each in joints) > 1e-3:
        joints.append(Joint("tip", (0.0, 0.0, 10.0)))
    return Chain(joints)


def _wide(draw: st.DrawFn) -> tuple[float, float] | None:
    """Draw a wide range whose ends are not equally far from its middle: no goal lies between."""
    if draw(st.booleans()):
        return None
    low = draw(st.integers(20, 170))
    return -low, draw(st.integers(20, 170).filter(lambda high: high != low))


@st.composite
def goals(draw: st.DrawFn, chain: Chain) -> tuple[float, float, float]:
    """Draw a goal: anywhere, on a joint of the rest pose, a hair beside it, behind the base."""
    positions, _ = forward_kinematics(chain, np.clip(chain.rest, chain.low, chain.high))
    kind = draw(st.sampled_from(["anywhere", "joint", "beside", "behind", "far"]))
    if kind == "anywhere":
        reach = st.floats(-chain.length, chain.length)
        return draw(reach), draw(reach), draw(reach)
    place = positions[draw(st.integers(0, len(chain) - 1))]
    if kind == "beside":
        place = np.add(place, [1e-10, 0.0, 1e-12])
    elif kind == "behind":
        place = 2.0 * positions[0] - positions[-1]
    elif kind == "far":
        place = 1e6 * (place - positions[0]) + [0.0, 1.0, 0.0]
    x, y, z = place.tolist()
    return x, y, z


CONES = st.fixed_dictionaries(
    {
        "axis": st.sampled_from(["x+", "x-", "y+", "y-", "z+", "z-"]),
        "half_angle": st.floats(1.0, 90.0),
        "entry": st.sampled_from(["stop", "go-around"]),
    }
)
BEND_VECTORS = st.one_of(
    st.fixed_dictionaries(
        {"use": st.just("manual"), "angle": ANGLES, "exclude_bank": st.booleans()}
    ),
    st.fixed_dictionaries({"use": st.just("auto"), "strength": st.floats(0.0, 1.0)}),
    st.fixed_dictionaries(
        {"use": st.just("global"), "direction": st.sampled_from([(0.3, 1.0, 0.2), Z, (-1, 0, 0)])}
    ),
)
OPTIONS = st.fixed_dictionaries(
    {"max_iterations": st.sampled_from([-2, -1, 0, 1, 20]), "smoothing": st.floats(0.1, 1.0)},
    optional={
        "max_violations": st.integers(0, 3),
        "held": st.fixed_dictionaries({"base": st.integers(0, 1), "end": st.integers(0, 1)}),
        "bend_vector": BEND_VECTORS,
        "root_control": st.sampled_from(["none", "suppress-flip", "prefer-flip"]),
        "bank_suppression": st.fixed_dictionaries(
            {
                "use": st.just("threshold"),
                "heading_correction": st.booleans(),
                "all_stages": st.booleans(),
            }
        ),
        "coefficient_base": st.floats(0.0, 2.0),
        "weight_range": st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
        "bend_reference": st.integers(1, 2),
        "reference_axis": st.sampled_from(["free", "x+", "x-", "y+", "y-"]),
        "twist": ANGLES,
        "aim_twist": st.booleans(),
        "off_axis": st.booleans(),
        "aim_from": st.sampled_from(["initial", "previous"]),
        "bank_lock": st.booleans(),
        "forbidden_cone": CONES,
        "bend_smoothing": st.floats(0.0, 45.0),
        "reach_limit": st.booleans(),
        "clamp": st.sampled_from(["re-aim", "plain"]),
        "fk_mix": st.floats(0.0, 1.0),
        "initial_bend": st.sampled_from(["nth-root", "solved-arc", "uniform-arc", "two-bone"]),
        "finish": st.sampled_from(["none", "newton"]),
        "start": st.sampled_from(["bend", "current"]),
        "soft_zone": st.floats(0.0, 0.2),
        "end_orientation": st.floats(0.0, 1.0),
        "limit_ease": st.floats(0.0, 90.0),
    },
)

POSE_ARM = """\
limbik: 1
solver: refine
chain:
  joints:
    - {name: shoulder, heading: [-120, 120], pitch: [-90, 90], bank: [-90, 90]}
    - {name: elbow, offset: [0, 0, 3], heading: 0, pitch: [0, 150], bank: 0, rest: [0, 60, 0]}
    - {name: wrist, offset: [0, 0, 3], heading: [-80, 80], pitch: [-80, 80], bank: [-80, 80]}
    - {name: hand, offset: [0, 0, 1], heading: 0, pitch: 0, bank: 0}
"""
"""Head of a scene: an arm that takes position and orientation."""


def interpreted(code: str) -> Any:
    """Run code without the compiler; return what it prints as JSON."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
