"""Whether left and right are mirror images."""

import numpy as np

from limbik.core.frames import Y_UP, mirror_hpb
from limbik.plugins.judging.run import NotJudged, Run


def asymmetry(run: Run) -> float:
    """Largest distance of a joint from its mirror image's, over the reach [-]."""
    if run.turned:
        raise NotJudged("goals that turn a pole rotor are not mirrored")
    solver = run.solver.mirrored()
    many = solver.follow if run.follow else solver.solve_many
    image = many(Y_UP.points(run.goals), fk_offsets=mirror_hpb(run.fk_offsets)).positions
    apart = Y_UP.points(image) - run.solution.positions
    return float(np.linalg.norm(apart, axis=2).max() / run.reach)
