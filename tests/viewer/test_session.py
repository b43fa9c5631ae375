"""What a drag, a switch and the time slider do to a session."""

import math
from dataclasses import replace
from threading import Event

import numpy as np
import pytest

from limbik.core.body import solve_body
from limbik.core.errors import InputError, LimbikError
from limbik.core.registry import Registry
from limbik.core.scene import read_scene
from limbik.core.solution2d import PlanarSolution
from limbik.core.solving import solve_scene
from limbik.plugins.viewer.player import Player
from limbik.plugins.viewer.session import LAST, Session, Shown
from limbik.tests.viewer.scenes import Opened


def only(session: Session, stages: bool = False) -> Shown:
    (shown,) = session.solve(stages).values()
    return shown


def test_a_session_begins_where_the_command_line_does(opened: Opened) -> None:
    session = opened("arm")
    first = solve_scene(session.chain.setup.given)[0]
    np.testing.assert_array_equal(only(session).angles, first.angles)


def test_the_end_follows_the_goal(opened: Opened) -> None:
    session = opened("arm")
    goal = session.chain.goal + np.array([3.0, -8.0, 12.0])
    session.move_goal("arm", goal)
    shown = only(session)
    np.testing.assert_allclose(shown.positions[-1], goal, atol=0.01)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200])
def test_a_goal_that_is_no_place_is_refused(opened: Opened, bad: float) -> None:
    session = opened("arm")
    before = session.chain.goal.copy()
    with pytest.raises(InputError):
        session.move_goal("arm", np.array([0.0, bad, 0.0]))
    np.testing.assert_array_equal(session.chain.goal, before)
    assert np.isfinite(only(session).positions).all()


def test_the_stages_are_those_of_the_trace(opened: Opened) -> None:
    session = opened("arm")
    stages = only(session, stages=True).stages
    assert stages[:4] == ("initial", "aim", "bend", "round 1")
    assert stages[-1] == "finish"
    session.stage = 2
    shown = only(session)
    given = session.chain.setup.given
    traced = solve_scene(given, trace=True)[0].trace
    assert traced is not None
    assert shown.stages[shown.stage] == "bend"
    np.testing.assert_array_equal(shown.positions, traced[2].positions)


def test_a_stage_past_the_last_is_the_finished_pose(opened: Opened) -> None:
    session = opened("arm")
    done = only(session)
    session.stage = 999
    shown = only(session)
    assert shown.stage == LAST
    np.testing.assert_array_equal(shown.angles, done.angles)


def test_a_change_that_cannot_be_solved_leaves_everything_as_it_was(opened: Opened) -> None:
    session = opened("planar")
    setup = session.chain.setup
    with pytest.raises(LimbikError):
        session.change("planar", setup.with_strategy("solver", {"use": "lambda-leg"}))
    assert session.chain.setup is setup


def test_a_flat_scene_keeps_its_goal_in_the_plane(opened: Opened) -> None:
    session = opened("planar")
    session.move_goal("planar", np.array([0.7, 1.5, 1.0]))
    np.testing.assert_allclose(session.chain.goal, [0.0, 1.5, 1.0], atol=1e-12)
    assert opened("arm").flat is None


def test_frames_of_a_followed_path_are_what_solving_it_in_order_gives(opened: Opened) -> None:
    session = opened("scenarios/circle-from-rest")
    assert session.follow == session.chain.setup.given.follow
    session.follow = True
    for solver in ("3d", "fabrik"):
        setup = session.chain.setup.with_strategy("solver", {"use": solver})
        session.change(session.chain.name, setup)
        whole = solve_scene(replace(setup.scene, follow=True))
        for frame in (30, 7, 31):
            session.go_to(frame)
            np.testing.assert_array_equal(only(session).angles, whole[frame].angles)


def test_a_changed_option_is_used_for_the_past_of_a_path_too(opened: Opened) -> None:
    session = opened("scenarios/circle-from-rest")
    session.follow = True
    session.go_to(20)
    setup = session.chain.setup.with_option(("start",), "current")
    session.change(session.chain.name, setup)
    session.go_to(20)
    whole = solve_scene(replace(setup.scene, follow=True))
    np.testing.assert_array_equal(only(session).angles, whole[20].angles)


def test_a_path_plays_in_its_own_time_and_begins_again(opened: Opened) -> None:
    session = opened("scenarios/circle-from-rest")
    session.advance(0.5)
    assert session.path.times[session.frame] == pytest.approx(0.5, abs=1 / 30)
    session.advance(1e6)
    assert session.frame == 0


def test_a_planned_trajectory_is_the_path(opened: Opened) -> None:
    pytest.importorskip("scipy")
    session = opened("weld")
    assert len(session.path) > 1000
    assert session.path.note == ""
    session.go_to(700)
    np.testing.assert_array_equal(session.chain.goal, session.path.goals["weld"][700])
    assert only(session).solution.reached


def test_two_solvers_share_the_goal(opened: Opened) -> None:
    session = opened("planar")
    session.compare("article-ccd")
    shown = session.solve()
    other = session.compared(shown)
    assert other is not None
    np.testing.assert_array_equal(other.solution.goal, shown["planar"].solution.goal)
    assert other.setup.choice["use"] == "article-ccd"
    session.compare(None)
    assert session.compared(shown) is None


def test_ik_and_fk_component_are_the_two_ends_of_the_mix(opened: Opened) -> None:
    session = opened("arm")
    setup = session.chain.setup.with_fk(1, np.radians([0.0, 40.0, 0.0]))
    session.change("arm", setup.with_option(("fk_mix",), 0.5))
    session.parts = {"IK", "FK"}
    parts = only(session).parts
    goal = session.chain.goal
    np.testing.assert_allclose(parts["IK"][-1], goal, atol=0.01)
    session.change("arm", setup.with_option(("ik",), False))
    np.testing.assert_array_equal(parts["FK"], only(session).positions)


def test_a_goals_turn_moves_the_rotor(opened: Opened) -> None:
    session = opened("leg-pole")
    before = only(session).solution
    session.turn_goal("leg-pole", np.radians([-40.0, 0.0, 0.0]))
    after = only(session).solution
    assert isinstance(before, PlanarSolution)
    assert isinstance(after, PlanarSolution)
    assert before.rotor is not None
    assert after.rotor is not None
    assert np.abs(after.rotor - before.rotor).max() > 0.1


def test_without_follow_a_solve_has_no_past(opened: Opened, registry: Registry) -> None:
    session = opened("arm")
    goals = read_scene(session.chain.setup.given.document.name, registry).goals
    for goal in goals[::-1]:
        session.move_goal("arm", goal)
        session.solve()
    np.testing.assert_array_equal(only(session).angles, only(opened("arm")).angles)


def test_a_body_moves_as_the_command_line_solves_it(opened: Opened) -> None:
    session = opened("body")
    assert session.body is not None
    whole = solve_body(session.body)
    for frame in (0, 4):
        session.go_to(frame)
        for name, shown in session.solve().items():
            np.testing.assert_array_equal(shown.angles, whole[frame].solutions[name].angles)


def test_dragging_the_spine_carries_the_arms_and_leaves_the_legs(opened: Opened) -> None:
    session = opened("body")
    before = session.solve()
    session.move_goal("spine", before["spine"].solution.goal + np.array([0.1, -0.05, 0.05]))
    after = session.solve()
    for side in ("left", "right"):
        arm, leg = f"{side} arm", f"{side} leg"
        assert np.abs(after[arm].positions[0] - before[arm].positions[0]).max() > 0.01
        np.testing.assert_allclose(after[arm].positions[-1], before[arm].positions[-1], atol=1e-3)
        np.testing.assert_array_equal(after[leg].positions, before[leg].positions)


def test_a_goal_in_the_axes_of_a_joint_is_dragged_in_the_world(opened: Opened) -> None:
    session = opened("walk")
    session.go_to(12)
    before = session.solve()
    ankle = before["left leg"].positions[-1]
    goal = ankle + np.array([0.0, 4.0, 3.0])
    session.move_goal("left leg", goal)
    after = session.solve()["left leg"]
    np.testing.assert_allclose(after.positions[-1], goal, atol=0.01)
    session.parts = {"IK"}
    np.testing.assert_allclose(session.solve()["left leg"].parts["IK"], after.positions, atol=1e-9)


def test_one_chain_of_a_body_is_solved_another_way_and_compared(opened: Opened) -> None:
    session = opened("body")
    session.select("left arm")
    session.compare("fabrik")
    shown = session.solve()
    other = session.compared(shown)
    assert other is not None
    np.testing.assert_allclose(other.positions[0], shown["left arm"].positions[0])
    session.change("left arm", session.chain.setup.with_option(("tolerance",), 0.01))
    assert session.chains["right arm"].setup.settings.tolerance == 0.0001
    assert session.solve()["left arm"].solution.reached


def test_a_player_goes_on_until_it_is_stopped() -> None:
    passed: list[float] = []
    twice = Event()

    def tick(seconds: float) -> None:
        passed.append(seconds)
        if len(passed) == 2:
            twice.set()

    player = Player(tick)
    player.start()
    assert twice.wait(20.0)
    player.stop()
    assert not player.plays
    assert min(passed) > 0.0


def test_what_is_refused_on_the_way_leaves_goals_and_frame_as_they_were(opened: Opened) -> None:
    session = opened("arm")
    goal = session.chain.goal.copy()

    def fail() -> None:
        with session.tried():
            session.go_to(3)
            session.turn_goal("arm", np.array([0.0, 0.1, 0.0]))
            session.move_goal("arm", np.array([0.0, math.nan, 0.0]))

    with pytest.raises(InputError):
        fail()
    np.testing.assert_array_equal(session.chain.goal, goal)
    assert session.frame == 0
    assert session.chain.turns is None
