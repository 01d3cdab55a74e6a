"""Laws of the scene's shapes: signs, straightness, magnification, and faces that look outwards."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from backend.scene import bodies, geometry
from backend.scene.actuator_scene import CAMERA_POSITION
from backend.scene.palette import DARK, LIGHT, exchange, rgb
from backend.scene.solids import Mesh, Vertices, ribbon_faces, turned

deflections = st.floats(-0.5, 0.5)
shown_deflections = st.floats(-geometry.LARGEST_SHOWN_DEFLECTION, geometry.LARGEST_SHOWN_DEFLECTION)
stiffness_positions = st.floats(31.4, 115.7)
lengths = stiffness_positions.map(geometry.free_length)


def centre_line(vertices: Vertices, stations: int = geometry.LEAF_STATIONS) -> NDArray[np.float64]:
    """Points (stations, 2) midway between a ribbon's two edges."""
    left, right = vertices[:stations, :2], vertices[3 * stations : 4 * stations, :2]
    return 0.5 * (left.astype(np.float64) + right.astype(np.float64))


def volume(mesh: Mesh) -> float:
    """Volume enclosed by a closed mesh; positive when its faces look outwards."""
    a, b, c = (mesh[0][mesh[1][:, corner]].astype(np.float64) for corner in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@given(lengths)
def test_a_leaf_without_deflection_is_straight(length: float) -> None:
    line = centre_line(geometry.leaf_vertices(0.0, length))
    assert np.allclose(line[:, 1], 0.0)
    assert np.all(np.diff(line[:, 0]) >= 0.0)
    assert line[-1, 0] == pytest.approx(geometry.HUB_RADIUS + geometry.LEAF_REACH, abs=1e-6)


@given(shown_deflections, lengths)
def test_the_roller_end_of_a_leaf_is_seen_at_the_shown_deflection(shown: float, length: float) -> None:
    contact = centre_line(geometry.leaf_vertices(shown, length))[geometry.LEAF_STATIONS - 3]
    assert math.atan2(contact[1], contact[0]) == pytest.approx(shown, abs=1e-5)
    assert np.hypot(*contact) == pytest.approx(geometry.roller_radius(length), abs=1e-5)


@given(shown_deflections, lengths)
def test_a_leaf_leaves_its_clamp_along_the_hubs_radius(shown: float, length: float) -> None:
    vertices = geometry.leaf_vertices(shown, length)
    left, right = vertices[0], vertices[3 * geometry.LEAF_STATIONS]
    assert left[0] == pytest.approx(right[0], abs=1e-6)
    assert centre_line(vertices)[0] == pytest.approx([geometry.HUB_RADIUS, 0.0], abs=1e-6)


@given(st.floats(1e-3, 0.5), lengths)
def test_a_leaf_bends_counter_clockwise_when_the_motor_is_ahead_of_the_link(deflection: float, length: float) -> None:
    line = centre_line(geometry.leaf_vertices(geometry.magnified(deflection), length))
    assert np.all(line[1:, 1] > 0.0)
    mirrored = centre_line(geometry.leaf_vertices(geometry.magnified(-deflection), length))
    assert np.allclose(mirrored, line * [1.0, -1.0], atol=1e-6)


@given(st.floats(-0.01, 0.01))
def test_small_deflections_are_magnified_by_the_factor_that_is_shown(deflection: float) -> None:
    assert geometry.magnified(deflection) == pytest.approx(geometry.MAGNIFICATION * deflection, rel=0.01, abs=1e-12)


@given(deflections, deflections)
def test_magnification_keeps_order_and_stays_within_its_limit(one: float, other: float) -> None:
    assert (geometry.magnified(one) - geometry.magnified(other)) * (one - other) >= 0.0
    assert abs(geometry.magnified(one)) <= geometry.LARGEST_SHOWN_DEFLECTION


def test_the_free_length_follows_the_stiffness_motor_between_its_end_stops() -> None:
    stiff, middle, soft = (geometry.free_length(position) for position in (31.42, 62.84, 115.6))
    assert middle == pytest.approx(2.0 * stiff, rel=1e-3)
    assert stiff == pytest.approx(geometry.SCENE_UNITS_PER_M * 0.025, rel=1e-3)
    assert soft == pytest.approx(geometry.SCENE_UNITS_PER_M * 0.092, rel=1e-3)
    assert geometry.free_length(0.0) == pytest.approx(stiff, rel=1e-3)
    assert geometry.free_length(500.0) == pytest.approx(soft, rel=1e-3)


@given(lengths)
def test_rollers_and_leaves_stay_between_hub_and_ring(length: float) -> None:
    distance = np.linalg.norm(bodies.rollers(geometry.roller_radius(length))[0][:, :2], axis=1)
    assert distance.min() > geometry.HUB_RADIUS
    assert distance.max() < bodies.RING_INNER
    assert geometry.HUB_RADIUS + geometry.LEAF_REACH < bodies.RING_INNER


def test_a_positive_angle_turns_counter_clockwise_before_the_camera() -> None:
    assert CAMERA_POSITION[2] > 0.0  # looking against the joint axis, with x to the right and y up
    quarter = turned(np.array([[1.0, 0.0, 0.0]], dtype=np.float32), math.pi / 2.0)
    assert quarter[0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)


def test_the_link_lies_along_x_at_angle_zero() -> None:
    vertices = bodies.link_bar()[0]
    assert vertices[:, 0].max() == pytest.approx(bodies.LINK_REACH, abs=0.01)
    assert abs(vertices[:, 1]).max() <= bodies.BALL_RADIUS + 1e-6


@given(st.floats(geometry.SMALLEST_SHOWN_TORQUE, 100.0))
def test_a_positive_disturbance_pushes_the_link_clockwise(torque: float) -> None:
    assert geometry.arrow_span(torque) < 0.0
    assert geometry.arrow_span(-torque) == -geometry.arrow_span(torque)
    tip = centre_line(geometry.arrow_vertices(geometry.arrow_span(torque)), geometry.ARROW_STATIONS + 2)[-1]
    assert tip[1] < 0.0


@given(st.floats(0.2, 11.0))
def test_the_arrow_grows_with_the_torque(torque: float) -> None:
    assert abs(geometry.arrow_span(torque + 0.5)) > abs(geometry.arrow_span(torque))


@pytest.mark.parametrize("torque", [0.0, 0.09, -0.09, math.nan])
def test_a_negligible_torque_has_no_arrow(torque: float) -> None:
    assert geometry.arrow_span(torque) == 0.0


@pytest.mark.parametrize("solid", [bodies.motor_ring(), bodies.rollers(0.3)], ids=["ring", "rollers"])
def test_turned_bodies_look_outwards(solid: Mesh) -> None:
    assert volume(solid) > 0.0


@given(shown_deflections, lengths)
def test_leaves_look_outwards_however_they_bend(shown: float, length: float) -> None:
    assert volume((geometry.leaf_vertices(shown, length), ribbon_faces(geometry.LEAF_STATIONS))) > 0.0


@given(st.floats(0.1, 20.0), st.sampled_from([-1.0, 1.0]))
def test_arrows_look_outwards_either_way(torque: float, sign: float) -> None:
    assert volume((geometry.arrow_vertices(geometry.arrow_span(sign * torque)), bodies.arrow_faces())) > 0.0


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (geometry.all_leaves(0.2, 0.2), bodies.leaf_faces()),
        (geometry.arrow_vertices(0.5), bodies.arrow_faces()),
        bodies.motor_ring(),
        bodies.motor_body(),
        bodies.link_bar(),
        bodies.floor_shadow(),
    ],
)
def test_meshes_are_float32_triangles_within_their_corners(vertices: Vertices, faces: NDArray[np.uint32]) -> None:
    assert vertices.dtype == np.dtype(np.float32)
    assert faces.dtype == np.dtype(np.uint32)
    assert vertices.shape[1] == faces.shape[1] == 3
    assert np.isfinite(vertices).all()
    assert faces.max() < len(vertices)


def test_a_light_page_exchanges_every_colour_and_a_dark_one_none() -> None:
    assert exchange("dark") == {}
    assert exchange("light") == {",".join(map(str, rgb(DARK[role]))): rgb(LIGHT[role]) for role in DARK}
    assert len(exchange("light")) == len(DARK) == len(LIGHT)  # two roles of one colour could not be told apart
