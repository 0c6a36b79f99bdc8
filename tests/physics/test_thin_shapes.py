"""Shapes that are too thin for a hull do not prevent a world from being created."""

import logging
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from worlds import box, ground, node, rigid, run, sphere, world

from morse.assets.collision import resolve_shapes
from morse.physics import World
from morse.scene import Bounds, CollisionShape, Mesh, PhysicsType, Scene, ShapeKind
from tests.kit.effort import examples


def convex(points):
    return CollisionShape(ShapeKind.CONVEX, (), vertices=np.asarray(points, dtype=float))


SLIVER = convex([[0, 0, 0], [0.1, 0, 0], [0.1, 2e-9, 0], [0, 0, 1e-9]])
NO_NUMBERS = convex([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, math.nan]])


@pytest.mark.parametrize("shape", [SLIVER, NO_NUMBERS])
def test_a_part_that_the_engine_refuses_is_left_out_and_its_objects_are_named(shape, caplog):
    wall = node("Wall", box(1, 1, 1), at=(3, 0, 0.5))
    wall.shapes.append(shape)
    other = node("Other", shape)
    with caplog.at_level(logging.WARNING):
        w = world(ground(), wall, other, rigid("Ball", sphere(0.1), at=(3, 0, 1.2)))
    (record,) = [r for r in caplog.records if "too thin" in r.message]
    assert "'Wall', 'Other'" in record.message
    # the usable parts still collide
    run(w, 2.0)
    assert w.game_object("Ball").worldPosition.z == pytest.approx(1.1, abs=2e-3)


@pytest.mark.parametrize("shape", [SLIVER, NO_NUMBERS])
def test_a_body_that_moves_falls_and_rests_as_the_box_around_its_points(shape, caplog):
    body = rigid("Leaf", shape, at=(0, 0, 0.5))
    w = world(ground(), body)
    run(w, 3.0)
    assert w.game_object("Leaf").worldPosition.z == pytest.approx(0.0, abs=0.02)
    assert "'Leaf'" in caplog.text


def mesh(points, triangles):
    return Mesh("Mesh", np.array(points, float), np.array(triangles), np.zeros(len(triangles), int))


coordinates = st.one_of(
    st.floats(-1e3, 1e3, width=32), st.sampled_from([0.0, 1e-7, -1e-7, 1e-4, 1.0, 1.0 + 1e-6, 500.0, 500.0001])
)
meshes = st.lists(st.tuples(coordinates, coordinates, coordinates), min_size=3, max_size=9)


@settings(deadline=None, max_examples=examples(60))
@given(meshes, st.sampled_from([None, *Bounds]), st.sampled_from(["STATIC", "RIGID_BODY"]), st.data())
def test_every_mesh_becomes_a_world(points, bounds, kind, data):
    corner = st.integers(0, len(points) - 1)
    triangles = data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=8))
    made = node("Thing", None, kind=PhysicsType(kind), bounds=bounds, mass=1.0)
    made.shapes, made.mesh = None, mesh(points, triangles)
    scene = Scene(roots=[made])
    resolve_shapes(scene)
    w = World(scene)
    run(w, 0.1)
    assert all(map(math.isfinite, w.game_object("Thing").worldPosition))


@pytest.mark.parametrize("width", [1e-6, 2e-6, 5e-6, 2e-5])
def test_slivers_between_faces_do_not_keep_a_world_from_starting(width):
    # three faces of a cube around a corner that is cut off by a triangle of a few micrometres
    e, w = 0.4, width
    points = [
        [-w, 0, 0], [0, -w, 0], [0, 0, -w],
        [-e, 0, 0], [-e, -e, 0], [0, -e, 0], [0, -e, -e], [0, 0, -e], [-e, 0, -e],
    ]  # fmt: skip
    triangles = [
        [0, 2, 1], [3, 4, 0], [0, 4, 1], [4, 5, 1], [1, 5, 2], [5, 6, 2], [6, 7, 2], [0, 2, 3], [2, 8, 3], [2, 7, 8]
    ]  # fmt: skip
    made = node("Corner", None, at=(0.2, 0.2, 0))
    made.shapes, made.mesh = None, mesh(points, triangles)
    scene = Scene(roots=[made, rigid("Ball", sphere(0.1), at=(0, 0, 0.2))])
    assert resolve_shapes(scene) == []
    w = World(scene)
    run(w, 2.0)
    assert w.game_object("Ball").worldPosition.z == pytest.approx(0.1, abs=2e-3)
