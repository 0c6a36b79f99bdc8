import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from shape_meshes import Solid, box, cells, cylinder, icosphere, joined, loose, prism, rotation, seen_from_inside

from morse.assets.shapes import ConvexPart, Primitive, convex_parts
from tests.kit.effort import examples

pytestmark = pytest.mark.long

L_SHAPE = cells([[[1], [1]], [[1], [0]]], [0, 1, 2], [0, 1, 2], [0, 1])


def room():
    """5 x 4 x 3 m inside, walls of 0.2 m, a doorway 1 m wide and 2 m high in the wall toward +X."""
    xs, ys, zs = [-0.2, 0, 5, 5.2], [-0.2, 0, 1.5, 2.5, 4, 4.2], [-0.2, 0, 2, 3, 3.2]
    filled = np.ones((3, 5, 4), bool)
    filled[1, 1:4, 1:3] = False
    filled[2, 2, 1] = False
    return cells(filled, xs, ys, zs)


def kinds(parts):
    return sorted(part.kind if isinstance(part, Primitive) else "convex" for part in parts)


def test_separate_solids_become_a_part_each():
    hexagon = [(math.cos(a), math.sin(a)) for a in np.arange(6) * math.pi / 3]
    mesh = joined(
        box((1, 1, 1)),
        icosphere(1.0, 2, (5, 0, 0)),
        cylinder(1.0, 2.0, 24, (10, 0, 0)),
        prism(hexagon, 3, 4),
    )
    warnings = []
    for shape in (mesh, loose(mesh)):
        assert kinds(convex_parts(*shape, warnings=warnings)) == ["box", "convex", "cylinder", "sphere"]
    assert warnings == []


def test_crates_that_touch_stay_two():
    parts = convex_parts(*joined(box((1, 1, 1)), box((1, 1, 1), (2, 0, 0))))
    assert kinds(parts) == ["box", "box"]


def test_a_convex_solid_keeps_its_corners():
    vertices, triangles = prism([(0, 0), (2, 0), (2.5, 1), (1, 2), (-0.5, 1)], 0, 1)
    (part,) = convex_parts(vertices, triangles)
    assert isinstance(part, ConvexPart)
    assert sorted(map(tuple, part.points)) == sorted(map(tuple, vertices))


def test_a_quad_becomes_a_thin_box_below_its_face():
    (part,) = convex_parts([[0, 0, 1], [4, 0, 1], [4, 2, 1], [0, 2, 1]], [[0, 1, 2], [0, 2, 3]])
    assert part.kind == "box"
    assert sorted(part.size[:2]) == pytest.approx([1, 2])
    solid = Solid([part])
    assert solid.clearance((2, 1, 1.5)) == pytest.approx(0.5, abs=1e-4)
    assert solid.is_solid((2, 1, 0.99))
    assert not solid.is_solid((2, 1, 0.85))


def test_a_fine_grid_of_quads_is_one_box():
    n = 60
    x, y = np.meshgrid(np.linspace(0, 10, n), np.linspace(0, 5, n), indexing="ij")
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.vstack([np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])])
    (part,) = convex_parts(np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)]), triangles)
    assert part.kind == "box"
    assert sorted(part.size[:2]) == pytest.approx([2.5, 5])


def test_an_l_shape_leaves_its_notch_free():
    solid = Solid(convex_parts(*L_SHAPE))
    assert solid.clearance((1.5, 1.5, 0.5)) == pytest.approx(0.5, abs=1e-3)
    for behind_a_face in ((0.5, 0.01, 0.5), (1.5, 0.99, 0.5), (0.99, 1.5, 0.5), (0.5, 0.5, 0.99), (1.5, 0.5, 0.01)):
        assert solid.is_solid(behind_a_face)


@pytest.mark.parametrize("turn", [np.eye(3), rotation(0.3, -0.8, 2.0)], ids=["straight", "turned"])
@pytest.mark.parametrize("shape", [lambda mesh: mesh, loose], ids=["welded", "loose"])
def test_a_room_can_be_entered_by_its_doorway(turn, shape):
    vertices, triangles = shape(room())
    warnings = []
    parts = convex_parts(vertices @ turn.T, triangles, warnings=warnings)
    solid = Solid(parts)
    assert warnings == []
    assert solid.clearance(turn @ (2.5, 2, 1.5)) == pytest.approx(1.5, abs=1e-3)
    for x in np.linspace(2.5, 8.0, 12):
        assert solid.clearance(turn @ (x, 2.0, 1.0)) >= 0.5 - 1e-3
    for wall in ((5.01, 0.5, 1), (5.19, 0.5, 1), (5.05, 2, 2.5), (-0.01, 2, 1), (2, 2, -0.01), (2, 2, 3.19)):
        assert solid.is_solid(turn @ wall)
    assert all(isinstance(part, Primitive) for part in parts)


def test_a_sealed_room_is_hollow():
    mesh = joined(box((3, 3, 2)), seen_from_inside(box((2.8, 2.8, 1.8))))
    solid = Solid(convex_parts(*mesh))
    assert solid.clearance((0, 0, 0)) == pytest.approx(1.8, abs=1e-3)
    for wall in ((2.81, 0, 0), (2.99, 0, 0), (0, 0, -1.99)):
        assert solid.is_solid(wall)


def test_a_room_without_outside_is_hollow():
    solid = Solid(convex_parts(*seen_from_inside(box((3, 3, 2)))))
    assert solid.clearance((0, 0, 0)) == pytest.approx(2.0, abs=1e-3)
    assert solid.is_solid((0, 0, 2.01))


def test_an_open_tray_holds_things():
    vertices, triangles = box((1, 1, 0.5))
    lid = (vertices[triangles][:, :, 2] > 0).all(axis=1)
    solid = Solid(convex_parts(vertices, triangles[~lid]))
    assert not solid.is_solid((0, 0, 0.4))
    assert solid.is_solid((0, 0, -0.49))


def test_plates_do_not_show_through_thin_walls():
    mesh = cells([[[1, 1], [1, 0]], [[1, 0], [1, 0]]], [0, 1, 2], [0, 1, 1.02], [0, 0.01, 1])
    outside = [(0.5, 1.01, -0.002), (1.5, 0.5, 0.013), (0.5, 1.01, 0.5), (1.5, 0.5, -0.002)]
    solid = Solid(convex_parts(*mesh))
    assert [solid.is_solid(point) for point in outside] == [False] * 4
    assert solid.is_solid((1.5, 0.5, 0.005))


def test_plates_do_not_show_through_sharp_edges():
    wedge, faces = prism([(0, 0), (2, 0), (2, 0.3)], 0, 1)
    mesh = joined((wedge, faces), seen_from_inside(box((0.01, 0.01, 0.01), (1.7, 0.1, 0.5))))
    solid = Solid(convex_parts(*mesh))
    for x in np.linspace(0.05, 1.95, 20):
        assert not solid.is_solid((x, 0.15 * x + 0.002, 0.5))
        assert not solid.is_solid((x, -0.002, 0.5))
        assert solid.is_solid((x, 0.15 * x - 0.001, 0.5))


def test_a_wall_with_a_window_leaves_it_open():
    vertices = np.array([[0, 0], [4, 0], [4, 3], [0, 3], [1, 1], [3, 1], [3, 2], [1, 2]], float)
    triangles = [(0, 1, 4), (1, 5, 4), (1, 2, 5), (2, 6, 5), (2, 3, 6), (3, 7, 6), (3, 0, 7), (0, 4, 7)]
    parts = convex_parts(np.column_stack([vertices, np.zeros(8)]), triangles)
    solid = Solid(parts)
    assert len(parts) <= 8
    assert not solid.is_solid((2, 1.5, -0.01))
    for place in ((0.5, 1.5), (3.5, 1.5), (2, 0.5), (2, 2.5), (0.1, 0.1), (3.9, 2.9)):
        assert solid.is_solid((*place, -0.01))


def hills(n, width=20.0):
    x, y = np.meshgrid(np.linspace(0, width, n), np.linspace(0, width, n), indexing="ij")
    z = np.sin(x) * np.cos(0.7 * y)
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    triangles = np.vstack([np.column_stack([i, i + n, i + n + 1]), np.column_stack([i, i + n + 1, i + 1])])
    return np.column_stack([x.ravel(), y.ravel(), z.ravel()]), triangles


def above(point, height):
    x, y, z = point
    return x, y, z + height


def test_terrain_is_exact_while_the_limit_allows():
    vertices, triangles = hills(30)
    warnings = []
    parts = convex_parts(vertices, triangles, warnings=warnings)
    assert warnings == []
    assert len(parts) <= len(triangles)
    solid = Solid(parts)
    for corner in vertices[[35, 217, 333, 612, 801]]:
        assert solid.clearance(above(corner, 0.2)) <= 0.2 + 1e-4
        assert not solid.is_solid(above(corner, 0.01))


def test_terrain_beyond_the_limit_is_coarser_and_says_so():
    vertices, triangles = hills(60)
    warnings = []
    parts = convex_parts(vertices, triangles, limit=1000, warnings=warnings)
    assert 1 < len(parts) <= 1000
    (said,) = warnings
    assert "1000" in said
    assert "error of up to" in said
    solid = Solid(parts)
    for corner in vertices[::371]:
        assert not solid.is_solid(above(corner, 0.3))
        assert solid.clearance(corner) < 0.3
    for corner in vertices[[0, 59, -60, -1]]:
        assert solid.clearance(corner) < 0.01


@pytest.mark.parametrize("limit", [1, 2, 3, 5, 8, 13, 21, 34, 55, 89])
def test_every_limit_is_kept(limit):
    tube = cylinder(0.01, 2.0, 24)
    tube = tube[0], tube[1][44:]
    for mesh in (L_SHAPE, room(), hills(12), tube, joined(tube, hills(5), L_SHAPE)):
        warnings = []
        parts = convex_parts(*mesh, limit=limit, warnings=warnings)
        assert 1 <= len(parts) <= limit
        Solid(parts)
        assert warnings or len(parts) == len(convex_parts(*mesh))


def test_beyond_all_limits_the_hull_is_left():
    warnings = []
    parts = convex_parts(*L_SHAPE, limit=2, warnings=warnings)
    assert len(parts) == 1
    assert "convex hull" in warnings[0]
    assert Solid(parts).is_solid((1.4, 1.4, 0.5))


def test_many_small_pieces_are_grouped():
    boxes = [box((0.1, 0.1, 0.1), (x, y, 0)) for x in range(20) for y in range(5)]
    for limit in (1, 2, 10, 99):
        warnings = []
        parts = convex_parts(*joined(*boxes), limit=limit, warnings=warnings)
        assert len(parts) <= limit
        assert "combined with neighbours into hulls" in warnings[-1]
        solid = Solid(parts)
        assert all(solid.is_solid((x, y, 0)) for x in range(20) for y in range(5))
    assert len(convex_parts(*joined(*boxes), limit=100)) == 100


@pytest.mark.parametrize("limit", [0, -1])
def test_a_limit_below_one_is_refused(limit):
    with pytest.raises(ValueError, match="limit"):
        convex_parts(*L_SHAPE, limit=limit)


@pytest.mark.parametrize(
    "mesh",
    [
        ([], []),
        (np.zeros((3, 3)), [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]),
        (np.full((3, 3), np.nan), [[0, 1, 2]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]]),
        ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], []),
    ],
    ids=["empty", "point", "line", "NaN", "missing vertex", "no triangles"],
)
def test_meshes_without_area_have_no_parts(mesh):
    assert convex_parts(*mesh) == []


def test_a_mesh_in_one_place_far_away_is_the_same():
    vertices, triangles = loose(room())
    far = (vertices + np.array([3000.0, -2000.0, 100.0])).astype(np.float32)
    assert len(convex_parts(far, triangles)) == len(convex_parts(vertices, triangles))


@settings(max_examples=examples(40), deadline=None)
@given(hnp.arrays(bool, (3, 3, 3)), st.booleans())
def test_every_building_of_blocks(filled, as_soup):
    mesh = cells(filled, [0, 1, 2.5, 3], [0, 0.7, 2, 3], [0, 1, 1.4, 3])
    parts = convex_parts(*(loose(mesh) if as_soup else mesh))
    if not filled.any():
        assert parts == []
        return
    solid = Solid(parts)
    vertices, triangles = mesh
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    for middle, normal in zip(corners.mean(axis=1), normals, strict=True):
        assert solid.is_solid(middle - 1e-3 * normal)
        assert not solid.is_solid(middle + 1e-3 * normal)
    lines = ([0, 1, 2.5, 3], [0, 0.7, 2, 3], [0, 1, 1.4, 3])
    for cell in np.argwhere(~filled):
        centre = [(line[i] + line[i + 1]) / 2 for line, i in zip(lines, cell, strict=True)]
        room_to_move = min((line[i + 1] - line[i]) / 2 for line, i in zip(lines, cell, strict=True))
        assert solid.clearance(centre) >= room_to_move - 2e-3


@settings(max_examples=examples(60), deadline=None)
@given(
    hnp.arrays(np.float64, st.tuples(st.integers(1, 12), st.just(3)), elements=st.floats(-1e6, 1e6) | st.just(np.nan)),
    hnp.arrays(np.int64, st.tuples(st.integers(0, 20), st.just(3)), elements=st.integers(-2, 13)),
)
def test_rubbish_gives_parts_that_are_finite(vertices, triangles):
    for part in convex_parts(vertices, triangles, limit=50):
        shape = part.to_shape()
        numbers = [
            *shape.size,
            *shape.position,
            *shape.rotation,
            *np.ravel(part.points if isinstance(part, ConvexPart) else 0),
        ]
        assert np.isfinite(numbers).all()
        assert all(value > 0 for value in shape.size)
        if isinstance(part, ConvexPart):
            assert np.isfinite(part.points).all()
            assert np.linalg.matrix_rank(part.points - part.points.mean(axis=0), tol=1e-9) == 3


def boxes(count):
    vertices, triangles = box((0.3, 0.3, 0.3))
    return joined(*[(np.add(vertices, (i % 100, i // 100, 0)), triangles) for i in range(count)])


def soup(count):
    points, triangles = np.random.default_rng(1), np.random.default_rng(2)
    return points.random((count // 2, 3)), triangles.integers(0, count // 2, (count, 3))


@pytest.mark.parametrize(
    "make",
    [
        lambda: icosphere(1.0, 6),
        lambda: boxes(8000),
        pytest.param(lambda: hills(224), marks=pytest.mark.slow),
        pytest.param(lambda: soup(100_000), marks=pytest.mark.slow),
        lambda: soup(10_000),
    ],
    ids=["sphere", "pieces", "terrain", "soup", "small soup"],
)
def test_a_hundred_thousand_triangles_take_seconds(make):
    mesh = make()
    started = time.process_time()
    parts = convex_parts(*mesh)
    assert 1 <= len(parts) <= 4096
    assert time.process_time() - started < 60.0  # two seconds on most machines, hours if each met each
