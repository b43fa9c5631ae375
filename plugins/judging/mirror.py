"""Whether left and right are mirror images."""

from typing import Any

import numpy as np

from limbik.core.settings import Settings
from limbik.core.solver import Solver
from limbik.core.solver2d import Solver2D
from limbik.plugins.judging.run import NotJudged, Run

MIRROR = np.array([-1.0, 1.0, 1.0])
_MODES = ("manual", "auto", "global")


def mirrored_settings(settings: Settings) -> Settings:
    """Return the options of the mirror image in the world's YZ plane.

    Raises:
        NotJudged: The bend vector is a plug-in's, whose mirror image is not known.
    """
    choice = settings.bend_vector
    vector: dict[str, Any] = {"use": choice} if isinstance(choice, str) else dict(choice)
    if vector["use"] not in _MODES:
        raise NotJudged(f"the mirror image of bend_vector '{vector['use']}' is not known")
    if "angle" in vector:
        vector["angle"] = -vector["angle"]
    if "direction" in vector:
        x, y, z = vector["direction"]
        vector["direction"] = (-x, y, z)
    changes: dict[str, Any] = {"bend_vector": vector, "twist": -settings.twist}
    if settings.reference_axis[0] == "x":
        changes["reference_axis"] = "x-" if settings.reference_axis == "x+" else "x+"
    cone = settings.forbidden_cone
    if cone is not None and cone.axis[0] == "x":
        axis = "x-" if cone.axis == "x+" else "x+"
        changes["forbidden_cone"] = {**cone.model_dump(), "axis": axis}
    if settings.choose is not None and settings.choose.pose is not None:
        pose = {name: (-h, p, -b) for name, (h, p, b) in settings.choose.pose.items()}
        changes["choose"] = {**settings.choose.model_dump(), "pose": pose}
    return Settings(**{**settings.model_dump(exclude_unset=True), **changes})


def asymmetry(run: Run) -> float:
    """Largest distance of a joint from its mirror image's, over the reach [-]."""
    if isinstance(run.solver, Solver2D):
        raise NotJudged("the mirror image of a pole is not solved for")
    settings = mirrored_settings(run.settings)
    solver = Solver(run.chain.mirrored(), settings, run.solver.registry)
    offsets = run.fk_offsets * np.array([-1.0, 1.0, -1.0])
    many = solver.follow if run.follow else solver.solve_many
    image = many(run.goals * MIRROR, fk_offsets=offsets).positions * MIRROR
    return float(np.linalg.norm(image - run.solution.positions, axis=2).max() / run.reach)
