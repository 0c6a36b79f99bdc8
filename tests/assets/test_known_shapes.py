"""Collision shapes are computed once for each content of a mesh."""

import numpy as np
import pytest

from morse.assets import collision
from morse.assets.shape_cache import ShapeCache, content
from morse.assets.solids import cube
from morse.scene import BodySettings, Bounds, CollisionShape, Mesh, Node, NodeKind, PhysicsType, Scene, ShapeKind


@pytest.fixture
def computed(monkeypatch):
    """The bounds of each mesh whose shapes are computed: no result of before, and no disk cache."""
    monkeypatch.setenv("MORSE_CACHE", "off")
    made = []
    compute = collision._parts
    monkeypatch.setattr(collision, "_EARLIER", ShapeCache())
    monkeypatch.setattr(collision, "_parts", lambda *arguments: made.append(arguments[2]) or compute(*arguments))
    return made


def copied(mesh):
    return Mesh(mesh.name, mesh.vertices.copy(), mesh.triangles.copy(), mesh.material_index.copy())


def shapes(mesh, bounds=None, scale=1.0):
    node = Node("solid", NodeKind.MESH, mesh=mesh, body=BodySettings(type=PhysicsType.RIGID_BODY, bounds=bounds))
    node.scale = (scale, scale, scale)
    assert collision.resolve_shapes(Scene(roots=[node])) == []
    return node.shapes


def test_a_mesh_of_the_same_content_is_not_computed_again(computed):
    first, second = shapes(copied(cube())), shapes(copied(cube()))
    assert len(computed) == 1
    assert first == second
    assert first is not second


def test_another_content_size_or_bound_is_another_shape(computed):
    moved = copied(cube())
    moved.vertices[:] *= 3.0
    sizes = [shapes(cube()), shapes(moved), shapes(cube(), scale=2.0), shapes(cube(), Bounds.SPHERE)]
    assert len(computed) == 4
    side = sizes[0][0].size[0]
    assert sizes[1][0].size == pytest.approx([3.0 * side] * 3)
    assert sizes[2][0].size == pytest.approx([2.0 * side] * 3)
    assert sizes[3][0].kind is ShapeKind.SPHERE


def test_warnings_are_given_each_time(computed, monkeypatch):
    monkeypatch.setattr(collision, "_parts", lambda *_: ([], ["too complex"]))
    for name in ("first", "second"):
        node = Node(name, NodeKind.MESH, mesh=copied(cube()), body=BodySettings(type=PhysicsType.STATIC))
        assert collision.resolve_shapes(Scene(roots=[node])) == [f"'{name}': too complex"]


def test_the_digest_tells_vertices_from_triangles():
    nothing = np.zeros((0, 3), np.float32)
    first = Mesh("first", np.ones((2, 3), np.float32), nothing.astype(np.int32), np.zeros(0, np.int32))
    second = Mesh("second", nothing, np.ones((2, 3), np.float32).view(np.int32), np.zeros(0, np.int32))
    assert content(first) != content(second)


def test_the_oldest_results_are_dropped():
    known = ShapeCache(most=20_000)
    points = (CollisionShape(ShapeKind.CONVEX, (), vertices=np.zeros((250, 3))),)  # 6 kB
    for key in "abc":
        known.put(key, (points, ()))
    assert known.get("a") == (points, ())  # used again: now the newest
    known.put("d", (points, ()))
    assert [key for key in "abcd" if known.get(key)] == ["a", "c", "d"]


def test_a_result_that_is_too_large_is_not_kept():
    known = ShapeCache(most=1_000)
    known.put("a", ((CollisionShape(ShapeKind.CONVEX, (), vertices=np.zeros((250, 3))),), ()))
    assert known.get("a") is None
