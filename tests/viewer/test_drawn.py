"""The geometry of what is drawn, and the change of hands between limbik and the page."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from limbik.core.rotation import hpb_to_matrix, quaternion_to_matrix
from limbik.plugins.viewer.arcs import arcs
from limbik.plugins.viewer.axes import (
    frame_to_page,
    from_page,
    to_page,
    turn_from_page,
    turn_to_page,
)
from limbik.plugins.viewer.shapes import along, ball, bone, cone
from limbik.plugins.viewer.views import camera
from limbik.tests.viewer.scenes import Opened

numbers = st.floats(-1e6, 1e6)
points = st.tuples(numbers, numbers, numbers)
angles = st.tuples(*[st.floats(-3.1, 3.1)] * 3)


@given(points)
def test_a_place_comes_back_from_the_page_to_the_bit(point: tuple[float, ...]) -> None:
    assert from_page(to_page(point)).tolist() == [value + 0.0 for value in point]


@given(angles, points)
def test_turning_and_going_to_the_page_commute(
    hpb: tuple[float, ...], point: tuple[float, ...]
) -> None:
    turn = hpb_to_matrix(hpb)
    on_page = quaternion_to_matrix(turn_to_page(turn)) @ to_page(point)
    np.testing.assert_allclose(
        on_page, to_page(turn @ point), atol=1e-9 * (1 + np.abs(point).max())
    )
    np.testing.assert_allclose(turn_from_page(turn_to_page(turn)), turn, atol=1e-12)


def test_right_of_somebody_who_looks_along_z_is_right_on_the_page() -> None:
    """Left-handed: x right, y up, z forward. On the right-handed page right is forward x up."""
    right, up, forward = to_page(np.eye(3))
    np.testing.assert_allclose(np.cross(forward, up), right)


@given(points)
def test_a_bone_points_from_joint_to_joint(way: tuple[float, ...]) -> None:
    length = np.linalg.norm(way)
    turned = quaternion_to_matrix(along(np.array([way])))[0] @ [0.0, 0.0, 1.0]
    if length > 1e-150:
        np.testing.assert_allclose(turned, np.array(way) / length, atol=1e-6)


@pytest.mark.parametrize("shape", [bone(), ball()], ids=["bone", "ball"])
def test_a_shape_is_closed_and_faces_outward(shape: tuple[np.ndarray, np.ndarray]) -> None:
    vertices, faces = shape
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    assert np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0 > 0.05  # its volume
    edges = [tuple(sorted(e)) for f in faces for e in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))]
    solid = [e for e in edges if not np.allclose(vertices[e[0]], vertices[e[1]])]
    places = [tuple(sorted(map(tuple, vertices[list(e)].round(9)))) for e in solid]
    assert all(places.count(place) % 2 == 0 for place in set(places))


def test_a_cones_rim_is_at_its_angle() -> None:
    vertices, _ = cone(0.6)
    np.testing.assert_allclose(np.arccos(vertices[1:, 2]), 0.6)


@pytest.mark.parametrize("name", ["arm", "leg", "leg-pole", "finger", "planar"])
def test_a_hand_lies_on_its_arc(opened: Opened, name: str) -> None:
    """The pointer of a joint inside its range touches the arc that range draws."""
    session = opened(name)
    shown = next(iter(session.solve().values()))
    found = arcs(shown, 2.0)
    assert found
    for arc in found:
        swept = arc.lines[:-2].reshape(-1, 3)
        gap = np.linalg.norm(swept - arc.hand[1], axis=1).min()
        step = np.linalg.norm(arc.lines[:-2, 1] - arc.lines[:-2, 0], axis=1).max()
        assert gap <= 0.51 * step + 1e-9  # half a chord and its sagitta
        np.testing.assert_allclose(arc.lines[-1, 0], arc.hand[0])


def test_the_rim_of_a_cone_is_at_its_angles(opened: Opened) -> None:
    session = opened("arm")
    cone = {"use": "cone", "swing": (60.0, 30.0)}
    session.change("arm", session.chain.setup.with_limit(0, cone))
    shown = session.solve()["arm"]
    chain, base = shown.solution.chain, shown.positions[0]
    (rim,) = [arc for arc in arcs(shown, 2.0) if arc.axis == "own"]
    zero = chain.base_rotation @ chain.frozen[0]
    ways = (rim.lines[:, 1] - base) @ zero / 2.0
    np.testing.assert_allclose(np.linalg.norm(ways, axis=1), 1.0)
    tilts = np.degrees(np.arccos(ways[:, 2]))
    assert tilts.max() == pytest.approx(60.0, abs=0.5)
    assert tilts.min() == pytest.approx(30.0, abs=0.5)
    assert np.abs(ways[tilts.argmax(), 0]) < 0.02  # the wide tilt is about x
    pointer = (rim.hand[1] - rim.hand[0]) / 2.0
    np.testing.assert_allclose(pointer, shown.rotations[0][:, 2], atol=1e-12)
    free = {"use": "cone", "swing": (180.0, 180.0)}
    session.change("arm", session.chain.setup.with_limit(0, free))
    assert not [arc for arc in arcs(session.solve()["arm"], 2.0) if arc.axis == "own"]


def test_arcs_are_marked_where_the_joint_rests_on_an_end(opened: Opened) -> None:
    session = opened("arm")
    session.move_goal("arm", np.array([18.0, 143.0, -60.0]))
    shown = next(iter(session.solve().values()))
    touched = shown.solution.limits_touched()
    assert touched
    marked = [arc.axis for arc in arcs(shown, 2.0) if arc.at_limit]
    assert sorted(marked) == sorted(text.rsplit(" ", 1)[1] for text in touched)


def test_the_plane_of_a_flat_scene_looks_right_handed_to_the_eye(opened: Opened) -> None:
    flat = opened("planar").flat
    assert flat is not None
    right, up, toward = to_page(flat.axes.T)
    np.testing.assert_allclose(np.cross(right, up), toward, atol=1e-12)
    np.testing.assert_allclose(
        quaternion_to_matrix(frame_to_page(flat.axes))[:, 2], toward, atol=1e-12
    )


def test_the_camera_sees_all_points(opened: Opened) -> None:
    shown = next(iter(opened("arm").solve().values()))
    view = camera(shown.positions, None)
    ahead = view.look_at - view.position
    ahead /= np.linalg.norm(ahead)
    rays = shown.positions - view.position
    off = np.degrees(np.arccos(rays @ ahead / np.linalg.norm(rays, axis=1)))
    assert off.max() < view.field / 2.0
