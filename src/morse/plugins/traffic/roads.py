"""Roads: polylines with lanes, places along them, and bodies of cars."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.solids import cube, cylinder, polyhedron
from morse.scene import BodySettings, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

#: m, between axles, as a share of the length
_WHEELBASE = 0.58
WIDTH, HEIGHT = 1.8, 1.45
#: m along a road: parts of it that are nearer to each other do not cross
_NEAR = 20.0
_PAINTS = (
    *((0.75, 0.76, 0.78), (0.12, 0.12, 0.13), (0.55, 0.08, 0.07), (0.1, 0.2, 0.42), (0.85, 0.85, 0.83)),
    *((0.3, 0.33, 0.36), (0.16, 0.3, 0.2), (0.7, 0.55, 0.2)),
)
_GLASS, _TYRE, _LAMP, _TAIL = (0.1, 0.14, 0.18), (0.05, 0.05, 0.05), (0.95, 0.95, 0.85), (0.6, 0.03, 0.03)


class Road:
    """A road with parallel lanes, the first one at the right.

    Args:
        points: (P, 2) of its middle, m.
        lanes: number of lanes.
        width: of a lane, m.
        closed: whether it leads from the last point back to the first one.
    """

    def __init__(self, points: Floats, lanes: int, width: float, *, closed: bool) -> None:
        self.points = np.concatenate([points, points[:1]]) if closed else points
        self.lanes, self.width, self.closed = lanes, width, closed
        ways = np.diff(self.points, axis=0)
        self._lengths = np.sqrt((ways * ways).sum(axis=1))
        self._ways = ways / self._lengths[:, None]
        self._begins = np.concatenate([[0.0], np.add.accumulate(self._lengths)])
        self.length = float(self._begins[-1])
        # lanes beside the middle meet in the bisectors of its corners; beyond 120 degrees, they cut the corner
        left = np.stack([-self._ways[:, 1], self._ways[:, 0]], axis=1)
        before = np.concatenate([left[-1:] if closed else left[:1], left])
        after = np.concatenate([left, left[:1] if closed else left[-1:]])
        turn = np.maximum(1.0 + (before * after).sum(axis=1), 0.5)
        self._corners = np.where((before == after).all(axis=1)[:, None], before, (before + after) / turn[:, None])

    def offset(self, lane: Floats) -> Floats:
        """Return the distances (N,) of lanes to the left of the middle, m."""
        return np.asarray((lane - 0.5 * (self.lanes - 1)) * self.width)

    def places(self, along: Floats, left: Floats | float = 0.0) -> tuple[Floats, Floats]:
        """Return points (N, 2), m, and directions (N, 2) of places along the road, straight on beyond its ends.

        Args:
            along: (N,) places along the middle, m.
            left: (N,) distances to the left of it, m; lines at a distance have no gaps at corners.
        """
        if self.closed:
            along = along - np.floor(along / self.length) * self.length
        part = np.clip(np.searchsorted(self._begins, along, side="right") - 1, 0, len(self._lengths) - 1)
        ways = self._ways[part]
        way = along - self._begins[part]
        share = np.clip(way / self._lengths[part], 0.0, 1.0)[:, None]
        across = self._corners[part] + share * (self._corners[part + 1] - self._corners[part])
        return self.points[part] + way[:, None] * ways + np.asarray(left)[..., None] * across, ways

    def poses(self, along: Floats, left: Floats, drift: Floats, length: Floats) -> tuple[Floats, Floats]:
        """Return the middles (N, 2), m, and the directions (N, 2) of cars.

        Args:
            along: (N,) places of their fronts along the road, m.
            left: (N,) distances to the left of the middle of the road, m.
            drift: (N,) ways to the left for each metre forward.
            length: (N,) of the cars, m.
        """
        middle, half = along - 0.5 * length, 0.5 * _WHEELBASE * length
        front, rear = (self.places(middle + way, left + way * drift)[0] for way in (half, -half))
        apart = front - rear
        return 0.5 * (front + rear), apart / np.sqrt((apart * apart).sum(axis=1))[:, None]

    def project(self, points: Floats, beside: Floats | None = None) -> tuple[Floats, Floats, Floats]:
        """Return the places (M,) of points along the road, m, their distances (M,) to its left, m, and its directions.

        The distance of a point beyond an end is infinite.

        Args:
            points: (M, 2), m.
            beside: (M,) places along the road, m; only parts of the road that are not near them count, such as those
                that cross it there.
        """
        apart = points[:, None, :] - self.points[None, :-1]
        along = (apart * self._ways).sum(axis=2)
        inside = np.clip(along, 0.0, self._lengths)
        off = apart - inside[:, :, None] * self._ways
        squares = (off * off).sum(axis=2)
        if beside is not None:
            ahead, behind = self._begins[:-1] - beside[:, None], beside[:, None] - self._begins[1:]
            away = np.maximum(ahead, behind)
            if self.closed:
                around = np.minimum(ahead % self.length, behind % self.length)
                away = np.where(away > 0.0, around, away)
            squares = np.where(away < _NEAR, np.inf, squares)
        best = squares.argmin(axis=1)
        rows = np.arange(len(points))
        way = self._ways[best]
        side = way[:, 0] * apart[rows, best, 1] - way[:, 1] * apart[rows, best, 0]
        place = self._begins[best] + inside[rows, best]
        if not self.closed:
            beyond = (along[rows, best] < -1e-9) & (best == 0)
            beyond |= (along[rows, best] > self._lengths[best] + 1e-9) & (best == len(self._lengths) - 1)
            side = np.where(beyond, np.inf, side)
        side = np.where(np.isfinite(squares[rows, best]), side, np.inf)
        # at a corner, the nearest point is the corner itself
        distance = np.sqrt((off[rows, best] ** 2).sum(axis=1))
        return place, np.where(np.isfinite(side), np.where(side < 0.0, -distance, distance), side), way


def car(name: str, length: float, look: int) -> Node:
    """Return the body of a car; its origin is on the road, below its middle, and it faces +X.

    Args:
        length: m.
        look: number of its paint.
    """
    half, wide = 0.5 * length, 0.5 * WIDTH
    is_truck = length > 7.0
    tall = 3.2 if is_truck else HEIGHT
    if is_truck:
        hull = [((half, wide, 0.5 * tall - 0.3), (0.0, 0.0, 0.5 * tall + 0.3), 0)]
        glass = [((0.02, 0.85 * wide, 0.4), (half, 0.0, 0.72 * tall), 1)]
    else:
        hull = [((half, wide, 0.3), (0.0, 0.0, 0.6), 0)]
        glass = []
    lamps = [
        *(((0.02, 0.2, 0.07), (half, side * 0.65 * wide, 0.68), 3) for side in (-1.0, 1.0)),
        *(((0.02, 0.2, 0.07), (-half, side * 0.65 * wide, 0.72), 4) for side in (-1.0, 1.0)),
    ]
    vertices, triangles, materials = [], [], []
    count = 0

    def add(points: Floats, faces: NDArray[np.int32], material: int) -> None:
        nonlocal count
        vertices.append(points)
        triangles.append(faces + count)
        materials.append(np.full(len(faces), material, dtype=np.int32))
        count += len(points)

    for size, place, material in (*hull, *glass, *lamps):
        add(cube().vertices * np.array(size) + np.array(place), cube().triangles, material)
    if not is_truck:
        cabin = _cabin(half, wide, tall)
        add(cabin.vertices.astype(np.float64), cabin.triangles, 1)
        add(
            cabin.vertices[4:] + np.array([0.0, 0.0, 0.02]),
            np.array([(0, 1, 2), (0, 2, 3)], np.int32),
            0,
        )
    tyre = cylinder(16)
    for x in (-0.5 * _WHEELBASE * length, 0.5 * _WHEELBASE * length):
        for y in (-wide + 0.1, wide - 0.1):
            turned = tyre.vertices[:, [0, 2, 1]] * np.array([0.33, 0.11, 0.33])
            add(turned + np.array([x, y, 0.33]), tyre.triangles[:, ::-1], 2)
    mesh = Mesh(
        name,
        np.concatenate(vertices).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(materials),
        materials=tuple(
            Material(f"{name} {own}", color=(*paint, 1.0), roughness=rough)
            for own, paint, rough in (
                ("paint", _PAINTS[look % len(_PAINTS)], 0.3),
                ("glass", _GLASS, 0.1),
                ("tyre", _TYRE, 0.9),
                ("lamp", _LAMP, 0.2),
                ("tail", _TAIL, 0.3),
            )
        ),
    )
    node = Node(name, NodeKind.MESH, mesh=mesh, body=BodySettings(type=PhysicsType.KINEMATIC))
    if is_truck:
        node.shapes = [CollisionShape(ShapeKind.BOX, (half, wide, 0.5 * tall - 0.15), (0.0, 0.0, 0.5 * tall + 0.15))]
    else:
        node.shapes = [
            CollisionShape(ShapeKind.BOX, (half, wide, 0.375), (0.0, 0.0, 0.525)),
            CollisionShape(ShapeKind.BOX, (0.32 * length, 0.9 * wide, 0.275), (-0.06 * length, 0.0, tall - 0.275)),
        ]
    node.properties["Object"], node.properties["Type"] = True, "car"
    return node


def _cabin(half: float, wide: float, tall: float) -> Mesh:
    """Windows: narrower at the roof."""
    low = [
        (0.45 * half, 0.95 * wide),
        (-0.85 * half, 0.95 * wide),
        (-0.85 * half, -0.95 * wide),
        (0.45 * half, -0.95 * wide),
    ]
    high = [
        (0.12 * half, 0.78 * wide),
        (-0.62 * half, 0.78 * wide),
        (-0.62 * half, -0.78 * wide),
        (0.12 * half, -0.78 * wide),
    ]
    points = [*((x, y, 0.88) for x, y in low), *((x, y, tall - 0.02) for x, y in high)]
    faces: Sequence[tuple[int, ...]] = [
        (3, 2, 1, 0),
        (4, 5, 6, 7),
        *((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)),
    ]
    return polyhedron("cabin", points, faces)
