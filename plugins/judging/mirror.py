"""Whether left and right are mirror images."""

from dataclasses import replace

import numpy as np

from limbik.core.errors import ChainError
from limbik.core.frames import Y_UP, mirror_hpb
from limbik.core.solver2d import Solver2D
from limbik.plugins.judging.run import NotJudged, Run


def asymmetry(run: Run) -> float:
    """Largest distance of a joint from its mirror image's, over the reach [-]."""
    if run.turns is not None and isinstance(run.solver, Solver2D):
        raise NotJudged("goals that turn a pole rotor are not mirrored")
    turns = None if run.turns is None else mirror_hpb(run.turns)
    try:
        solver = run.solver.mirrored()
    except ChainError as why:
        reason = why.faults[0].message
        raise NotJudged(f"the solver does not take the mirrored chain: {reason}") from None
    mirrored = replace(run, fk_offsets=mirror_hpb(run.fk_offsets))
    image = mirrored.solve(Y_UP.points(run.goals), turns, solver).positions
    apart = Y_UP.points(image) - run.solution.positions
    return float(np.linalg.norm(apart, axis=2).max() / run.reach)
