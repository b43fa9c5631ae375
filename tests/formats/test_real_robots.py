"""Real robots move as an independent reader says, chain by chain and as a whole."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import body_motion
from limbik.core.frames import Z_UP
from limbik.plugins.formats.urdf_chain import inspect, rest_value
from limbik.plugins.formats.urdf_skeleton import UrdfSkeleton, UrdfSkeletonModel, read_skeleton

REAL = {
    "arm7": ("limbik", "configs/arm7.urdf"),
    "humanoid": ("limbik", "configs/humanoid.urdf"),
    "jvrc1": ("jvrc_description", "urdf/jvrc1.urdf"),
    "iiwa": ("pybullet_data", "kuka_iiwa/model.urdf"),
    "panda": ("pybullet_data", "franka_panda/panda.urdf"),
    "laikago": ("pybullet_data", "laikago/laikago_toes.urdf"),
    "a1": ("pybullet_data", "a1/a1.urdf"),
}


def real_robot(name: str) -> Path:
    """A robot limbik ships, or one of an installed package."""
    package, file = REAL[name]
    if package == "limbik":
        return Path(__file__).parents[2] / file
    found = find_spec(package)
    if found is None:
        pytest.skip(f"{package} is not installed")
    return Path(str(found.origin)).parent / file


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", REAL)
def test_a_real_robot_moves_as_yourdfpy_says(name: str) -> None:
    """Its longest chain over 1,000 configurations, to 1e-9; the whole robot over 20."""
    yourdfpy = pytest.importorskip("yourdfpy")
    path = real_robot(name)
    robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=True)
    skeleton = read_skeleton(UrdfSkeletonModel(urdf=str(path), rest={}), Path())
    limbs = [(base, end, skeleton.limb(base, end)) for base, end, _ in inspect(path).chains]
    base, end, limb = max(limbs, key=lambda found: len(found[2].chain))
    angles = np.random.default_rng(1).uniform(-3.0, 3.0, (1000, len(limb.chain), 3))
    angles = np.clip(angles, limb.chain.low, limb.chain.high)
    values = limb.values(angles)
    assert values is not None
    motion = body_motion(skeleton, [(limb, angles)], 1.0)
    places, turns = motion.world()
    first, last, root = (motion.names.index(link) for link in (base, end, robot.base_link))
    for k, row in enumerate(values.rows):
        robot.update_cfg({**rest_of(skeleton), **dict(zip(values.names, row, strict=True))})
        checked = ((first, last), *((root, j) for j in range(len(motion.names)) if k < 20))
        for one, other in checked:
            pose = robot.get_transform(motion.names[other], motion.names[one])
            away = turns[k, one].T @ (places[k, other] - places[k, one])
            np.testing.assert_allclose(away, Z_UP.points(pose[:3, 3]), atol=1e-9)
            turn = turns[k, one].T @ turns[k, other]
            np.testing.assert_allclose(turn, Z_UP.rotations(pose[:3, :3]), atol=1e-9)


def rest_of(skeleton: UrdfSkeleton) -> dict[str, float]:
    """Rest values of all hinges; what slides or copies another joint stays at 0."""
    hinges = [joint for joint in skeleton.carriers if joint is not None and joint.is_hinge]
    return {joint.name: 0.0 if joint.mimics else rest_value(joint, {})[0] for joint in hinges}
