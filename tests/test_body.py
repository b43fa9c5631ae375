"""Several chains on one skeleton (M-11): each on its goal, each from the others' results."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from limbik.core.baking import bake_body
from limbik.core.body import BodyChain, BodySolver, solve_body
from limbik.core.bodyscene import BodyScene, body_from, read_body
from limbik.core.chain import Joint
from limbik.core.errors import InputError
from limbik.core.registry import Registry
from limbik.core.rotation import Array
from limbik.core.scene import read_scene
from limbik.core.skeleton import JointSkeleton
from limbik.core.solution2d import PlanarSolution
from limbik.core.solver import Solver
from limbik.core.solving import solve_scene
from limbik.core.yamlfile import read_yaml

CONFIGS = Path(__file__).parents[1] / "configs"
REGISTRY = Registry(third_party=False)
OPTIONS = {"max_iterations": 100, "tolerance": 1e-6, "off_axis": True}
JOINTS = """\
limbik: 1
skeleton:
  joints:
    - {name: hips, offset: [0, 90, 0], frozen: [0, 90, 0]}
    - {name: belly, parent: hips, offset: [0, 0, 15]}
    - {name: chest, parent: belly, offset: [0, 0, 15]}
    - {name: neck, parent: chest, offset: [0, 0, 15]}
    - {name: shoulder.L, parent: neck, offset: [-18, 0, -5], frozen: [0, 180, 0]}
    - {name: elbow.L, parent: shoulder.L, offset: [0, 0, 30]}
    - {name: hand.L, parent: elbow.L, offset: [0, 0, 26]}
    - {name: shoulder.R, parent: neck, offset: [18, 0, -5], frozen: [0, 180, 0]}
    - {name: elbow.R, parent: shoulder.R, offset: [0, 0, 30]}
    - {name: hand.R, parent: elbow.R, offset: [0, 0, 26]}
"""
OPTION_LINE = "{max_iterations: 100, tolerance: 0.000001, off_axis: true}"
SPINE = f"""\
  - name: spine
    base: hips
    end: neck
    options: {OPTION_LINE}
    goals: [{{position: [0, 130, 12]}}]
"""


def arm(side: str, goals: str, more: str = "") -> str:
    return f"""\
  - name: arm.{side}
    base: shoulder.{side}
    end: hand.{side}
    options: {OPTION_LINE}
    goals: {goals}
{more}"""


def body(chains: str) -> BodyScene:
    return body_from(read_yaml(f"{JOINTS}chains:\n{chains}", "body.yaml"), Path(), REGISTRY)


def bar(turn: float, side: float) -> Array:
    """An end of a bar before the chest that turns about the vertical (S7)."""
    angle = np.radians(turn)
    return np.array([side * 20.0 * np.cos(angle), 115.0, 25.0 + side * 20.0 * np.sin(angle)])


def test_two_hands_hold_a_turning_bar_while_the_spine_bends() -> None:
    """S7: the spine's tip leans 0.15 of its length, the bar turns by 35° both ways."""
    solver = BodySolver.of(
        body(SPINE + arm("L", "[{position: [1, 2, 3]}]") + arm("R", "[{position: [1, 2, 3]}]")),
        REGISTRY,
    )
    names = solver.skeleton.names
    for step in range(21):
        turn = 35.0 * np.sin(2.0 * np.pi * step / 20.0)
        tip = np.array([6.75 * np.sin(0.3 * step), 133.0, 6.75 * np.cos(0.3 * step)])
        goals = {"spine": tip, "arm.L": bar(turn, -1.0), "arm.R": bar(turn, 1.0)}
        found = solver.solve(goals)
        for chain, end in (("spine", "neck"), ("arm.L", "hand.L"), ("arm.R", "hand.R")):
            place = found.positions[names.index(end)]
            assert np.linalg.norm(place - goals[chain]) <= 1e-6, (step, chain)
        assert found.reached


def test_the_whole_skeleton_keeps_its_bones_and_agrees_with_the_chains() -> None:
    scene = body(SPINE + arm("L", "[{position: [-20, 110, 40]}]"))
    (found,) = solve_body(scene, REGISTRY)
    offsets = scene.skeleton.motion.offsets[0]
    for joint, parent in enumerate(scene.skeleton.parents):
        if parent >= 0:
            bone = found.positions[joint] - found.positions[parent]
            assert np.linalg.norm(bone) == pytest.approx(np.linalg.norm(offsets[joint]), abs=1e-12)
    for part in scene.parts:
        at = list(part.limb.at)
        solution = found.solutions[part.name]
        np.testing.assert_allclose(found.positions[at], solution.positions, atol=1e-11)
        np.testing.assert_allclose(found.rotations[at], solution.rotations, atol=1e-12)


def test_independent_chains_may_change_places() -> None:
    """S7: no bit changes."""
    left, right = arm("L", "[{position: [-20, 110, 40]}]"), arm("R", "[{position: [25, 100, 30]}]")
    first, second = (
        solve_body(body(SPINE + a + b), REGISTRY)[0] for a, b in ((left, right), (right, left))
    )
    assert (first.positions == second.positions).all()
    assert (first.rotations == second.rotations).all()


def test_mirrored_goals_give_the_mirrored_body() -> None:
    """M-13 over a whole body: left and right exchanged, x reversed."""
    goals = {
        "spine": [7.0, 130.0, 9.0],
        "arm.L": [-20.0, 110.0, 40.0],
        "arm.R": [25.0, 100.0, 30.0],
    }
    solver = BodySolver.of(
        body(SPINE + arm("L", "[{position: [1, 2, 3]}]") + arm("R", "[{position: [1, 2, 3]}]")),
        REGISTRY,
    )
    flip = np.array([-1.0, 1.0, 1.0])
    other = {"spine": "spine", "arm.L": "arm.R", "arm.R": "arm.L"}
    found = solver.solve(goals)
    image = solver.solve({other[name]: flip * goal for name, goal in goals.items()})
    names = list(solver.skeleton.names)
    swapped = [names.index(n[:-1] + {"L": "R", "R": "L"}[n[-1]] if "." in n else n) for n in names]
    np.testing.assert_allclose(image.positions[swapped] * flip, found.positions, atol=45e-9)


def test_an_earlier_chain_moves_the_base_of_a_later_one() -> None:
    goal = "[{position: [-25, 115, 25]}]"
    (alone,) = solve_body(body(arm("L", goal)), REGISTRY)
    (moved,) = solve_body(body(SPINE + arm("L", goal)), REGISTRY)
    base = alone.skeleton.names.index("shoulder.L")
    assert np.linalg.norm(alone.positions[base] - moved.positions[base]) > 5.0
    assert alone.reached
    assert moved.reached


def test_goals_in_a_joints_frame_move_with_it() -> None:
    inside = [-3.0, 40.0, 10.0]
    scene = body(SPINE + arm("L", f"[{{position: {inside}}}]", "    frame: neck\n"))
    (found,) = solve_body(scene, REGISTRY)
    neck = scene.skeleton.names.index("neck")
    world = found.positions[neck] + found.rotations[neck] @ inside
    np.testing.assert_allclose(found.solutions["arm.L"].goal, world, atol=1e-12)
    np.testing.assert_allclose(
        found.positions[scene.skeleton.names.index("hand.L")], world, atol=1e-6
    )


def test_a_pole_in_a_joints_frame_moves_with_it() -> None:
    more = "    frame: neck\n    solver: 2d\n    pole: {position: [-60, 0, 10]}\n"
    text = arm("L", "[{position: [-3, 40, 10]}]", more)
    text = text.replace(f"    options: {OPTION_LINE}\n", "")
    (found,) = solve_body(body(SPINE + text), REGISTRY)
    neck = found.skeleton.names.index("neck")
    world = found.positions[neck] + found.rotations[neck] @ [-60.0, 0.0, 10.0]
    solution = found.solutions["arm.L"]
    assert isinstance(solution, PlanarSolution)
    np.testing.assert_allclose(solution.pole, world, atol=1e-12)
    assert solution.reached


def test_a_pole_can_be_dragged() -> None:
    """Given with the goals or written into the scene, it is the same pole."""
    more = "    frame: neck\n    solver: 2d\n    pole: {position: [-60, 0, 10]}\n"
    text = arm("L", "[{position: [-3, 40, 10]}]", more)
    text = text.replace(f"    options: {OPTION_LINE}\n", "")
    goals = {"spine": [0, 130, 12], "arm.L": [-3, 40, 10]}
    there = BodySolver.of(body(SPINE + text), REGISTRY).solve(goals)
    elsewhere = BodySolver.of(body(SPINE + text.replace("[-60, 0, 10]", "[9, 50, 60]")), REGISTRY)
    assert (elsewhere.solve(goals).positions != there.positions).any()
    dragged = elsewhere.solve(goals, poles={"arm.L": [-60, 0, 10]})
    assert (dragged.positions == there.positions).all()


def test_a_chain_with_one_goal_keeps_it_in_all_frames() -> None:
    several = "[{name: a, position: [-20, 110, 40]}, {name: b, position: [-30, 90, 30]}]"
    scene = body(SPINE + arm("L", several))
    found = solve_body(scene, REGISTRY)
    assert scene.frame_names == ("a", "b")
    assert len(found) == 2
    assert (found[0].solutions["spine"].angles == found[1].solutions["spine"].angles).all()


def test_a_chain_without_a_goal_stays_as_it_is() -> None:
    scene = body(SPINE + arm("L", "[{position: [-20, 110, 40]}]"))
    found = BodySolver.of(scene, REGISTRY).solve({"arm.L": [-20.0, 110.0, 40.0]})
    still, _ = scene.skeleton.motion.world()
    neck = scene.skeleton.names.index("neck")
    np.testing.assert_allclose(found.positions[: neck + 1], still[0, : neck + 1], atol=1e-12)


def test_frames_in_any_order_give_the_same_bits() -> None:
    goals = {"spine": np.array([[0.0, 130.0, 12.0], [8.0, 131.0, 3.0], [-5.0, 128.0, 9.0]])}
    goals["arm.L"] = np.array([[-20.0, 110.0, 40.0], [-30.0, 90.0, 30.0], [-40.0, 130.0, 10.0]])
    scene = body(SPINE + arm("L", "[{position: [1, 2, 3]}]"))
    solver = BodySolver.of(scene, REGISTRY)
    forward = list(solver.frames(goals))
    backward = list(solver.frames({name: rows[::-1] for name, rows in goals.items()}))
    for one, other in zip(forward, backward[::-1], strict=True):
        assert (one.rotations == other.rotations).all()


@pytest.mark.parametrize("end", ["right_hand", "left_sole"])
def test_one_chain_of_a_robot_solves_as_a_scene_of_its_own(end: str, tmp_path: Path) -> None:
    """The same chain, whether cut out of the whole robot or read alone."""
    options = "options: {tolerance: 0.0001, max_iterations: 200, smoothing: 0.5, off_axis: true}"
    goals = "goals: [{position: [0.3, 0.2, -0.2]}, {position: [0.1, -0.7, 0.1]}]"
    urdf = f"urdf: {CONFIGS / 'humanoid.urdf'}"
    ends = f"base: pelvis, end: {end}"
    (tmp_path / "one.yaml").write_text(
        f"limbik: 1\nchain: {{{urdf}, {ends}}}\n{options}\n{goals}\n"
    )
    whole = f"limbik: 1\nskeleton: {{{urdf}}}\nchains:\n- {{name: a, {ends}, {options}, {goals}}}\n"
    alone = solve_scene(read_scene(tmp_path / "one.yaml", REGISTRY), REGISTRY)
    found = solve_body(body_from(read_yaml(whole, "b.yaml"), tmp_path, REGISTRY), REGISTRY)
    for single, frame in zip(alone, found, strict=True):
        assert single.chain.names == frame.solutions["a"].chain.names
        np.testing.assert_allclose(frame.solutions["a"].angles, single.angles, atol=1e-6)
        np.testing.assert_allclose(frame.solutions["a"].positions, single.positions, atol=1e-8)


def test_a_body_can_be_built_in_python() -> None:
    joints = [
        Joint("root"),
        Joint("a", offset=(0.0, 0.0, 5.0)),
        Joint("b", offset=(0.0, 0.0, 5.0)),
        Joint("c", offset=(0.0, 3.0, 2.0)),
        Joint("d", offset=(0.0, 0.0, 4.0)),
    ]
    skeleton = JointSkeleton.of(joints, [-1, 0, 1, 2, 3])
    chains = []
    for name, base, end in (("lower", "root", "b"), ("upper", "b", "d")):
        limb = skeleton.limb(base, end)
        chains.append(BodyChain(name, limb, Solver(limb.chain, None, REGISTRY, **OPTIONS)))
    found = BodySolver(skeleton, chains).solve({"lower": [3, 2, 8], "upper": [3, 7, 9]})
    assert found.reached
    np.testing.assert_allclose(found.positions[4], [3, 7, 9], atol=1e-6)
    with pytest.raises(InputError, match="moves the base of 'upper', which is solved before it"):
        BodySolver(skeleton, chains[::-1])


WRONG: list[tuple[Callable[[BodySolver], object], str]] = [
    (lambda s: s.solve({"spin": [0, 0, 1]}), "no chain is called 'spin' (did you mean 'spine'?)"),
    (lambda s: s.solve({"spine": [0, 1]}), "goal of 'spine': expected shape (3,), found (2,)"),
    (lambda s: s.solve({"spine": [0, 1, np.nan]}), "goal of 'spine': every number must be finite"),
    (
        lambda s: s.solve({"spine": [0, 0, 1]}, poles={"spine": [0, 1, 0]}),
        "pole of 'spine': only the 2D solver has a pole",
    ),
    (
        lambda s: list(s.frames({"spine": np.zeros((2, 3)), "arm.L": np.zeros((3, 3))})),
        "goals: every chain needs as many, found [2, 3]",
    ),
]


@pytest.mark.parametrize(("call", "message"), WRONG)
def test_what_does_not_fit_is_refused(call: Callable[[BodySolver], object], message: str) -> None:
    solver = BodySolver.of(body(SPINE + arm("L", "[{position: [1, 2, 3]}]")), REGISTRY)
    with pytest.raises(InputError) as caught:
        call(solver)
    assert message in str(caught.value)


def test_the_motion_of_a_bake_is_that_of_the_frames() -> None:
    """Angles put into the skeleton's own turns give the world positions the frames had."""
    several = "[{position: [-20, 110, 40]}, {position: [-30, 90, 30]}]"
    for scene in (body(SPINE + arm("L", several)), read_body(CONFIGS / "body.yaml", REGISTRY)):
        positions, rotations = bake_body(scene, REGISTRY).motion.world()
        for row, frame in enumerate(solve_body(scene, REGISTRY)):
            np.testing.assert_allclose(positions[row], frame.positions, atol=1e-11)
            np.testing.assert_allclose(rotations[row], frame.rotations, atol=1e-12)
