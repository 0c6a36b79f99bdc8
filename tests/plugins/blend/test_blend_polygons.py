"""Triangles and normals from polygons, against geometry."""

from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.assets.polygons import Polygons, corner_normals
from morse.plugins.blend.container import Damage
from morse.plugins.blend.polygons import gather, triangulate


def polygons(vertices: list | np.ndarray, faces: list[list[int]], **arrays: object) -> Polygons:
    sizes = np.array([len(face) for face in faces], dtype=np.int64)
    corners = np.array([index for face in faces for index in face], dtype=np.int64)
    return gather(np.asarray(vertices, dtype=float).reshape(-1, 3), corners, np.cumsum(sizes) - sizes, sizes, **arrays)


def areas(mesh: Polygons) -> np.ndarray:
    """(T, 3) normals of the triangles, with the lengths of their areas."""
    corners, _ = triangulate(mesh)
    a, b, c = (mesh.vertices[mesh.corners[corners[:, k]]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def sphere(rings: int, sides: int) -> tuple[np.ndarray, list[list[int]]]:
    """Unit sphere of quads, and triangles at the poles."""
    vertices = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings):
        polar = pi * ring / rings
        vertices += [
            (sin(polar) * cos(2 * pi * k / sides), sin(polar) * sin(2 * pi * k / sides), cos(polar))
            for k in range(sides)
        ]
    vertices.append((0.0, 0.0, -1.0))
    last = len(vertices) - 1
    faces = [[0, 1 + k, 1 + (k + 1) % sides] for k in range(sides)]
    for ring in range(rings - 2):
        at = 1 + ring * sides
        faces += [[at + k, at + sides + k, at + sides + (k + 1) % sides, at + (k + 1) % sides] for k in range(sides)]
    faces += [[last, last - sides + (k + 1) % sides, last - sides + k] for k in range(sides)]
    return np.array(vertices), faces


@given(
    radii=st.lists(st.floats(0.2, 3.0), min_size=3, max_size=24),
    tilt=st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
    far=st.floats(-100, 100),
)
def test_any_star_is_covered_exactly_once(radii: list[float], tilt: tuple[float, float], far: float) -> None:
    angles = [2 * pi * k / len(radii) for k in range(len(radii))]
    flat = [(r * cos(a), r * sin(a)) for r, a in zip(radii, angles, strict=True)]
    points = [(x + far, y, tilt[0] * x + tilt[1] * y) for x, y in flat]
    found = areas(polygons(points, [list(range(len(points)))]))
    upward = found[:, 2]
    count = len(flat)
    expected = (
        sum(flat[k][0] * flat[(k + 1) % count][1] - flat[k][1] * flat[(k + 1) % count][0] for k in range(count)) / 2
    )
    assert len(found) <= count - 2
    # no triangle is flipped: together they can cover the area only if none overlaps another
    assert upward.min() > -1e-6
    assert upward.sum() == pytest.approx(expected, rel=1e-6)


def test_a_dented_quad_is_split_at_its_dent() -> None:
    for turn in range(4):
        dart = np.roll([(0, 0, 0), (3, 1, 0), (0.5, 0.5, 0), (1, 3, 0)], turn, axis=0)
        found = areas(polygons(dart, [[0, 1, 2, 3]]))
        assert (found[:, 2] > 0).all()


def test_corners_on_straight_sides_are_no_obstacle() -> None:
    ell = [(0, 0), (1, 0), (2, 0), (2, 1), (1.5, 1), (1, 1), (1, 1.5), (1, 2), (0, 2), (0, 1)]
    for axes in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        vertices = np.array([(x, y, 5.0) for x, y in ell])[:, axes]
        found = areas(polygons(vertices, [list(range(len(ell)))]))
        upward = found[:, axes.index(2)]
        assert (upward >= 0).all()
        assert upward.sum() == pytest.approx(3)
        assert np.abs(found).sum() == pytest.approx(3)


def test_triangles_come_in_the_order_of_their_polygons() -> None:
    vertices, faces = sphere(6, 8)
    mesh = polygons(vertices, faces)
    _, owner = triangulate(mesh)
    assert (np.diff(owner) >= 0).all()
    assert np.bincount(owner).tolist() == [len(face) - 2 for face in faces]


def test_a_sphere_is_closed_and_looks_outward() -> None:
    mesh = polygons(*sphere(24, 32))
    found = areas(mesh)
    assert found.sum(axis=0) == pytest.approx([0, 0, 0], abs=1e-12)
    assert np.linalg.norm(found, axis=1).sum() == pytest.approx(4 * pi, rel=0.02)


def test_normals_of_a_smooth_sphere_point_away_from_its_centre() -> None:
    vertices, faces = sphere(24, 32)
    mesh = polygons(vertices, faces, smooth=np.ones(len(faces), dtype=bool))
    for crease in (None, pi, pi / 3):
        normals = corner_normals(mesh, crease)
        assert np.einsum("ij,ij->i", normals, mesh.vertices[mesh.corners]).min() > 0.999


def test_creases_make_a_sphere_flat() -> None:
    vertices, faces = sphere(8, 8)
    mesh = polygons(vertices, faces, smooth=np.ones(len(faces), dtype=bool))
    normals = corner_normals(mesh, 0.1)
    assert normals == pytest.approx(mesh.normals[mesh.polygon], abs=1e-9)


def test_marked_edges_part_normals() -> None:
    ridge = [(0, 0, 0), (1, 0, 1), (1, 2, 1), (0, 2, 0), (2, 0, 0), (2, 2, 0)]
    faces = [[0, 1, 2, 3], [1, 4, 5, 2]]
    for sharp, steepness in (([[2, 1]], 0.5**0.5), ([[0, 3]], 1.0)):
        mesh = polygons(ridge, faces, smooth=np.ones(2, dtype=bool), sharp=np.array(sharp))
        normals = corner_normals(mesh, pi)
        top = mesh.vertices[mesh.corners][:, 2] == 1
        assert normals[top][:, 2] == pytest.approx([steepness] * 4)


def test_neighbours_that_are_inside_out_do_not_confuse_corners() -> None:
    # both faces are in the plane z = 0, the second one with the opposite orientation
    mesh = polygons(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)],
        [[0, 1, 2, 3], [1, 2, 5, 4]],
        smooth=np.ones(2, dtype=bool),
    )
    normals = corner_normals(mesh, pi / 2)
    assert normals[:4] == pytest.approx(np.broadcast_to([0.0, 0, 1], (4, 3)))
    assert normals[4:] == pytest.approx(np.broadcast_to([0.0, 0, -1], (4, 3)))


def test_flat_meshes_have_no_normals() -> None:
    assert corner_normals(polygons(*sphere(4, 4)), None) is None


def test_degenerate_polygons_give_no_rubbish() -> None:
    mesh = polygons(
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, 0), (0, 1, 0)],
        [[0, 1, 2], [0, 3, 4], [0, 0, 0, 0, 0], [0, 1, 2, 3, 4]],
        smooth=np.ones(4, dtype=bool),
    )
    corners, _ = triangulate(mesh)
    assert len(corners) == 1 + 1 + 3 + 3
    assert np.isfinite(corner_normals(mesh, pi / 6)).all()


def test_clipping_takes_a_moment_only(monkeypatch: pytest.MonkeyPatch) -> None:
    count = 1000
    angles = np.arange(count) * 2 * pi / count
    radii = 1 + 0.5 * (np.arange(count) % 2)
    star = np.stack([radii * np.cos(angles), radii * np.sin(angles), np.zeros(count)], axis=1)
    mesh = polygons(np.tile(star, (5, 1)), np.arange(5 * count).reshape(5, count).tolist())
    # enough for two of the five stars; the others are triangulated as if they were convex, with as many triangles
    monkeypatch.setattr("morse.plugins.blend.polygons._CLIP_BUDGET", 2 * count**2)
    upward = areas(mesh)[:, 2].reshape(5, -1)
    assert (upward > 0).all(axis=1).tolist() == [True, True, False, False, False]


def test_overlapping_polygons_are_refused() -> None:
    vertices, corners = np.zeros((3, 3)), np.array([0, 1, 2])
    for starts, sizes in (([0, 0], [3, 3]), ([1], [3]), ([-1], [3]), ([0], [-3])):
        with pytest.raises(Damage):
            gather(vertices, corners, np.array(starts), np.array(sizes))
