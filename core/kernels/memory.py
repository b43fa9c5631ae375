"""What a solve keeps for the next one: the rows of a continuity, (n + 4, 3)."""

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Body
from limbik.core.kernels.rotation import Vector, vector
from limbik.core.rotation import Array

AIM_BASE, AIM_ROOT = 0, 1  # angles of base and bend root in the aim pose, HPB [rad]; 3D only
LINE = 0  # unit vector base to goal, world; 2D only
BEND = 2  # bend vector, world
FLAGS = 3  # HAS_POSE and HAS_PLANE: 1 where there is one, else 0
ANGLES = 4  # the first joint's angles in the finished pose, HPB [rad]; the others' follow

HAS_POSE, HAS_PLANE = 0, 1  # columns of FLAGS


@kernel
def has_pose(memory: Array) -> bool:
    """Return whether there was a solve before."""
    return bool(memory[FLAGS, HAS_POSE] > 0.0)


@kernel
def angles_before(joint: int, body: Body, memory: Array) -> Vector:
    """Return a joint's angles in the pose of the solve before, without one those at rest."""
    if has_pose(memory):
        return vector(memory, ANGLES + joint)
    return vector(body.rest, joint)
