"""The scene input `bvh`: motion clips, one chain of theirs or all of them."""

from collections.abc import Iterable

from limbik.core.formats import SceneInput, SkeletonInput
from limbik.core.hooks import hookimpl
from limbik.plugins.formats.bvh_chain import BvhModel, FramesModel, inspect, read_body
from limbik.plugins.formats.bvh_skeleton import read_skeleton


@hookimpl
def limbik_scene_inputs() -> Iterable[SceneInput]:
    """Offer `bvh`."""
    return [
        SceneInput(
            "bvh",
            (".bvh",),
            BvhModel,
            read_body,
            inspect,
            "A chain of a motion clip with the path of its end, or the whole clip.",
            has_goals=True,
            skeleton=SkeletonInput(FramesModel, read_skeleton),
        )
    ]
