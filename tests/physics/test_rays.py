"""Rays against worlds whose answers are known."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ray_formulas import first_hit, grazes
from worlds import box, node, robot, world

from morse.scene import CollisionShape, PhysicsType, ShapeKind

FREE_OR_FIXED = st.sampled_from([PhysicsType.STATIC, PhysicsType.RIGID_BODY])
lengths = st.floats(0.05, 2.0)
places = st.tuples(*[st.floats(-8.0, 8.0)] * 3)
angles = st.tuples(*[st.floats(-math.pi, math.pi)] * 3)


@st.composite
def shapes(draw):
    kind = draw(st.sampled_from([kind for kind in ShapeKind if kind is not ShapeKind.CONVEX]))
    count = {ShapeKind.SPHERE: 1, ShapeKind.CYLINDER: 2, ShapeKind.CAPSULE: 2}.get(kind, 3)
    return CollisionShape(kind, tuple(draw(lengths) for _ in range(count)))


solids = st.lists(st.tuples(shapes(), places, angles, FREE_OR_FIXED), min_size=1, max_size=6)


def rotation_of(angles):
    (sx, sy, sz), (cx, cy, cz) = np.sin(angles), np.cos(angles)
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def directions(count, seed):
    rows = np.random.default_rng(seed).normal(size=(count, 3))
    return rows / np.linalg.norm(rows, axis=1)[:, None]


def scene_of(solids, eye):
    nodes = [
        node(f"solid{i}", shape, at=place, turned=turn, kind=kind)
        for i, (shape, place, turn, kind) in enumerate(solids)
    ]
    body = robot("eye", box(0.3, 0.3, 0.3), at=eye)
    w = world(*nodes, body, robots=[body], gravity=0.0)
    known = [(shape, np.array(place), rotation_of(turn)) for shape, place, turn, _ in solids]
    return w, known


@settings(max_examples=60, deadline=None)
@given(solids=solids, eye=places, count=st.sampled_from([20, 200]), seed=st.integers(0, 1000))
def test_rays_at_primitives_match_closed_formulas(solids, eye, count, seed):
    """Whatever the engine behind: few rays or many, bodies that move or stand still."""
    w, known = scene_of(solids, eye)
    ways = directions(count, seed)
    bundle = w.rays.bundle(w.game_object("eye"), ways, math.inf)
    bundle.refresh()
    start = np.array(eye)
    for way, distance in zip(ways, bundle.distances, strict=True):
        expected = first_hit(known, start, way)
        if not grazes(known, start, way):
            assert distance == pytest.approx(expected, abs=1e-5)
