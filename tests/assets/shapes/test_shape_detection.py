import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shape_meshes import box, cells, cylinder, icosphere, joined, loose, rotation, seen_from_inside

from morse.assets.shapes import detect_primitive, fit_bounds
from morse.scene.body import Bounds
from tests.kit.effort import examples

sizes = st.floats(0.05, 20.0)
angles = st.floats(-math.pi, math.pi)
places = st.tuples(*[st.floats(-50, 50)] * 3)


def same_box(found, half, centre, turn):
    """True if two boxes are the same solid, whatever the order of their axes."""
    mine = np.abs(np.array(turn).T @ found.rotation)
    size = max(half)
    return (
        np.allclose(found.position, centre, atol=1e-4 * size + 1e-6)
        and np.allclose(np.sort(mine.max(axis=0)), 1.0, atol=1e-4)
        and np.allclose(mine.round() @ np.array(found.size), half, rtol=1e-3)
        and np.isclose(np.linalg.det(found.rotation), 1.0)
    )


@pytest.mark.parametrize("cuts", [1, 2, 5])
@pytest.mark.parametrize("shape", [lambda mesh: mesh, loose])
def test_box(cuts, shape):
    found = detect_primitive(*shape(box((1, 2, 3), (10, 20, 30), cuts=cuts)))
    assert found.kind == "box"
    assert found.size == pytest.approx((1, 2, 3))
    assert found.position == pytest.approx((10, 20, 30))
    assert np.allclose(found.rotation, np.eye(3))


@settings(max_examples=examples(60), deadline=None)
@given(st.tuples(sizes, sizes, sizes), places, angles, angles, angles)
def test_a_box_turned_any_way(half, centre, roll, pitch, yaw):
    turn = rotation(roll, pitch, yaw)
    found = detect_primitive(*box(half, centre, turn))
    assert found is not None
    assert found.kind == "box"
    assert same_box(found, half, centre, turn)


def test_a_box_with_small_bevels_is_still_a_box():
    vertices, triangles = box((1, 1, 1), cuts=10)
    corner = np.abs(vertices).min(axis=1) > 0.99
    vertices[corner] *= 0.985
    assert detect_primitive(vertices, triangles).kind == "box"


@pytest.mark.parametrize("rounds", [1, 2, 3])
def test_sphere(rounds):
    found = detect_primitive(*icosphere(1.5, rounds, (1, 2, 3)))
    assert found.kind == "sphere"
    assert found.size == pytest.approx((1.5,), rel=1e-6)
    assert found.position == pytest.approx((1, 2, 3))


def test_an_icosahedron_is_no_sphere():
    assert detect_primitive(*icosphere(1.0, 0)) is None


@settings(max_examples=examples(60), deadline=None)
@given(sizes, sizes, st.integers(8, 64), places, angles, angles)
def test_a_cylinder_turned_any_way(radius, half, sides, centre, roll, pitch):
    turn = rotation(roll, pitch, 0.0)
    found = detect_primitive(*cylinder(radius, half, sides, centre, turn))
    assert found is not None
    assert found.kind == "cylinder"
    assert found.size == pytest.approx((radius, half), rel=1e-3)
    assert found.position == pytest.approx(centre, abs=1e-3 * max(radius, half) + 1e-6)
    assert abs(found.rotation[:, 2] @ turn[:, 2]) == pytest.approx(1.0, abs=1e-6)
    assert np.linalg.det(found.rotation) == pytest.approx(1.0)


def test_a_cylinder_twice_as_long_as_its_radius_has_no_main_normal():
    found = detect_primitive(*cylinder(1.0, 1.0, 32, turn=rotation(0.4, 0.8, 0.0)))
    assert found.kind == "cylinder"
    assert found.size == pytest.approx((1.0, 1.0), rel=1e-3)


def test_a_prism_of_six_sides_is_no_cylinder():
    assert detect_primitive(*cylinder(1.0, 1.0, 6)) is None


@pytest.mark.parametrize(
    "mesh",
    [
        seen_from_inside(box((1, 1, 1))),
        seen_from_inside(icosphere(1.0, 2)),
        joined(box((1, 1, 1)), box((1, 1, 1), (5, 0, 0))),
        joined(box((1, 1, 1)), seen_from_inside(box((0.9, 0.9, 0.9)))),
        cells([[[1], [1]], [[1], [0]]], [0, 1, 2], [0, 1, 2], [0, 1]),
        (box((1, 1, 1))[0], box((1, 1, 1))[1][:-4]),
        (np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]])),
    ],
    ids=["room", "dome", "two boxes", "hollow box", "L", "box without two sides", "quad"],
)
def test_what_is_no_primitive(mesh):
    assert detect_primitive(*mesh) is None


def test_rubbish_holds_no_primitive():
    assert detect_primitive(np.empty((0, 3)), np.empty((0, 3), int)) is None
    assert detect_primitive([], []) is None
    assert detect_primitive(np.full((8, 3), np.nan), box((1, 1, 1))[1]) is None
    assert detect_primitive(np.zeros((8, 3)), box((1, 1, 1))[1]) is None


def test_rubbish_beside_a_box_does_not_hide_it():
    vertices, triangles = box((1, 2, 3))
    vertices = np.vstack([vertices, [[np.nan, 0, 0], [np.inf, 1, 1], [1e30, 0, 0]]])
    triangles = np.vstack([triangles, [[0, 1, 8], [2, 3, 9], [4, 5, 10], [0, 0, 1], [0, 1, 99], [-1, 0, 1]]])
    assert detect_primitive(vertices, triangles).size == pytest.approx((1, 2, 3))


@pytest.mark.parametrize(
    ("vertices", "triangles"),
    [([[1, 2]], [[0, 0, 0]]), ([[0, 0, 0]], [[0, 0]]), ([[0, 0, 0]], [[0.5, 1.0, 2.0]]), ("abc", [[0, 1, 2]])],
)
def test_arrays_of_other_shapes_are_refused(vertices, triangles):
    with pytest.raises(ValueError, match="given"):
        detect_primitive(vertices, triangles)


@pytest.mark.parametrize(
    ("bounds", "kind", "size"),
    [
        (Bounds.BOX, "box", (1, 2, 3)),
        (Bounds.SPHERE, "sphere", (3,)),
        (Bounds.CYLINDER, "cylinder", (2, 3)),
        (Bounds.CONE, "cone", (2, 3)),
        (Bounds.CAPSULE, "capsule", (2, 1)),
    ],
)
def test_bounds_are_fitted_to_the_bounding_box(bounds, kind, size):
    found = fit_bounds(box((1, 2, 3), (4, 5, 6))[0], bounds)
    assert found.kind == kind
    assert found.size == pytest.approx(size)
    assert found.position == pytest.approx((4, 5, 6))
    assert np.allclose(found.rotation, np.eye(3))


def test_bounds_of_a_plane_have_some_thickness():
    assert fit_bounds([[0, 0, 0], [2, 0, 0], [2, 4, 0]], Bounds.BOX).size == pytest.approx((1, 2, 1e-3))
    assert fit_bounds([[0, 0, 0]], Bounds.SPHERE).size == pytest.approx((1e-3,))


def test_bounds_need_points_and_a_primitive():
    for empty in (np.empty((0, 3)), [[np.nan, 0, 0]]):
        with pytest.raises(ValueError, match="finite"):
            fit_bounds(empty, Bounds.BOX)
    for bounds in (Bounds.CONVEX_HULL, Bounds.TRIANGLE_MESH):
        with pytest.raises(ValueError, match="convex_parts"):
            fit_bounds([[0, 0, 0]], bounds)


def test_a_cone_becomes_a_hull_with_its_tip_up():
    points = fit_bounds(box((1, 1, 2), (0, 0, 2))[0], Bounds.CONE).to_shape().vertices
    assert points[points[:, 2] > 0.1] == pytest.approx(np.array([[0, 0, 4]]))
    assert np.hypot(*points[points[:, 2] < 0.1][:, :2].T) == pytest.approx(1.0)
