"""Meshes of simple solids."""

from __future__ import annotations

import itertools
import math
from functools import cache
from typing import TYPE_CHECKING

from morse.scene import Mesh, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

_SEGMENTS = 32
#: m, error of the surfaces of balls and cylinders, which lasers hit exactly; a quarter more at the poles of balls
_EXACT = 8e-5
#: half the height of the spherical cap over a face of an icosahedron, in radii; each subdivision divides it by four
_COARSE = 0.146
_MOST_SIDES, _MOST_SUBDIVISIONS = 256, 5
_Point = tuple[float, float, float]
_Face = tuple[int, ...]


def polyhedron(name: str, points: Sequence[_Point], faces: Sequence[_Face], *, smooth: bool = False) -> Mesh:
    """A mesh of convex faces; smooth ones have the directions from the origin as normals."""
    import numpy as np

    triangles = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
    vertices = np.array(points, dtype=np.float32).reshape(-1, 3)
    corners = np.array(triangles, dtype=np.int32).reshape(-1, 3)
    normals = None
    if smooth:
        normals = vertices[corners] / np.linalg.norm(vertices[corners], axis=2, keepdims=True)
    return Mesh(name, vertices, corners, np.zeros(len(corners), dtype=np.int32), normals=normals)


def _ring(radius: float, z: float, count: int = _SEGMENTS) -> list[_Point]:
    angles = [2.0 * math.pi * i / count for i in range(count)]
    return [(radius * math.cos(a), radius * math.sin(a), z) for a in angles]


@cache
def cube() -> Mesh:
    """A cube of 2 x 2 x 2 m."""
    points = [(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return polyhedron("Cube", points, faces)


@cache
def plane() -> Mesh:
    """A square of 2 x 2 m, facing Z."""
    return polyhedron("Plane", [(-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0)], [(0, 1, 2, 3)])


@cache
def cylinder(n: int = _SEGMENTS) -> Mesh:
    """A cylinder of radius 1 m, 2 m high, along Z, with ``n`` sides."""
    points = _ring(1.0, -1.0, n) + _ring(1.0, 1.0, n)
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return polyhedron("Cylinder", points, [*sides, tuple(range(n, 2 * n)), tuple(range(n - 1, -1, -1))])


@cache
def cone() -> Mesh:
    """A cone of radius 1 m at the bottom, 2 m high, along Z."""
    n = _SEGMENTS
    points = [*_ring(1.0, -1.0), (0.0, 0.0, 1.0)]
    return polyhedron("Cone", points, [*((i, (i + 1) % n, n) for i in range(n)), tuple(range(n - 1, -1, -1))])


@cache
def sphere() -> Mesh:
    """A sphere of radius 1 m, of rings and meridians."""
    n, rings = _SEGMENTS, 16
    points: list[_Point] = [(0.0, 0.0, 1.0)]
    for ring in range(1, rings):
        polar = math.pi * ring / rings
        points += _ring(math.sin(polar), math.cos(polar))
    points.append((0.0, 0.0, -1.0))
    faces: list[_Face] = [(0, 1 + i, 1 + (i + 1) % n) for i in range(n)]
    for ring in range(rings - 2):
        top, bottom = 1 + ring * n, 1 + (ring + 1) * n
        faces += [(top + i, bottom + i, bottom + (i + 1) % n, top + (i + 1) % n) for i in range(n)]
    last = 1 + (rings - 2) * n
    faces += [(len(points) - 1, last + (i + 1) % n, last + i) for i in range(n)]
    return polyhedron("Sphere", points, faces, smooth=True)


def capsule(radius: float, half: float) -> Mesh:
    """A sphere that is elongated along Z by a half length."""
    import numpy as np

    ball = sphere()
    vertices = ball.vertices * radius
    vertices[:, 2] += np.where(ball.vertices[:, 2] > 1e-6, half, -half)
    return Mesh("Capsule", vertices.astype(np.float32), ball.triangles, ball.material_index, normals=ball.normals)


@cache
def ico_sphere(subdivisions: int = 2) -> Mesh:
    """A sphere of radius 1 m, of triangles of nearly equal size: an icosahedron, its faces repeatedly cut in four."""
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    corners = [(0.0, a, b * golden) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    points = [_unit(p) for x, y, z in corners for p in ((x, y, z), (y, z, x), (z, x, y))]
    faces: list[_Face] = [
        _outward(points, (i, j, k))
        for i, j, k in itertools.combinations(range(12), 3)
        if _adjacent(points, i, j) and _adjacent(points, j, k) and _adjacent(points, i, k)
    ]
    for _ in range(subdivisions):
        middles: dict[tuple[int, int], int] = {}
        finer: list[_Face] = []
        for a, b, c in faces:
            ab, bc, ca = (_middle(points, middles, *edge) for edge in ((a, b), (b, c), (c, a)))
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = finer
    return polyhedron("IcoSphere", points, faces, smooth=True)


def primitive(kind: ShapeKind, size: tuple[float, ...]) -> tuple[Mesh, tuple[float, ...]]:
    """Return a mesh that shows a shape, and the scale of the mesh.

    Args:
        kind, size: as of `morse.scene.CollisionShape`; neither a hull nor a height field.
    """
    if kind is ShapeKind.BOX:
        return cube(), size
    if kind is ShapeKind.SPHERE:
        return ball(size[0]), size * 3
    if kind is ShapeKind.ELLIPSOID:
        return ball(max(size)), size
    if kind is ShapeKind.CYLINDER:
        radius, half = size
        return round_cylinder(radius), (radius, radius, half)
    return capsule(*size), (1.0, 1.0, 1.0)


def round_cylinder(radius: float) -> Mesh:
    """A cylinder of radius 1 m whose sides are within 0.1 mm of the circle when it is scaled to a radius, m."""
    sides = math.pi * math.sqrt(max(radius, 0.0) / (2.0 * _EXACT))
    return cylinder(min(max(_SEGMENTS, 16 * math.ceil(sides / 16.0)), _MOST_SIDES))


def ball(radius: float) -> Mesh:
    """A sphere of radius 1 m that is within 0.1 mm of the exact one when it is scaled to a radius of up to 0.5 m."""
    subdivisions = 2
    while subdivisions < _MOST_SUBDIVISIONS and _COARSE * radius > _EXACT * 4**subdivisions:
        subdivisions += 1
    return _ball(subdivisions)


@cache
def _ball(subdivisions: int) -> Mesh:
    """A sphere of triangles whose corners are as far outside as their middles are inside."""
    mesh = ico_sphere(subdivisions)
    # the bounding box is that of the sphere
    vertices = (mesh.vertices * (1.0 + _COARSE / 4**subdivisions)).clip(-1.0, 1.0)
    return Mesh("Ball", vertices.astype("float32"), mesh.triangles, mesh.material_index, normals=mesh.normals)


def _unit(point: _Point) -> _Point:
    length = math.hypot(*point)
    return (point[0] / length, point[1] / length, point[2] / length)


def _adjacent(points: Sequence[_Point], i: int, j: int) -> bool:
    # the edge of an icosahedron in the unit sphere has the length 1.05; the next distance between vertices is 1.70
    return math.dist(points[i], points[j]) < 1.2


def _outward(points: Sequence[_Point], face: tuple[int, int, int]) -> _Face:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (points[i] for i in face)
    volume = ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
    return face if volume > 0.0 else (face[0], face[2], face[1])


def _middle(points: list[_Point], middles: dict[tuple[int, int], int], a: int, b: int) -> int:
    edge = (min(a, b), max(a, b))
    if edge not in middles:
        (ax, ay, az), (bx, by, bz) = points[a], points[b]
        points.append(_unit((ax + bx, ay + by, az + bz)))
        middles[edge] = len(points) - 1
    return middles[edge]


@cache
def torus() -> Mesh:
    """A ring of radius 1 m and 0.25 m thickness (radius of the tube) around Z."""
    n, m = _SEGMENTS, 12
    points = []
    for i in range(n):
        around = 2.0 * math.pi * i / n
        for j in range(m):
            tube = 2.0 * math.pi * j / m
            distance = 1.0 + 0.25 * math.cos(tube)
            points.append((distance * math.cos(around), distance * math.sin(around), 0.25 * math.sin(tube)))
    faces = [
        (i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m)
        for i in range(n)
        for j in range(m)
    ]
    return polyhedron("Torus", points, faces)
