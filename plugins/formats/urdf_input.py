"""The scene input `urdf`: robots, one chain of theirs or all of them."""

from collections.abc import Iterable

from limbik.core.formats import SceneInput, SkeletonInput
from limbik.core.hooks import hookimpl
from limbik.plugins.formats.urdf_chain import UrdfModel, inspect, read_body
from limbik.plugins.formats.urdf_skeleton import UrdfSkeletonModel, read_skeleton


@hookimpl
def limbik_scene_inputs() -> Iterable[SceneInput]:
    """Offer `urdf`."""
    return [
        SceneInput(
            "urdf",
            (".urdf",),
            UrdfModel,
            read_body,
            inspect,
            "A chain between two links of a robot, or the whole robot.",
            skeleton=SkeletonInput(UrdfSkeletonModel, read_skeleton),
        )
    ]
