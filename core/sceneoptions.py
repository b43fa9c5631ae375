"""Options of a scene must fit its joints and its goals."""

from collections.abc import Iterable, Iterator, Sequence

from limbik.core.errors import Fault
from limbik.core.scenegoals import Goals, axes_faults
from limbik.core.scenemodel import SceneModel, SolveModel
from limbik.core.scenesolver import solver_faults
from limbik.core.settings import joint_tables, narrowing
from limbik.core.wording import near_match
from limbik.core.yamlfile import Document, KeyPath


def option_faults(
    names: Sequence[str],
    limited: Sequence[str],
    model: SolveModel,
    goals: Goals,
    document: Document,
) -> Iterator[Fault]:
    """Check the options that only make sense together with a chain of these joints.

    Args:
        names: Of the joints.
        limited: Of those with limits of their own.
        model: What is asked for.
        goals: The goals.
        document: Where the model came from.
    """
    yield from solver_faults(model, document)
    yield from axes_faults(model, document)
    yield from _end_faults(model, goals, document)
    if limited:
        yield from _limit_faults(limited, model, document)
    options, count = model.options, len(names)
    if count < 2:
        return
    for path, table in joint_tables(options):
        yield from unknown_joints(table, names, ("options", *path), document)
    least = 0 if model.solver == "2d" else 1
    if not least <= options.bend_reference < count:
        message = f"must be {least} to {count - 1} in a chain of {count} joints"
        found = f"{message}, not {options.bend_reference}"
        yield document.fault("range", found, ("options", "bend_reference"))
    held = options.held.base + options.held.end
    if held >= count:
        message = f"{held} joints are held, the chain has {count} and one must stay free"
        yield document.fault("held", message, ("options", "held"))


def unknown_joints(
    given: Iterable[str], names: Sequence[str], path: KeyPath, document: Document
) -> Iterator[Fault]:
    """Check that the keys of a mapping are joints."""
    for name in given:
        if name not in names:
            hint = near_match(name, list(names)) or f"known: {', '.join(names[:12])}"
            message = f"no joint is called '{name}'"
            yield document.fault("unknown-joint", message, (*path, name), hint=hint, at_key=True)


def _limit_faults(limited: Sequence[str], model: SolveModel, document: Document) -> Iterator[Fault]:
    """A joint with a limit of its own fits neither the 2D solver nor options that narrow ranges."""
    if model.solver == "2d":
        message = "belongs to the 3D solver; give the joint a 'planar' range"
        joints = model.chain.joints if isinstance(model, SceneModel) else []
        owners = [number for number, joint in enumerate(joints) if joint.limit is not None]
        for number in owners:
            place: KeyPath = ("chain", "joints", number, "limit")
            yield document.fault("solver", message, place, at_key=True)
        if not owners:
            message = f"'{limited[0]}' has a limit of its own, which belongs to the 3D solver"
            yield document.fault("solver", message, ("solver",))
    for option in narrowing(model.options):
        message = f"narrows ranges, but '{limited[0]}' has a limit of its own in place of ranges"
        yield document.fault("limit", message, ("options", option), at_key=True)


def _end_faults(model: SolveModel, goals: Goals, document: Document) -> Iterator[Fault]:
    """An end can take over the goals' orientation only where a goal has one."""
    if (
        not model.options.end_orientation
        or model.is_planned
        or goals.faults
        or goals.turns is not None
    ):
        return
    listed = isinstance(model.goals, list)
    hint = "give the goals a 'rotation'" if listed else "see docs/goal-files.md"
    message = "no goal has a rotation that the end could take over"
    yield document.fault("no-rotation", message, ("options", "end_orientation"), hint=hint)
