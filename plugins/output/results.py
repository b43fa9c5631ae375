"""What `limbik solve` puts out: the same for a scene with one chain and one with several."""

from collections.abc import Sequence
from typing import Any

from limbik.core import solving
from limbik.core.baking import stacked
from limbik.core.body import bodies_met, chain_solutions, solve_body
from limbik.core.bodyscene import BodyScene
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.plugins.formats.bodytables import body_rows
from limbik.plugins.output.plot import draw
from limbik.plugins.output.plotbody import draw_body
from limbik.plugins.output.records import body_record, solve_record, solve_rows
from limbik.plugins.output.servo import Profile, ServoPose
from limbik.plugins.output.table import print_body, print_servos, print_solutions


class ChainResults:
    """The goals of a scene with one chain, solved.

    Args:
        scene: The scene.
        registry: Where strategies are looked up.
        stages: Whether to keep every stage's pose; a picture needs them.
        profile: Of the servos whose ticks are wanted, or None.

    Raises:
        InputError: A servo cannot follow.
        PluginError: A strategy failed.
    """

    def __init__(
        self, scene: Scene, registry: Registry, stages: bool, profile: Profile | None
    ) -> None:
        self._scene, self._found = scene, solving.solve_scene(scene, registry, stages)
        self._servos: Sequence[ServoPose] = ()
        if profile is not None:
            self._servos = profile.quantise_all(scene.goal_names, self._found)
        self.met = solving.are_met(scene, self._found)

    def rows(self) -> str:
        """Write a CSV table."""
        return solve_rows(self._scene, self._found)

    def draw(self, form: str) -> bytes:
        """Draw the poses; returns the file's content."""
        return draw(self._scene, self._found, form)

    def record(self, stages: bool) -> dict[str, Any]:
        """Describe them for machines, with every stage if that is asked for."""
        return solve_record(self._scene, self._found, stages, self._servos)

    def show(self) -> None:
        """Print them."""
        print_solutions(self._scene, self._found)
        print_servos(self._scene, self._servos)


class BodyResults:
    """The frames of a scene with several chains, solved; as `ChainResults`."""

    def __init__(self, scene: BodyScene, registry: Registry, stages: bool) -> None:
        self._scene, self._found = scene, solve_body(scene, registry, stages)
        self.met = bodies_met(scene, self._found)

    def rows(self) -> str:
        """Write a CSV table."""
        solutions = {name: stacked(of) for name, of in chain_solutions(self._found).items()}
        return body_rows(self._scene.frame_names, solutions)

    def draw(self, form: str) -> bytes:
        """Draw the poses; returns the file's content."""
        return draw_body(self._scene, self._found, form)

    def record(self, stages: bool) -> dict[str, Any]:
        """Describe them for machines, with every stage if that is asked for."""
        return body_record(self._scene, self._found, stages)

    def show(self) -> None:
        """Print them."""
        print_body(self._scene, self._found)
