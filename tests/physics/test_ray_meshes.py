"""Rays against triangle meshes: the triangles count, not the convex parts for contacts."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from test_rays import directions, eye, look, names
from worlds import box, node, robot, scene

from morse.assets.collision import resolve_shapes
from morse.physics import World
from morse.scene import BodySettings, Bounds, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind
from tests.kit.effort import examples


def mesh_node(name, vertices, triangles, *, kind=PhysicsType.STATIC, bounds=None, materials=(), index=None, **settings):
    made = Node(name, NodeKind.MESH, **settings)
    made.mesh = Mesh(
        name,
        np.asarray(vertices, dtype=np.float32),
        np.asarray(triangles, dtype=np.int32),
        np.zeros(len(triangles), dtype=np.int32) if index is None else np.asarray(index, dtype=np.int32),
    )
    made.materials = list(materials)
    made.body = BodySettings(type=kind, bounds=bounds)
    return made


def world_of(*roots, robots=()):
    made = scene(*roots, robots=robots, gravity=0.0)
    resolve_shapes(made)
    return World(made)


def triangle_hits(corners, origin, direction):
    """Distances to triangles (T, 3, 3) by Cramer's rule, infinite for a miss."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    matrices = np.stack([b - a, c - a, np.broadcast_to(-direction, a.shape)], axis=2)
    answers = np.full(len(corners), np.inf)
    whole = np.abs(np.linalg.det(matrices)) > 1e-12
    u, v, t = np.linalg.solve(matrices[whole], (origin - a[whole])[:, :, None])[:, :, 0].T
    inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t >= 0)
    answers[np.flatnonzero(whole)[inside]] = t[inside]
    return answers


def edge_distance(corners, origin, direction):
    """The distance of the ray from an edge: near an edge, a rounding error decides what is hit."""
    starts, ends = corners.reshape(-1, 3), np.roll(corners, -1, axis=1).reshape(-1, 3)
    along = ends - starts
    across = np.cross(along, direction)
    lengths = np.linalg.norm(across, axis=1)
    gaps = np.abs(np.einsum("ij,ij->i", starts - origin, across)) / np.maximum(lengths, 1e-12)
    return gaps.min()


def shelf():
    """Faces of a box of 2 m that is open towards -X, as single walls."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))]


@pytest.mark.parametrize("kind", [PhysicsType.STATIC, PhysicsType.RIGID_BODY])
@pytest.mark.parametrize("bounds", [None, Bounds.TRIANGLE_MESH])
def test_a_ray_goes_into_an_open_box(kind, bounds):
    w = world_of(mesh_node("Shelf", *shelf(), kind=kind, bounds=bounds, location=[5, 0, 0]), eye())
    for extra in (np.empty((0, 3)), directions(200, 3)):
        seen = look(w, [[1, 0, 0], [4, 0.7, 0.7], [5, 0, 1.2], *extra])
        assert seen.distances[0] == pytest.approx(6.0)
        assert seen.distances[1] == pytest.approx(math.hypot(4, 0.7, 0.7) * 1.0 / 0.7)
        assert seen.distances[2] == pytest.approx(math.hypot(5, 0, 1.2) * 1.0 / 1.2, abs=1e-6)


def test_bounds_that_a_model_names_are_what_rays_hit():
    w = world_of(mesh_node("Shelf", *shelf(), bounds=Bounds.CONVEX_HULL, location=[5, 0, 0]), eye())
    assert look(w, [[1, 0, 0]]).distances[0] == pytest.approx(4.0)
    w = world_of(mesh_node("Shelf", *shelf(), bounds=Bounds.SPHERE, location=[5, 0, 0]), eye())
    # a ball of radius 1
    seen = look(w, [[1, 0, 0]], origins=[[0, 0.6, 0]])
    assert seen.distances[0] == pytest.approx(5 - 0.8, abs=1e-5)


@settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 10_000),
    moves=st.booleans(),
    count=st.sampled_from([10, 150]),
    scale=st.tuples(*[st.floats(0.2, 3.0)] * 3),
    turn=st.tuples(*[st.floats(-3, 3)] * 3),
    place=st.tuples(*[st.floats(-5, 5)] * 3),
)
def test_rays_at_meshes_match_the_rule_of_cramer(seed, moves, count, scale, turn, place):
    """Crumpled sheets, stretched and rotated, fixed or moving."""
    rng = np.random.default_rng(seed)
    vertices = np.array([(x, y, 0.0) for x in (-1, 0, 1) for y in (-1, 0, 1)]) + rng.uniform(-0.4, 0.4, (9, 3))
    triangles = [t for i in (0, 1, 3, 4) for t in ((i, i + 1, i + 4), (i, i + 4, i + 3))]
    kind = PhysicsType.RIGID_BODY if moves else PhysicsType.STATIC
    sheet = mesh_node(
        "Sheet", vertices, triangles, kind=kind, location=list(place), rotation_euler=list(turn), scale=list(scale)
    )
    w = world_of(sheet, eye())
    matrix = np.array([list(row) for row in sheet.world_matrix()])
    corners = (vertices.astype(np.float32) @ matrix[:3, :3].T + matrix[:3, 3])[np.array(triangles)]
    ways = directions(count, seed)
    seen = look(w, ways)
    for way, distance in zip(ways, seen.distances, strict=True):
        if edge_distance(corners, np.zeros(3), way) > 1e-4:
            assert distance == pytest.approx(triangle_hits(corners, np.zeros(3), way).min(), abs=1e-5)


def globe(rings=12, segments=36, radius=1.0):
    """A triangulated sphere with a ring of vertices at the height of its centre."""
    rows = [(0.0, 0.0, radius)]
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        turns = 2 * math.pi * np.arange(segments) / segments
        rows += [
            (radius * math.sin(polar) * math.cos(a), radius * math.sin(polar) * math.sin(a), radius * math.cos(polar))
            for a in turns
        ]
    rows.append((0.0, 0.0, -radius))
    triangles = []
    for i in range(segments):
        j = (i + 1) % segments
        triangles.append((0, 1 + i, 1 + j))
        for ring in range(rings - 2):
            a, b = 1 + ring * segments, 1 + (ring + 1) * segments
            triangles += [(a + i, b + i, b + j), (a + i, b + j, a + j)]
        last = 1 + (rings - 2) * segments
        triangles.append((last + i, len(rows) - 1, last + j))
    return rows, triangles


@pytest.mark.parametrize("kind", [PhysicsType.STATIC, PhysicsType.RIGID_BODY])
def test_no_ray_slips_through_an_edge(kind):
    """A planar scan exactly at the height of a ring of vertices, from inside a sphere."""
    rows, triangles = globe()
    rows[5] = tuple(1.3 * np.array(rows[5]))  # a dent: no primitive, and not convex
    w = world_of(mesh_node("Globe", rows, triangles, kind=kind), eye())
    turns = np.radians(np.arange(1080) / 3)
    seen = look(w, np.stack([np.cos(turns), np.sin(turns), 0 * turns], axis=1))
    nearest = math.cos(math.pi / 36)
    assert seen.distances.min() >= nearest - 1e-6
    assert seen.distances.max() <= 1.0 + 1e-6
    assert set(names(seen)) == {"Globe"}


@pytest.mark.parametrize("kind", [PhysicsType.STATIC, PhysicsType.RIGID_BODY])
def test_each_face_throws_back_the_light_of_its_own_material(kind):
    vertices = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    quads = [(4, 6, 7, 5), (0, 1, 3, 2), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    shiny, dull = Material("shiny", specular=0.9), Material("dull", specular=0.1)
    cube = mesh_node("Cube", vertices, triangles, kind=kind, materials=[shiny, dull], index=[1, 1] + [0] * 10)
    plain = node("Plain", box(0.1, 2, 2), at=(0, 5, 0), kind=kind)
    w = world_of(cube, plain, eye(at=(3, 0, 0)), eye("left", at=(-3, 0, 0)))
    ways = [[-1, 0, 0], [0, 0, 1]]
    assert look(w, ways).remissions.tolist() == pytest.approx([0.1, 0.0])
    assert look(w, [[1, 0, 0], *directions(100, 1)], of="left").remissions[0] == pytest.approx(0.9)
    # without a material: as with a new material
    assert look(w, [[-3, 5, 0]]).remissions.tolist() == [Material("new").specular]


@pytest.mark.parametrize("kind", [PhysicsType.STATIC, PhysicsType.RIGID_BODY])
def test_a_ball_throws_back_light_too_from_within_its_outline(kind):
    ball = node("Ball", CollisionShape(ShapeKind.SPHERE, (1.0,)), at=(3, 0, 0), kind=kind)
    ball.materials = [Material("shiny", specular=0.9)]
    w = world_of(ball, node("Wall", box(0.1, 9, 9), at=(5, 0, 0), kind=kind), eye(at=(2.2, 0.8, 0)))
    seen = look(w, [[0.8, -0.8, 0], [1, 1, 0], *directions(300, 2)])
    assert seen.distances[0] == pytest.approx(0.8 * math.sqrt(2) - 1.0)
    assert seen.remissions[:2].tolist() == [0.9, 0.5]


def test_a_robot_in_its_own_mesh_sees_what_is_around():
    body = mesh_node("shell", *shelf(), kind=PhysicsType.RIGID_BODY)
    body.attach(eye())
    wall = node("Wall", box(0.2, 9, 9), at=(4.1, 0, 0))
    other = robot("other", box(0.4, 0.4, 0.4), at=(0, 3, 0))
    w = world_of(body, wall, other, robots=[body, other])
    for extra in (np.empty((0, 3)), directions(200, 1)):
        seen = look(w, [[1, 0, 0], [0, 1, 0], *extra])
        assert names(seen)[:2] == ["Wall", "other"]
        assert seen.distances[:2] == pytest.approx([4.0, 2.8])
