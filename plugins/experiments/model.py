"""The shape of an experiment file: which keys there are and what each may hold.

```yaml
experiment: 1                  # version of the format
name: bends                    # absent = the file's name
seed: 7                        # of all sampled goals
chains:                        # scenes: chain, options, pole and solver; their goals are left aside
  - ../arm.yaml
  - {name: right leg, scene: ../leg.yaml}
strategies:                    # options on top of each scene's
  - {name: plain, options: {finish: none}}
  - {name: arc, options: {initial_bend: solved-arc}, sweep: {soft_zone: [0, 0.03]}}
sweep: {max_iterations: [10, 50]}    # crossed with every strategy
goals:                         # each with every chain, or with those it names
  - {kind: reach, count: 10000}
  - {kind: grid, steps: [21, 21, 1]}
  - {kind: path, csv: circle.csv, chains: [arm]}
metrics: [gain, curl]          # of `limbik judge`, one value a goal set
engine: local                  # or serial, or dask://HOST:PORT
output: runs/bends             # from the working folder
```

Points an experiment itself writes are shares of the chain's length from joint 0, so that they suit
every chain; those of a CSV file are positions in the world, as in a scene.
"""

import re
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from limbik.core.scenemodel import Name, check_version
from limbik.core.settings import Model, list_as_tuple
from limbik.core.wording import found_words

MOST_GOALS = 1_000_000_000
LOCAL, SERIAL, DASK = "local", "serial", "dask://"
_ADDRESS = re.compile(r"dask://(\[[0-9a-fA-F:.]+\]|[\w.-]+):\d{1,5}")

Value = bool | int | float | str


def _values(value: Any) -> Any:
    """Let one value stand for a list of one."""
    return [value] if isinstance(value, Value) else value


def engine_name(text: str) -> str:
    """Refuse what names no engine.

    Raises:
        PydanticCustomError: It is none.
    """
    if text in (LOCAL, SERIAL) or _ADDRESS.fullmatch(text):
        return text
    message = "must be local, serial or dask://HOST:PORT, not {found}"
    raise PydanticCustomError("choice", message, {"found": found_words(text)})


Share = Annotated[float, Field(ge=-10.0, le=10.0)]
Shares = Annotated[tuple[Share, Share, Share], BeforeValidator(list_as_tuple)]
Steps = Annotated[int, Field(ge=1, le=100_000)]
Sweep = dict[str, Annotated[list[Any], BeforeValidator(_values), Field(min_length=1)]]
Engine = Annotated[str, AfterValidator(engine_name)]


class SceneChain(Model):
    """A scene, or only its path."""

    name: Annotated[Name | None, Field(description="absent = the file's name")] = None
    scene: Annotated[str, Field(min_length=1, description="path relative to the experiment")]


def _chain_form(value: Any) -> Any:
    return {"scene": value} if isinstance(value, str) else value


class StrategyModel(Model):
    """Options to compare."""

    name: Name
    options: Annotated[
        dict[str, Any], Field(default_factory=dict, description="keys of a scene's options")
    ]
    solver: Annotated[
        str | dict[str, Any] | None,
        Field(description="a whole solver instead of the scene's, as in a scene"),
    ] = None
    sweep: Annotated[
        Sweep,
        Field(default_factory=dict, description="values by option, of this strategy alone"),
    ]


class GoalSetModel(Model):
    """What all kinds of goal sets have."""

    name: Annotated[Name | None, Field(description="absent = the kind, or the file's name")] = None
    chains: Annotated[
        list[str] | None, Field(min_length=1, description="names of chains; absent = all")
    ] = None


class ReachModel(GoalSetModel):
    """Goals drawn at random."""

    kind: Literal["reach"]
    count: Annotated[int, Field(ge=1, le=MOST_GOALS)]
    by: Annotated[
        Literal["joints", "ball"],
        Field(
            description="joints: where evenly drawn angles within the limits put the end; ball: "
            "evenly in the ball of the chain's length, less a hole it cannot enter"
        ),
    ] = "joints"
    repeats: Annotated[int, Field(ge=1, le=10_000, description="draws, each its own")] = 1


class GridModel(GoalSetModel):
    """Goals on a grid."""

    kind: Literal["grid"]
    steps: Annotated[
        Annotated[tuple[Steps, Steps, Steps], BeforeValidator(list_as_tuple)],
        Field(description="goals along x, y and z"),
    ]
    low: Annotated[Shares, Field(description="one corner [chain lengths]")] = (-1.0, -1.0, -1.0)
    high: Annotated[Shares, Field(description="the other [chain lengths]")] = (1.0, 1.0, 1.0)


class PathModel(GoalSetModel):
    """Goals in order, at a steady rate."""

    kind: Literal["path"]
    csv: Annotated[str | None, Field(min_length=1, description="file with name,x,y,z")] = None
    through: Annotated[
        list[Shares] | None,
        Field(min_length=2, description="corners of straight lines [chain lengths]"),
    ] = None
    count: Annotated[int, Field(ge=2, le=100_000, description="goals along `through`")] = 200
    rate: Annotated[float, Field(gt=0.0, le=1e6, description="goals a second [1/s]")] = 60.0
    follow: Annotated[bool, Field(description="solve each from the pose before it")] = False

    @model_validator(mode="after")
    def _has_one_source(self) -> "PathModel":
        if (self.csv is None) == (self.through is None):
            raise ValueError("a path has either csv or through")
        return self


class FileModel(GoalSetModel):
    """Goals of a CSV file, in no order."""

    kind: Literal["file"]
    csv: Annotated[str, Field(min_length=1, description="file with name,x,y,z")]


GoalsModel = ReachModel | GridModel | PathModel | FileModel


class ExperimentModel(Model):
    """A whole experiment file."""

    experiment: Annotated[
        Literal[1], BeforeValidator(check_version), Field(description="version of the format")
    ]
    name: Annotated[Name | None, Field(description="absent = the file's name")] = None
    seed: Annotated[int, Field(ge=0, le=2**63 - 1, description="of all sampled goals")] = 0
    chains: Annotated[
        list[Annotated[SceneChain, BeforeValidator(_chain_form)]], Field(min_length=1)
    ]
    strategies: Annotated[
        list[StrategyModel],
        Field(default_factory=lambda: [StrategyModel(name="scene", options={}, sweep={})]),
    ]
    sweep: Annotated[
        Sweep, Field(default_factory=dict, description="values by option, crossed with all")
    ]
    goals: Annotated[list[Annotated[GoalsModel, Field(discriminator="kind")]], Field(min_length=1)]
    metrics: Annotated[
        list[str], Field(default_factory=list, description="of `limbik judge`, by name")
    ]
    batch: Annotated[
        int | None, Field(ge=1, le=1_000_000, description="most goals of a part; absent = by size")
    ] = None
    engine: Annotated[Engine | None, Field(description="absent = local for long runs")] = None
    workers: Annotated[
        int | None, Field(ge=1, le=1024, description="of the engine local; absent = all cores")
    ] = None
    output: Annotated[str | None, Field(min_length=1, description="folder; absent = runs/NAME")] = (
        None
    )
