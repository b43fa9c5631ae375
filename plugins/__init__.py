"""limbik's own plug-ins, one strategy or format a file; they use the same hooks as anyone's."""

BUILT_IN = (
    "limbik.plugins.initial_bend.nth_root",
    "limbik.plugins.initial_bend.solved_arc",
    "limbik.plugins.initial_bend.uniform_arc",
    "limbik.plugins.initial_bend.two_bone",
    "limbik.plugins.bend_vector.manual",
    "limbik.plugins.bend_vector.auto",
    "limbik.plugins.bend_vector.global_",
    "limbik.plugins.root_control.none",
    "limbik.plugins.root_control.suppress_flip",
    "limbik.plugins.root_control.prefer_flip",
    "limbik.plugins.bank_suppression.none",
    "limbik.plugins.bank_suppression.threshold",
    "limbik.plugins.limits.cone",
    "limbik.plugins.finish.none",
    "limbik.plugins.finish.newton",
    "limbik.plugins.formats.urdf_chain",
    "limbik.plugins.formats.bvh_chain",
    "limbik.plugins.formats.tables",
    "limbik.plugins.formats.bvh_out",
    "limbik.plugins.formats.glb",
    "limbik.plugins.solvers.cosine_arm.solver",
    "limbik.plugins.solvers.fabrik.solver",
    "limbik.plugins.solvers.lambda_leg.solver",
    "limbik.plugins.solvers.planar.solver",
)
"""Modules the registry loads first; a new one is added here."""
