"""Primitives, as parts centred on the origin unless stated otherwise; metres."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from common.parts import Part

if TYPE_CHECKING:
    from collections.abc import Sequence

SHARP = np.radians(40.0)
CAP = 3  # number of rings of the round end of a tube


def box(x: float, y: float, z: float, chamfer: float = 0.0) -> Part:
    """A box; its edges are cut by ``chamfer``."""
    half = np.array([x, y, z]) / 2
    if chamfer <= 0:
        vertices = np.array(list(product(*((-h, h) for h in half))))
        faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        return Part(vertices, faces, smooth=False)
    # three vertices at each corner, one on each adjacent face
    corners = list(product((0, 1), repeat=3))
    vertices = np.array(
        [
            [(2 * c[i] - 1) * (half[i] - (0 if i == axis else chamfer)) for i in range(3)]
            for c in corners
            for axis in range(3)
        ]
    )

    def at(axis: int, corner: Sequence[int]) -> int:
        return 3 * (corner[0] * 4 + corner[1] * 2 + corner[2]) + axis

    faces = [tuple(at(axis, c) for axis in range(3)) for c in corners]
    for axis in range(3):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        for side in (0, 1):
            ring = [{axis: side, b: i, c: j} for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
            faces.append(tuple(at(axis, [k[0], k[1], k[2]]) for k in ring))
        for i, j in product((0, 1), repeat=2):  # the edge along this axis
            ends = [{axis: e, b: i, c: j} for e in (0, 1)]
            faces.append(
                tuple(at(a, [k[0], k[1], k[2]]) for a, k in ((b, ends[0]), (b, ends[1]), (c, ends[1]), (c, ends[0])))
            )
    return Part(vertices, _outward(vertices, faces), smooth=False)


def rounded_box(x: float, y: float, z: float, radius: float, segments: int = 3) -> Part:
    """A box with round edges. ``segments`` is the number of faces of a quarter circle."""
    half = np.array([x, y, z]) / 2
    inner = np.maximum(half - radius, 0.0)
    bevel = np.tan(np.linspace(np.pi / 4, 0.0, segments + 1))
    support = min(radius / 2, inner[inner > 0].min() / 2) if (inner > 0).any() else 0.0
    ticks = [
        [(-i, -t) for t in bevel] + [(-i + support, 0.0), (i - support, 0.0)] + [(i, t) for t in bevel[::-1]]
        for i in inner
    ]
    vertices: list[np.ndarray] = []
    faces: list[tuple[int, ...]] = []
    for axis, side in product(range(3), (-1, 1)):
        b, c = (axis + 1) % 3, (axis + 2) % 3
        start, width = len(vertices), len(ticks[c])
        for (pb, tb), (pc, tc) in product(ticks[b], ticks[c]):
            position, direction = np.zeros(3), np.zeros(3)
            position[axis], position[b], position[c] = side * inner[axis], pb, pc
            direction[axis], direction[b], direction[c] = side, tb, tc
            vertices.append(position + radius * direction / np.linalg.norm(direction))
        for i, j in product(range(len(ticks[b]) - 1), range(width - 1)):
            k = start + i * width + j
            face = (k, k + width, k + width + 1, k + 1)
            faces.append(face if side > 0 else face[::-1])
    return welded(np.array(vertices), faces)


def ellipsoid(x: float, y: float, z: float, squareness: float = 0.0, columns: int = 32, rows: int = 16) -> Part:
    """An ellipsoid with these semi-axes; ``squareness`` (0..1) deforms it towards a box."""
    power = 1.0 - 0.8 * squareness

    def curve(value: np.ndarray) -> np.ndarray:
        return np.sign(value) * np.abs(value) ** power

    latitude = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)
    longitude = np.arange(columns) * 2 * np.pi / columns
    across, up = curve(np.cos(latitude)), curve(np.sin(latitude))
    grid = np.stack(
        [
            x * across[:, None] * curve(np.cos(longitude)),
            y * across[:, None] * curve(np.sin(longitude)),
            z * np.repeat(up[:, None], columns, axis=1),
        ],
        axis=-1,
    )
    return welded(grid.reshape(-1, 3), _tube_faces(rows + 1, columns))


def sphere(radius: float, columns: int = 32, rows: int = 16) -> Part:
    return ellipsoid(radius, radius, radius, columns=columns, rows=rows)


def lathe(profile: Sequence[tuple[float, float]], columns: int = 32) -> Part:
    """A profile of (radius, height) rotated about Z; corners sharper than 40 degrees stay sharp.

    The profile runs upwards with the outside on its right: for a solid, from the bottom centre to the top centre.
    """
    points = np.array(profile, dtype=float)
    runs = [[0]]
    for i in range(1, len(points)):
        runs[-1].append(i)
        if i + 1 < len(points):
            before, after = points[i] - points[i - 1], points[i + 1] - points[i]
            turn = np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after)
            if abs(turn) > SHARP:
                runs.append([i])
    angle = np.arange(columns) * 2 * np.pi / columns
    vertices, faces = np.zeros((0, 3)), []
    for run in runs:
        ring = points[run]
        grid = np.stack(
            [ring[:, :1] * np.cos(angle), ring[:, :1] * np.sin(angle), np.repeat(ring[:, 1:], columns, axis=1)], axis=-1
        )
        piece = welded(grid.reshape(-1, 3), _tube_faces(len(run), columns))
        faces += [tuple(len(vertices) + i for i in face) for face in piece.faces]
        vertices = np.concatenate([vertices, piece.vertices])
    return Part(vertices, faces)


def cylinder(radius: float, height: float, bevel: float = 0.0, columns: int = 32) -> Part:
    """A cylinder about Z."""
    h = height / 2
    if bevel <= 0:
        return lathe([(0, -h), (radius, -h), (radius, h), (0, h)], columns)
    return lathe(
        [(0, -h), (radius - bevel, -h), (radius, -h + bevel), (radius, h - bevel), (radius - bevel, h), (0, h)], columns
    )


def torus(radius: float, thickness: float, columns: int = 32, rows: int = 12) -> Part:
    """A ring about Z; ``thickness`` is the radius of the tube."""
    around = np.arange(columns + 1) * 2 * np.pi / columns
    along = np.arange(rows) * 2 * np.pi / rows
    reach = radius + thickness * np.cos(along)
    grid = np.stack(
        [
            np.cos(around)[:, None] * reach,
            np.sin(around)[:, None] * reach,
            np.repeat((thickness * np.sin(along))[None], columns + 1, axis=0),
        ],
        axis=-1,
    )
    part = welded(grid.reshape(-1, 3), _tube_faces(columns + 1, rows))
    return Part(part.vertices, [face[::-1] for face in part.faces])


def tube(
    points: Sequence[Sequence[float]], radius: float | Sequence[float], columns: int = 12, round_ends: bool = True
) -> Part:
    """A pipe along a polyline, with a radius at each point."""
    path = np.array(points, dtype=float)
    radii = np.broadcast_to(np.asarray(radius, dtype=float), len(path)).copy()
    tangents = np.gradient(path, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    if round_ends:
        angles = np.linspace(0.0, np.pi / 2, CAP + 1)[1:]
        head = [(path[0] - tangents[0] * radii[0] * np.sin(a), radii[0] * np.cos(a)) for a in angles[::-1]]
        tail = [(path[-1] + tangents[-1] * radii[-1] * np.sin(a), radii[-1] * np.cos(a)) for a in angles]
        path = np.array([p for p, _ in head] + list(path) + [p for p, _ in tail])
        radii = np.array([r for _, r in head] + list(radii) + [r for _, r in tail])
        tangents = np.concatenate([np.repeat(tangents[:1], CAP, 0), tangents, np.repeat(tangents[-1:], CAP, 0)])
    side = np.cross(tangents[0], [0, 0, 1] if abs(tangents[0][2]) < 0.9 else [1, 0, 0])
    rings = []
    angle = np.arange(columns) * 2 * np.pi / columns
    for centre, tangent, r in zip(path, tangents, radii, strict=True):
        side = side - tangent * (side @ tangent)  # the frame moves along without twist
        side /= np.linalg.norm(side)
        up = np.cross(tangent, side)
        rings.append(centre + max(r, 0.0) * (np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up))
    part = welded(np.concatenate(rings), _tube_faces(len(rings), columns))
    if round_ends:
        return part
    # flat ends with separate vertices, so that the edge is sharp
    count = len(part.vertices)
    ends = [tuple(range(count + columns - 1, count - 1, -1)), tuple(range(count + columns, count + 2 * columns))]
    return Part(np.concatenate([part.vertices, rings[0], rings[-1]]), [*part.faces, *ends])


def prism(outline: Sequence[tuple[float, float]], height: float) -> Part:
    """A flat polygon (counter-clockwise in XY) extruded from z=0 to ``height``, with hard edges."""
    count = len(outline)
    ring = np.array(outline, dtype=float)
    low, high = (np.column_stack([ring, np.full(count, z)]) for z in (0.0, height))
    faces: list[tuple[int, ...]] = [tuple(range(count - 1, -1, -1)), tuple(range(count, 2 * count))]
    faces += [(i, (i + 1) % count, count + (i + 1) % count, count + i) for i in range(count)]
    return Part(np.concatenate([low, high]), faces, smooth=False)


def sheet(outline: Sequence[tuple[float, float]]) -> Part:
    """A flat polygon in the XY plane, facing up."""
    ring = np.array(outline, dtype=float)
    return Part(np.column_stack([ring, np.zeros(len(ring))]), [tuple(range(len(ring)))], smooth=False)


def rectangle(x: float, y: float) -> Part:
    """A flat rectangle in the XY plane, facing up."""
    return sheet([(-x / 2, -y / 2), (x / 2, -y / 2), (x / 2, y / 2), (-x / 2, y / 2)])


def pill(length: float, width: float, segments: int = 8) -> list[tuple[float, float]]:
    """The outline of a bar with round ends along X; a disc if it is as long as wide."""
    r, half = width / 2, max(length - width, 0.0) / 2
    right = [(half + r * np.cos(a), r * np.sin(a)) for a in np.linspace(-np.pi / 2, np.pi / 2, segments + 1)]
    left = [(-x, -y) for x, y in right]
    return right + left if half > 0 else right + left[1:-1]


def welded(vertices: np.ndarray, faces: list[tuple[int, ...]]) -> Part:
    """Merge vertices at the same position and remove degenerate faces."""
    _, first, index = np.unique(np.round(vertices, 6), axis=0, return_index=True, return_inverse=True)
    index = index.reshape(-1)
    kept = []
    for face in faces:
        corners = [int(index[i]) for i in face]
        corners = [c for i, c in enumerate(corners) if c != corners[i - 1]]
        if len(corners) >= 3:
            kept.append(tuple(corners))
    return Part(vertices[first], kept)


def _outward(vertices: np.ndarray, faces: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Orient each face of a convex body around the origin outwards."""
    result = []
    for face in faces:
        corners = vertices[list(face)]
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        result.append(face if normal @ corners.mean(axis=0) > 0 else face[::-1])
    return result


def _tube_faces(rings: int, columns: int) -> list[tuple[int, ...]]:
    return [
        (i * columns + j, i * columns + (j + 1) % columns, (i + 1) * columns + (j + 1) % columns, (i + 1) * columns + j)
        for i in range(rings - 1)
        for j in range(columns)
    ]
