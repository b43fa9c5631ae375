"""The hooks by which plug-ins offer strategies and file formats.

Each hook is called once, when the registry loads the plug-in, and returns what it offers; it is
never called during a solve. limbik's own strategies and formats come through the same hooks. The
example of each hook is a whole plug-in: a module with it, named by an entry point of the group
`limbik`, is one.

```toml
[project.entry-points.limbik]
acme = "acme_bends"
```
"""

from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import pluggy

from limbik.core.formats import Output, SceneInput
from limbik.core.strategy import Strategy

PROJECT = "limbik"
"""Name of the pluggy project and of the entry-point group."""

F = TypeVar("F", bound=Callable[..., Any])

hookspec = pluggy.HookspecMarker(PROJECT)
_mark = pluggy.HookimplMarker(PROJECT)


def hookimpl(function: F) -> F:
    """Mark a function of a plug-in as the implementation of the hook of the same name."""
    return _mark(function)


@hookspec
def limbik_initial_bends() -> Iterable[Strategy]:
    """Offer initial-bend methods: how the bones of a limb lie before CCD starts.

    A kernel takes `(lengths, reach_ratio, weights, params, angles)`, see
    `limbik.core.slots.INITIAL_BEND`.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        import math

        import limbik


        def zigzag(lengths, reach_ratio, weights, params, angles):
            bend = math.acos(min(reach_ratio, 1.0))
            for bone in range(angles.shape[0]):
                angles[bone] = (bend if bone % 2 == 0 else -bend) * weights[bone]


        @limbik.hookimpl
        def limbik_initial_bends():
            return [limbik.Strategy("zigzag", zigzag, description="Fold like a ruler.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_bend_vectors() -> Iterable[Strategy]:
    """Offer bend-vector modes: toward which side a limb bends.

    A kernel takes `(frame, aim, end_offset, to_world, bank, previous, params, out)`, see
    `limbik.core.slots.BEND_VECTOR`.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        import limbik


        def sideways(frame, aim, end_offset, to_world, bank, previous, params, out):
            for axis in range(3):
                out[axis] = frame[axis, 0]


        @limbik.hookimpl
        def limbik_bend_vectors():
            return [limbik.Strategy("sideways", sideways, description="Bend along the root's X.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_root_controls() -> Iterable[Strategy]:
    """Offer root controls: limits that hold for one solve only.

    A kernel takes `(root, has_previous, previous, params, low, high)`, see
    `limbik.core.slots.ROOT_CONTROL`. It only narrows the limits.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        from typing import Annotated, NamedTuple

        from pydantic import Field

        import limbik
        from limbik.core.strategy import Degrees


        class Cap(NamedTuple):
            largest: Annotated[float, Field(ge=0, le=180, description="[deg]"), Degrees] = 60.0


        def cap_bank(root, has_previous, previous, params, low, high):
            low[root, 2] = max(low[root, 2], -params.largest)
            high[root, 2] = min(high[root, 2], params.largest)


        @limbik.hookimpl
        def limbik_root_controls():
            return [limbik.Strategy("cap-bank", cap_bank, Cap, "Keep the root's bank small.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_bank_suppressions() -> Iterable[Strategy]:
    """Offer bank suppressions: how a joint's change of angles is cleaned of needless bank.

    A kernel takes `(target, current, pitch, in_ccd, params, delta)`, see
    `limbik.core.slots.BANK_SUPPRESSION`. It runs for each joint of each round: keep it short.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        import limbik


        def halve(target, current, pitch, in_ccd, params, delta):
            if in_ccd == 1:
                delta[2] *= 0.5


        @limbik.hookimpl
        def limbik_bank_suppressions():
            return [limbik.Strategy("halve", halve, description="Let half of the bank pass.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_finishes() -> Iterable[Strategy]:
    """Offer finishes: what ends a solve at its goal after the CCD rounds, within the limits.

    A kernel takes the arguments of `limbik.core.slots.FINISH`: goal, chain, limits, the pose CCD
    ended with, and rows to work in.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        import limbik


        def leave(goal, tolerance, length, offsets, frozen, base_position, base_rotation, low,
                  high, own, reachable, params, angles, scratch, verdict):
            verdict[0] = 0.0


        @limbik.hookimpl
        def limbik_finishes():
            return [limbik.Strategy("leave", leave, description="Leave CCD's pose as it is.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_limits() -> Iterable[Strategy]:
    """Offer limits of joints that are no ranges of heading, pitch and bank.

    A kernel takes `(angles, params, margin)`, see `limbik.core.slots.LIMIT`. Wherever a joint is
    turned, it pulls the joint inside, so what is allowed must stay exactly as it is.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        from typing import Annotated, NamedTuple

        from pydantic import Field

        import limbik
        from limbik.core.strategy import Degrees


        class Hip(NamedTuple):
            open: Annotated[float, Field(ge=0, le=90, description="[deg]"), Degrees] = 60.0


        def hip(angles, params, margin):
            largest = params.open * (1.0 - 0.5 * min(abs(angles[1]), 1.0))
            margin[0] = largest - abs(angles[0])
            angles[0] = min(max(angles[0], -largest), largest)


        @limbik.hookimpl
        def limbik_limits():
            return [limbik.Strategy("hip", hip, Hip, "Opens the less, the more it is raised.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_scene_inputs() -> Iterable[SceneInput]:
    """Offer kinds of files a scene's chain can come from.

    Returns:
        The inputs; the name of each is the key that chooses it in a scene's `chain` mapping.

    Example:
        ```python
        import limbik
        from limbik.core.formats import Body, Inspection, SceneInput
        from limbik.core.settings import Model


        class Stick(Model):
            stick: str  # the file: one length a line


        def read(model, folder):
            lengths = map(float, (folder / model.stick).read_text().split())
            bones = [limbik.Joint(f"bone {k}", (0, 0, x)) for k, x in enumerate(lengths)]
            return Body(limbik.Chain([limbik.Joint("base"), *bones]))


        def inspect(path):
            return Inspection("a stick", ("length",), ((path.read_text(),),), ())


        @limbik.hookimpl
        def limbik_scene_inputs():
            return [SceneInput("stick", (".stick",), Stick, read, inspect, "Bones in a row.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_outputs() -> Iterable[Output]:
    """Offer kinds of files a baked motion can be written to.

    Returns:
        The outputs; the ending of the file chooses one.

    Example:
        ```python
        import limbik
        from limbik.core.formats import Output


        def write(bake):
            return str(bake.solution.distance.tolist())


        @limbik.hookimpl
        def limbik_outputs():
            return [Output("distances", (".txt",), write, "All distances.")]
        ```
    """
    raise NotImplementedError  # a specification is never called


@hookspec
def limbik_solvers() -> Iterable[Strategy]:
    """Offer whole solvers, which scenes choose by `solver: name`.

    The kernel is a Python function `(chain, settings, params)`; it raises `ChainError` if it does
    not solve this kind of chain and returns a function `(goals, follow) -> Solution`, see
    `limbik.core.whole`.

    Returns:
        The strategies, each with a name of its own.

    Example:
        ```python
        import numpy as np

        import limbik
        from limbik.core.whole import assemble


        def lazy(chain, settings, params):
            def solve(goals, follow):
                count = len(goals)
                angles = np.repeat(chain.rest[None], count, axis=0)
                stopped, none = np.ones(count, np.int64), np.zeros(count, np.int64)
                return assemble(chain, goals, angles, stopped, none, ["rests"] * count)

            return solve


        @limbik.hookimpl
        def limbik_solvers():
            return [limbik.Strategy("lazy", lazy, description="Stay in the rest pose.")]
        ```
    """
    raise NotImplementedError  # a specification is never called
