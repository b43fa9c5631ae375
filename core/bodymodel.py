"""The shape of a scene file with several chains on one skeleton.

```yaml
limbik: 1
skeleton: {urdf: humanoid.urdf}        # or a bvh clip, or joints with their parents
chains:                                # in the order they are solved
  - name: spine
    base: pelvis
    end: chest
    options: {max_iterations: 100}
    goals: [{position: [0.1, 0.4, 0]}]
  - {name: left arm, base: chest, end: left_hand, goals: [{position: [0.3, 0.4, 0.2]}]}
```

Each chain has its own solver, options and goals, with the keys of a scene with one chain. Goal k of
every chain is of frame k; a chain with one goal keeps it in all frames.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator
from pydantic_core import PydanticCustomError

from limbik.core.scenemodel import JointModel, Name, SolveModel, check_version
from limbik.core.settings import Model
from limbik.core.wording import found_words

MOST_CHAINS = 64


class SkeletonJointModel(JointModel):
    """A joint of a skeleton."""

    parent: Annotated[
        Name | None, Field(description="a joint above it in the list; absent = a root")
    ] = None


class SkeletonModel(Model):
    """Joints that hang from each other, parents before their children."""

    joints: list[SkeletonJointModel]


class PartModel(SolveModel):
    """One chain of the skeleton, how it is solved, and its goals."""

    name: Annotated[Name, Field(description="unique in the scene")]
    base: Annotated[str, Field(min_length=1, description="joint (or link) the chain starts with")]
    end: Annotated[str, Field(min_length=1, description="joint (or link) that goes to the goals")]
    frame: Annotated[
        str,
        Field(
            min_length=1,
            description="joint (or link) in whose frame goals and pole are, as the chains before "
            "left it; absent = the world",
        ),
    ] = "world"


class BodyModel(Model):
    """A whole scene file with several chains."""

    limbik: Annotated[
        Literal[1], BeforeValidator(check_version), Field(description="version of the format")
    ]
    skeleton: SkeletonModel
    chains: Annotated[list[PartModel], Field(description="in the order they are solved")]

    @field_validator("chains", mode="before")
    @classmethod
    def _some(cls, value: Any) -> Any:
        if isinstance(value, list) and not 1 <= len(value) <= MOST_CHAINS:
            message = "a scene has 1 to {most} chains, this one has {found}"
            shown = {"most": MOST_CHAINS, "found": found_words(value).removeprefix("a list of ")}
            raise PydanticCustomError("joint-count", message, shown)
        return value
