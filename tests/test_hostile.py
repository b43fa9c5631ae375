"""Whatever is given to the public API in place of what it wants is refused in words."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from limbik import (
    BodySolver,
    Chain,
    Continuity,
    Controller,
    Joint,
    LimbikError,
    Pole,
    PoleRotor,
    PoseSolver,
    Settings,
    Solver,
    Solver2D,
    convert_bend_vector,
    match_fk,
    match_ik,
    read_body,
    read_scene,
    solve_scene,
)

HUGE = 10**400
BAD: dict[str, Any] = {
    "text": "abc",
    "a list of texts": ["1", "2", "3"],
    "complex": np.array([1j, 0, 0]),
    "dates": np.array([1, 2, 3], "datetime64[s]"),
    "objects": [object()] * 3,
    "ragged": [[1, 2], [3]],
    "too large an integer": [HUGE, 0, 0],
    "too large": [1e200, 0.0, 0.0],
    "nan": [np.nan, 0.0, 0.0],
    "a mapping": {"x": 1},
    "a set": {1, 2, 3},
    "a scalar": np.array(5.0),
    "an integer": HUGE,
    "a function": len,
}
ARM = Chain([Joint("a"), Joint("b", offset=(0.0, 0.0, 30.0)), Joint("c", offset=(0.0, 0.0, 26.0))])
GOAL = (20.0, 10.0, 35.0)
SOLVER = Solver(ARM)
TAKERS: dict[str, Callable[[Any], Any]] = {
    "goal": SOLVER.solve,
    "goals": SOLVER.solve_many,
    "path": SOLVER.follow,
    "fk_offsets": lambda bad: SOLVER.solve(GOAL, fk_offsets=bad),
    "goal_turn": lambda bad: SOLVER.solve(GOAL, goal_turn=bad),
    "continuity": lambda bad: SOLVER.solve(GOAL, continuity=bad),
    "memory": lambda bad: SOLVER.solve(GOAL, continuity=Continuity(bad)),
    "chain": Solver,
    "settings": lambda bad: Solver(ARM, bad),
    "pose chain": PoseSolver,
    "tolerance": lambda bad: PoseSolver(ARM, tolerance=bad),
    "starts": lambda bad: PoseSolver(ARM, starts=bad),
    "pole": lambda bad: Solver2D(ARM, pole=bad),
    "Pole": lambda bad: Solver2D(ARM, pole=Pole(position=bad)),
    "rotor": lambda bad: PoleRotor(swing=bad),
    "joints": Chain,
    "joint": lambda bad: Chain([bad, bad]),
    "offset": lambda bad: Chain([Joint("a"), Joint("b", offset=bad)]),
    "degrees": lambda bad: Chain([Joint.degrees("a", pitch=bad), Joint("b", offset=(0, 0, 1))]),
    "base": lambda bad: Chain(ARM.joints, bad),
    "controller": Controller,
    "follows": lambda bad: Controller(GOAL, follows=bad),
    "led": lambda bad: Controller(GOAL).lead(SOLVER, fk_offsets=bad),
    "from_pose": Continuity.from_pose,
    "match_ik": lambda bad: match_ik(SOLVER, bad),
    "match_fk": lambda bad: match_fk(ARM, bad),
    "matched": lambda bad: match_ik(bad, np.zeros((3, 3))),
    "converted goal": lambda bad: convert_bend_vector(SOLVER, bad, "global"),
    "converted mode": lambda bad: convert_bend_vector(SOLVER, GOAL, bad),
    "scene file": read_scene,
    "body file": read_body,
    "scene": solve_scene,
    "body": BodySolver.of,
}


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("taker", TAKERS)
def test_what_does_not_fit_is_refused_in_words(taker: str, bad: str) -> None:
    with pytest.raises(LimbikError) as caught:
        TAKERS[taker](BAD[bad])
    assert len(str(caught.value)) > 10


@pytest.mark.parametrize("bad", [name for name in BAD if name != "a scalar"])
@pytest.mark.parametrize("option", Settings.model_fields)
def test_options_are_refused_in_the_words_of_scenes(option: str, bad: str) -> None:
    with pytest.raises(LimbikError) as caught:
        Solver(ARM, Settings(**{option: BAD[bad]}))
    assert "pydantic" not in str(caught.value)


@pytest.mark.parametrize("threads", [0, -1, 1.5, "2"])
def test_threads_are_counted(threads: Any) -> None:
    with pytest.raises(LimbikError, match="threads"):
        SOLVER.solve_many([GOAL], threads=threads)


@pytest.mark.parametrize("name", [None, 5, "", b"hip", ["hip"]])
def test_a_joint_is_called_by_a_text(name: Any) -> None:
    with pytest.raises(LimbikError, match="needs a name"):
        Chain([Joint(name), Joint("end", offset=(0.0, 0.0, 1.0))])


def test_large_chains_give_numbers() -> None:
    size = 9e99
    chain = Chain([Joint("a"), Joint("b", offset=(0, size, 0)), Joint("c", offset=(0, 0, size))])
    for solver in (Solver(chain), Solver2D(chain, pole=(0.0, size, size))):
        found = solver.solve((size, size / 2, 0.0))
        assert np.isfinite(found.positions).all()
        assert np.isfinite(found.angles).all()


def test_a_controller_may_stand_at_an_array() -> None:
    controller = Controller(np.array(GOAL))  # type: ignore[arg-type]
    led = controller.lead(SOLVER)
    assert controller.lead(SOLVER, led) is led


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(LimbikError, match="nowhere"):
        read_scene(tmp_path / "nowhere.yaml")
