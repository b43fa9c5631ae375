"""What a scene says of solver, pole and orientations must fit together."""

from collections.abc import Iterator

from limbik.core.errors import Fault
from limbik.core.scenegoals import turn_paths
from limbik.core.scenemodel import SolveModel
from limbik.core.settings import misfits_in_2d
from limbik.core.whole import OWN_SOLVERS
from limbik.core.yamlfile import Document, KeyPath


def solver_faults(model: SolveModel, document: Document) -> Iterator[Fault]:
    """Check that a pole is there for the 2D solver and only for it, and no option of the other."""
    if model.solver != "2d":
        if model.pole is not None:
            message = "belongs to the 2D solver"
            hint = "add 'solver: 2d'"
            yield document.fault("solver", message, ("pole",), hint=hint, at_key=True)
        return
    if model.pole is None:
        message = "the 2D solver needs a pole"
        hint = "add 'pole: {position: [x, y, z]}'"
        yield document.fault("missing", message, ("solver",), hint=hint)
    for key, code, message in misfits_in_2d(model.options):
        place: KeyPath = ("options", key)
        yield document.fault(code, message, place, at_key=code == "solver")
    if model.pole is None or model.pole.rotor:
        return
    for path in turn_paths(model):
        message = "nothing turns with this goal; it moves a pole rotor"
        hint = "add 'rotor: arm' or 'rotor: leg' to the pole"
        yield document.fault("solver", message, path, hint=hint)


def turn_faults(model: SolveModel, turns_end: bool, document: Document) -> Iterator[Fault]:
    """Check that what solves goals with an orientation turns the end; a trajectory plans it too."""
    if turns_end or model.is_planned or model.solver == "2d":
        return
    if model.solver in OWN_SOLVERS and model.options.end_orientation:
        return
    for path in turn_paths(model):
        message = "its orientation has no effect: the scene's solver goes to positions alone"
        hint = "choose a solver of pose goals, see 'limbik plugins', or set end_orientation"
        yield document.fault("solver", message, path, hint=hint)
