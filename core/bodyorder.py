"""In what order chains on one skeleton can be solved: none may undo what an earlier one did."""

from collections.abc import Iterator, Sequence

from limbik.core.errors import Fault
from limbik.core.skeleton import WORLD, Limb, Skeleton


def order_faults(
    skeleton: Skeleton, chains: Sequence[tuple[str, Limb, int]]
) -> Iterator[tuple[int, Fault]]:
    """Give what is wrong with an order, each fault with the index of the chain it is about.

    Args:
        skeleton: The skeleton.
        chains: Name, limb and frame of the goals of each, in the order they are solved.
    """
    for index, (name, limb, frame) in enumerate(chains):
        turned = set(limb.turned)
        for earlier, other, other_frame in chains[:index]:
            if shared := turned & set(other.turned):
                joint = skeleton.names[min(shared)]
                message = (
                    f"the {skeleton.part} '{joint}' is turned by the chain '{earlier}' already"
                )
                yield index, Fault("overlap", message, "base")
            elif turned & set(skeleton.above(other.at[0])[1:]):
                message = f"'{name}' moves the base of '{earlier}', which is solved before it"
                yield index, Fault("order", message, "name", hint=f"put it before '{earlier}'")
            elif other_frame != WORLD and turned & set(skeleton.above(other_frame)):
                message = f"'{name}' moves the frame of '{earlier}', which is solved before it"
                yield index, Fault("order", message, "name", hint=f"put it before '{earlier}'")
        if frame != WORLD and turned & set(skeleton.above(frame)):
            message = f"the chain turns '{skeleton.names[frame]}', so its goals would run away"
            yield index, Fault("frame", message, "frame", hint="choose a frame above its base")
