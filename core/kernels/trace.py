"""The poses a solve passes through, kept for who asks."""

from limbik.core.jit import kernel
from limbik.core.kernels.layout import Pose
from limbik.core.kernels.rotation import matrix, matrix_to_hpb, nearest_form, store_vector, vector
from limbik.core.rotation import Array


@kernel
def record(stages: int, pose: Pose, trace: Array) -> int:
    """Keep the pose's angles in the trace while it has room; return the stages so far."""
    if stages >= trace.shape[0]:
        return stages
    for joint in range(pose.angles.shape[0]):
        angles = vector(pose.angles, joint)
        if pose.free[joint]:
            # Read only: what is traced must not change what is solved.
            angles = nearest_form(matrix_to_hpb(matrix(pose.relative, joint), angles[2]), angles)
        store_vector(angles, trace[stages], joint)
    return stages + 1
