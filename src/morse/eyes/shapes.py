"""The triangles of the shapes of MuJoCo, as its own renderer divides them, with its texture coordinates.

Primitives have unit sizes: a geom scales them. Texture rows are counted from the first row of the data, as MuJoCo does.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.portable import cos, sin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

#: of the angle between the normal of a vertex and that of its triangle, from which on the former is used
_LEAST_COSINE = 0.8
#: lines of the grid of an infinite plane, in units of its spacing: fine near the camera
_GRID_LINES = (*range(13), 14, 16, 20, 24, 32, 40, 50, 60, 80, 100)
#: number of spacings from the middle of an infinite plane to its border
GRID_REACH = _GRID_LINES[-1]


class Triangles(NamedTuple):
    """Triangles with attributes of their corners; what `morse.rendering.meshes.clusters_of` reads of a mesh.

    Attributes:
        vertices: (V, 3) float32.
        triangles: (T, 3) int32, counterclockwise seen from the front.
        normals: (T, 3, 3) float32, unit vectors.
        uvs: (T, 3, 2) float32, or None.
        material_index: (T,) int32, number of the material slot.
    """

    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32] | None
    material_index: NDArray[np.int32]


def _of_patches(patches: Sequence[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]]) -> Triangles:
    """Triangles of grids (R, C, 3) of points, normals and (R, C, 2) texture coordinates; each cell is two of them."""
    vertices, triangles, normals, uvs = [], [], [], []
    first = 0
    for points, normal, uv in patches:
        rows, columns = points.shape[:2]
        at = np.arange(rows * columns).reshape(rows, columns)
        a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]))
        index = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
        flat = points.reshape(-1, 3)
        # cells at a pole are single triangles
        corners = flat[index]
        area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        index = index[np.abs(area).max(axis=1) > 1e-12]
        vertices.append(flat)
        normals.append(normal.reshape(-1, 3)[index])
        uvs.append(uv.reshape(-1, 2)[index])
        triangles.append(index + first)
        first += len(flat)
    index = np.concatenate(triangles).astype(np.int32)
    return Triangles(
        np.concatenate(vertices).astype(np.float32),
        index,
        np.concatenate(normals).astype(np.float32),
        np.concatenate(uvs).astype(np.float32),
        np.zeros(len(index), np.int32),
    )


def _square(
    lines: NDArray[np.float64], others: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    x, y = np.meshgrid(lines, others)
    points = np.stack([x, y, np.zeros_like(x)], axis=-1)
    uv = np.stack([(x + 1) / 2, (1 - y) / 2], axis=-1)
    return points, np.broadcast_to([0.0, 0.0, 1.0], points.shape), uv


def _round(slices: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    angle = 2 * np.pi * np.arange(slices + 1) / slices
    cosine, sine = cos(angle), sin(angle)
    cosine[-1], sine[-1] = cosine[0], sine[0]
    return np.stack([cosine, sine, np.zeros_like(angle)], axis=-1), angle / (2 * np.pi)


def _dome(slices: int, stacks: int, *, above: bool, of_sphere: bool) -> tuple[NDArray[np.float64], ...]:
    """Half of a unit sphere; `stacks` of the half."""
    around, u = _round(slices)
    elevation = np.pi / 2 * np.arange(stacks + 1) / stacks * (1 if above else -1)
    cosine, sine = cos(elevation), sin(elevation)
    points = around[None] * cosine[:, None, None]
    points[..., 2] = sine[:, None]
    if not above:
        elevation, points = elevation[::-1], points[::-1]
        points[0, :, :2] = 0.0
    else:
        points[-1, :, :2] = 0.0
    v = (np.pi / 2 - elevation) / np.pi if of_sphere else (np.pi - elevation if above else -elevation) / np.pi
    uv = np.stack(np.broadcast_arrays(u[None], v[:, None]), axis=-1)
    return points, points, uv


def _disc(slices: int, *, above: bool) -> tuple[NDArray[np.float64], ...]:
    around, _ = _round(slices)
    z = 1.0 if above else -1.0
    rim, middle = around + np.array([0.0, 0.0, z]), np.broadcast_to([0.0, 0.0, z], around.shape)
    points = np.stack([rim, middle] if above else [middle, rim])
    uv = (points[..., :2] + 1) / 2
    return points, np.broadcast_to([0.0, 0.0, z], points.shape), uv


def _tube(slices: int, stacks: int) -> tuple[NDArray[np.float64], ...]:
    around, u = _round(slices)
    z = np.linspace(-1.0, 1.0, stacks + 1)
    points = np.broadcast_to(around[None], (stacks + 1, slices + 1, 3)).copy()
    points[..., 2] = z[:, None]
    uv = np.stack(np.broadcast_arrays(u[None], ((1 - z) / 2)[:, None]), axis=-1)
    return points, np.broadcast_to(around[None], points.shape), uv


def _cone(slices: int, stacks: int) -> tuple[NDArray[np.float64], ...]:
    """From the unit circle at 0 to the tip at 1."""
    around, u = _round(slices)
    z = np.linspace(0.0, 1.0, stacks + 1)
    points = around[None] * (1 - z)[:, None, None]
    points[..., 2] = z[:, None]
    normal = np.broadcast_to((around + np.array([0.0, 0.0, 1.0])) / np.sqrt(2), points.shape)
    uv = np.stack(np.broadcast_arrays(u[None], (1 - z)[:, None]), axis=-1)
    return points, normal, uv


def _turned(
    points: NDArray[np.float64], normal: NDArray[np.float64], uv: NDArray[np.float64]
) -> tuple[NDArray[np.float64], ...]:
    """A patch that is turned by half a turn around X."""
    half = np.array([1.0, -1.0, -1.0])
    return points * half, normal * half, uv


def _box(quads: int) -> list[tuple[NDArray[np.float64], ...]]:
    lines = np.linspace(-1.0, 1.0, quads + 1)
    x, y = np.meshgrid(lines, lines)
    one = np.ones_like(x)
    faces = [
        # points, the first coordinate to the right and the second one up, seen from outside
        (np.stack([one, x, y], -1), (1, 0, 0), x, y),
        (np.stack([-one, -x, y], -1), (-1, 0, 0), -x, y),
        (np.stack([-x, one, y], -1), (0, 1, 0), -x, y),
        (np.stack([x, -one, y], -1), (0, -1, 0), x, y),
        (np.stack([x, y, one], -1), (0, 0, 1), x, y),
        (np.stack([x, -y, -one], -1), (0, 0, -1), x, -y),
    ]
    return [
        (points, np.broadcast_to(np.array(normal, float), points.shape), np.stack([(a + 1) / 2, (1 - b) / 2], -1))
        for points, normal, a, b in faces
    ]


@lru_cache(maxsize=64)
def primitive(name: str, slices: int, stacks: int, quads: int) -> Triangles:
    """Return a unit shape.

    Args:
        name: grid and round (an infinite plane with a spacing of 1 in the middle; a square, and a disc), sphere,
            cylinder, box, or a part of other shapes: tube, top and bottom (of a capsule), cone, cone_down, disc,
            triangle.
        slices, stacks, quads: see ``visual/quality`` of MuJoCo.
    """
    slices, stacks, quads = max(slices, 3), max(stacks, 2), max(quads, 1)
    half = max(stacks // 2, 1)
    if name in ("grid", "round"):
        lines = np.array([*(-line for line in _GRID_LINES[:0:-1]), *_GRID_LINES], float)
        points, normals, _ = _square(lines, lines)
        if name == "round":
            # squares around the middle become circles
            points *= (np.abs(points).max(-1) / np.maximum(np.hypot(points[..., 0], points[..., 1]), 1.0))[..., None]
        return _of_patches([(points, normals, np.stack([points[..., 0], -points[..., 1]], -1) / 2)])
    if name == "triangle":
        points = np.array([[[0.0, 0, 0], [1, 0, 0]], [[0, 1, 0], [0, 1, 0]]])
        return _of_patches([(points, np.broadcast_to([0.0, 0, 1], points.shape), points[..., :2])])
    parts = {
        "sphere": lambda: [
            _dome(slices, half, above=True, of_sphere=True),
            _dome(slices, half, above=False, of_sphere=True),
        ],
        "top": lambda: [_dome(slices, half, above=True, of_sphere=False)],
        "bottom": lambda: [_dome(slices, half, above=False, of_sphere=False)],
        "tube": lambda: [_tube(slices, stacks)],
        "cylinder": lambda: [_tube(slices, stacks), _disc(slices, above=True), _disc(slices, above=False)],
        "cone": lambda: [_cone(slices, stacks)],
        "cone_down": lambda: [_turned(*_cone(slices, stacks))],
        "disc": lambda: [_disc(slices, above=False)],
        "box": lambda: _box(quads),
    }
    return _of_patches(parts[name]())  # type: ignore[arg-type]


@lru_cache(maxsize=64)
def plane(columns: int, rows: int) -> Triangles:
    """Return a plane of 2 x 2 m, of that many squares."""
    return _of_patches([_square(np.linspace(-1.0, 1.0, columns + 1), np.linspace(-1.0, 1.0, rows + 1))])


def surface_mesh(
    vertices: NDArray[np.float32],
    faces: NDArray[np.int32],
    normals: NDArray[np.float32] | None = None,
    normal_index: NDArray[np.int32] | None = None,
    uvs: NDArray[np.float32] | None = None,
    uv_index: NDArray[np.int32] | None = None,
) -> Triangles:
    """Return a mesh of MuJoCo with one material."""
    faces = np.ascontiguousarray(faces, np.int32).reshape(-1, 3)
    corners = vertices[faces].astype(np.float64)
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-30)
    own = np.repeat(flat[:, None], 3, axis=1)
    if normals is not None and len(normals):
        given = normals[faces if normal_index is None else normal_index]
        # MuJoCo takes normals only where they are nearly those of the triangle
        own = np.where(((given * own).sum(axis=2) >= _LEAST_COSINE)[..., None], given, own)
    at = None
    if uvs is not None and len(uvs):
        at = np.ascontiguousarray(uvs[faces if uv_index is None else uv_index], np.float32)
    return Triangles(
        np.ascontiguousarray(vertices, np.float32), faces, own.astype(np.float32), at, np.zeros(len(faces), np.int32)
    )


def height_field(elevation: NDArray[np.float32], size: NDArray[np.float64], *, flat: bool = False) -> Triangles:
    """Return the surface and the base of a height field.

    Args:
        elevation: (R, C) 0 to 1, the first row at the lowest y.
        size: (4,) half lengths of x and y, height of 1, thickness of the base, m.
        flat: whether triangles have their own normals, as in MuJoCo, instead of those of a smooth surface.
    """
    rows, columns = elevation.shape
    x, y = np.meshgrid(np.linspace(-size[0], size[0], columns), np.linspace(-size[1], size[1], rows))
    points = np.stack([x, y, elevation * size[2]], axis=-1).astype(np.float64)
    across, down = points[:, 1:] - points[:, :-1], points[1:] - points[:-1]
    face = np.cross(across[:-1], down[:, :-1])
    face /= np.maximum(np.linalg.norm(face, axis=-1, keepdims=True), 1e-30)
    normal = np.zeros_like(points)
    for r in (0, 1):
        for c in (0, 1):
            normal[r : rows - 1 + r, c : columns - 1 + c] += face
    normal /= np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-30)
    patches = [(points, normal, planar(points, size))]
    base = points.copy()
    base[..., 2] = -size[3]
    for line, low, outward in (
        (points[0], base[0], (0.0, -1.0, 0.0)),
        (points[-1, ::-1], base[-1, ::-1], (0.0, 1.0, 0.0)),
        (points[::-1, 0], base[::-1, 0], (-1.0, 0.0, 0.0)),
        (points[:, -1], base[:, -1], (1.0, 0.0, 0.0)),
    ):
        wall = np.stack([low, line])
        patches.append((wall, np.broadcast_to(outward, wall.shape), planar(wall, size)))
    floor = base[::-1][[0, -1]][:, [0, -1]]
    patches.append((floor, np.broadcast_to([0.0, 0.0, -1.0], floor.shape), planar(floor, size)))
    mesh = _of_patches(patches)
    if not flat:
        return mesh
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    return mesh._replace(normals=np.repeat(normals[:, None], 3, axis=1).astype(np.float32))


def planar(points: NDArray[np.floating], size: NDArray[np.floating]) -> NDArray[np.float64]:
    """Texture coordinates (..., 2) that MuJoCo generates for points (..., 3): 0 in the middle, 1 along the size."""
    x, y = (max(float(part), 1e-9) for part in size[:2])
    return np.stack([points[..., 0] / (2 * x), -points[..., 1] / (2 * y)], axis=-1)


#: the planes between the faces of a cube
_BETWEEN = np.array([[1, -1, 0], [1, 1, 0], [1, 0, -1], [1, 0, 1], [0, 1, -1], [0, 1, 1]], float)


def cube_mapped(mesh: Triangles, scale: NDArray[np.floating]) -> Triangles:
    """Divide a mesh at the borders of the six pictures of a cube texture, which are its material slots.

    Args:
        scale: (3,) factors of the positions, for the directions into the cube.
    """
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    rows = np.concatenate([corners, mesh.normals.astype(np.float64)], axis=2)
    for plane in _BETWEEN:
        rows = _divided(rows, plane * scale)
    direction = rows[..., :3] * scale
    middle = direction.mean(axis=1)
    axis = np.abs(middle).argmax(axis=1)
    each = np.arange(len(rows))
    less = middle[each, axis] < 0
    face = 2 * axis + less
    x, y, z = (direction[..., i] for i in range(3))
    # columns and rows of each face, as OpenGL defines them
    across = np.choose(face[:, None], [-z, z, x, x, x, -x])
    down = np.choose(face[:, None], [-y, -y, z, -z, -y, -y])
    most = np.maximum(np.abs(np.take_along_axis(direction, axis[:, None, None], axis=2)[..., 0]), 1e-12)
    # a texel away from the border, because textures are repeated
    uv = np.clip(np.stack([across / most, down / most], axis=-1), -0.995, 0.995) / 2 + 0.5
    vertices = rows[..., :3].reshape(-1, 3)
    normals = rows[..., 3:]
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-30)
    return Triangles(
        vertices.astype(np.float32),
        np.arange(len(vertices), dtype=np.int32).reshape(-1, 3),
        normals.astype(np.float32),
        uv.astype(np.float32),
        face.astype(np.int32),
    )


def _divided(rows: NDArray[np.float64], plane: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cut triangles (T, 3, K) along a plane through the origin."""
    side = rows[..., 0] * plane[0] + rows[..., 1] * plane[1] + rows[..., 2] * plane[2]
    side[np.abs(side) < 1e-9] = 0.0
    cut = (side.min(axis=1) < 0) & (side.max(axis=1) > 0)
    if not cut.any():
        return rows
    part, at = rows[cut], side[cut]
    # the corner that is alone on its side comes first
    positive = (at > 0).sum(axis=1)
    negative = (at < 0).sum(axis=1)
    alone = np.where(positive <= negative, at.argmax(axis=1), at.argmin(axis=1))
    order = (alone[:, None] + np.arange(3)) % 3
    part = np.take_along_axis(part, order[..., None], axis=1)
    at = np.take_along_axis(at, order, axis=1)
    a, b, c = part[:, 0], part[:, 1], part[:, 2]
    ab, ac = (
        a + (end - a) * (at[:, 0] / np.where(at[:, 0] == other, 1.0, at[:, 0] - other))[:, None]
        for end, other in ((b, at[:, 1]), (c, at[:, 2]))
    )
    return np.concatenate([rows[~cut], np.stack([a, ab, ac], 1), np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)])
