"""Bake the legs of a recorded walk and hold them to the recording: docs/bodies.md.

python benchmarks/walk.py CLIP [FIRST LAST]

CLIP is a BVH file with LeftUpLeg, LeftLeg, LeftFoot and the same on the right below Hips, such as
those of the CMU motion capture database; an added T-pose in frame 0 is left out. Measured are
JUDGING's numbers for limbs against mocap: the swivel of the knee, its distance, planted feet.
"""

import argparse
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from limbik.core.baking import bake_body
from limbik.core.bodyscene import BodyScene, body_from
from limbik.core.formats import BodyBake
from limbik.core.motion import joint_steps, popping
from limbik.core.registry import Registry
from limbik.core.rotation import Array, matrix_to_hpb
from limbik.core.yamlfile import read_yaml
from limbik.plugins.formats.bvh import read_bvh

BENT = 0.05  # frames count for the swivel where the knee is so far off the line [leg lengths]
STILL = 0.1  # a foot is planted below this speed [leg lengths/s]
REGISTRY = Registry(third_party=False)
# Poles of the left leg, in the pelvis at rest; the right leg has their images. The carried one fits
# the left leg best in hindsight, the other fits both legs.
AHEAD = "solver: 2d, frame: Hips, pole: {position: [SIDE9, -5, 100], rotor: ROTOR}"
CARRIED = "solver: 2d, frame: Hips, pole: {position: [SIDE31, 82, 48], rotor: {twist: 1, tilt: 1}}"
EXACT = "{initial_bend: two-bone}"
SOFT = "{initial_bend: two-bone, soft_zone: 0.003, tolerance: 0.03}"  # 0.2 % of the leg
KINDS = {
    "3d, manual": ("solver: 3d", EXACT),
    "2d, pole in the pelvis": (AHEAD.replace("ROTOR", "null"), EXACT),
    "2d, rotor that follows hip and foot": (AHEAD.replace("ROTOR", "leg"), EXACT),
    "2d, rotor that tilts with the foot": (CARRIED, EXACT),
    "2d, the same with a soft zone": (CARRIED, SOFT),
}


def scene_of(clip: Path, frames: tuple[int, int], solver: str, options: str) -> BodyScene:
    """Both legs, each ankle along its path in the clip."""
    text = f"limbik: 1\nskeleton: {{bvh: '{clip}', frames: [{frames[0]}, {frames[1]}]}}\nchains:\n"
    for name, side in (("Left", ""), ("Right", "-")):
        text += f"- {{name: {name}, base: {name}UpLeg, end: {name}Foot, options: {options}, "
        text += f"{solver.replace('SIDE', side)}}}\n"
    return body_from(read_yaml(text, "walk.yaml"), Path(), REGISTRY)


def off_line(places: Array) -> Array:
    """The knee's way off the line hip to ankle, (m, 3)."""
    line = places[:, 2] - places[:, 0]
    line = line / np.linalg.norm(line, axis=1, keepdims=True)
    knee = places[:, 1] - places[:, 0]
    return np.asarray(knee - (knee * line).sum(-1, keepdims=True) * line)


def angles_between(first: Array, second: Array) -> Array:
    """Angles between vectors (m, 3) [deg]."""
    sine = np.linalg.norm(np.cross(first, second), axis=1)
    return np.asarray(np.degrees(np.arctan2(sine, (first * second).sum(1))))


def report(scene: BodyScene, bake: BodyBake) -> None:
    """Print a line a leg."""
    recorded, _ = scene.skeleton.motion.world()
    for part in scene.parts:
        at = list(part.limb.at)
        real, solved = recorded[:, at], bake.solutions[part.name].positions
        length = part.scene.chain.length
        ours, theirs = off_line(solved), off_line(real)
        bent = np.linalg.norm(theirs, axis=1) > BENT * length
        swivel = angles_between(ours, theirs)[bent]
        knee = 100.0 * np.linalg.norm(solved[:, 1] - real[:, 1], axis=1) / length
        speed = np.linalg.norm(np.diff(real[:, 2], axis=0), axis=1) / bake.frame_time / length
        planted = np.append(speed < STILL, False)
        slide = 100.0 * np.linalg.norm(solved[:, 2] - real[:, 2], axis=1)[planted] / length
        own = matrix_to_hpb(scene.skeleton.motion.turns[:, at])
        metrics = bake.metrics[part.name]
        own_pops = int(popping(joint_steps(own)).any(axis=1).sum())
        shown = [
            f"{metrics['reached']} of {metrics['frames']} reached",
            f"pops {len(metrics['pops'])} (in the clip {own_pops})",
            f"swivel {_percentiles(swivel, 50, 95, 100)} deg",
            f"knee off by {_percentiles(knee, 50, 95, 100)} %",
            f"{planted.sum()} planted frames slide {slide.max():.1g} %",
        ]
        print(f"  {part.name:6} {', '.join(shown)}")


def _percentiles(values: Array, *shares: float) -> str:
    return " / ".join(f"{np.percentile(values, share):.1f}" for share in shares)


def main() -> None:
    """Bake by each kind of bend and print figures and times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clip", type=Path)
    parser.add_argument("frames", type=int, nargs="*")
    given = parser.parse_args()
    first, last = given.frames or (1, len(read_bvh(given.clip).frames) - 1)
    for kind, solved in KINDS.items():
        scene = scene_of(given.clip, (first, last), *solved)
        bake = bake_body(scene, REGISTRY)
        times = []
        for _ in range(7):
            start, used = perf_counter(), process_time()
            bake_body(scene, REGISTRY)
            times.append((perf_counter() - start, process_time() - used))
        wall, used = (1000.0 * min(column) for column in zip(*times, strict=True))
        print(
            f"{kind}: {len(bake.motion.turns)} frames in {wall:.0f} ms, {used:.0f} ms of one core"
        )
        report(scene, bake)


if __name__ == "__main__":
    main()
