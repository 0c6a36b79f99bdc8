"""Simplifies a mesh within a bound of its error; the twin of ``c/draw_simplify.c``, which explains the method."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, sqrt
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.kernel.drawing.meshes import Simplification

_MOST_AROUND, _MOST_PASSES = 24, 16
_SLIVER, _WIDE, _FLAT, _SHADE = 1e-3, 6.0, 0.05, 0.25

Vector = tuple[float, ...]


def simplify(mesh: Simplification, limit: float) -> int:
    """See `morse.kernel.drawing.meshes.simplify`."""
    return _Work(mesh, limit).run()


@dataclass
class _Star:
    """The triangles around a vertex: (centre, ring j, ring j + 1).

    Attributes:
        corners: of the triangles at the centre.
        ring: vertices.
        at, height: of the ring relative to the centre, along and above the mean plane.
    """

    corners: list[int]
    ring: list[int]
    at: list[Vector] = field(default_factory=list)
    height: list[float] = field(default_factory=list)
    reach: float = 0.0
    widest: float = 0.0
    error: float = 0.0


class _Work:
    """The simplification of a mesh up to a limit."""

    def __init__(self, mesh: Simplification, limit: float) -> None:
        self.mesh, self.limit = mesh, limit
        self.points: list[Vector] = [tuple(row) for row in mesh.points.tolist()]
        self.looks: list[Vector] = [tuple(row) for row in mesh.looks.tolist()]
        self.slots = mesh.slots.tolist()
        self.vertices, self.look = mesh.vertices.ravel().tolist(), mesh.look.ravel().tolist()
        self.errors, self.alive = mesh.errors.tolist(), mesh.alive.tolist()
        #: the corners of each vertex, the newest last
        self.corners: list[list[int]] = [[] for _ in self.points]
        for corner in reversed(range(len(self.vertices))):
            if self.alive[corner // 3]:
                self.corners[self.vertices[corner]].append(corner)

    def run(self) -> int:
        """Remove vertices until none can be removed."""
        is_open = [True] * len(self.points)
        for _ in range(_MOST_PASSES):
            dirty: set[int] = set()
            for vertex in range(len(self.points)):
                if not self.corners[vertex] or not is_open[vertex] or vertex in dirty:
                    continue
                ring = self._remove(vertex)
                is_open[vertex] = False
                for other in ring:
                    is_open[other] = True
                dirty.update(ring)
            if not dirty:
                break
        mesh = self.mesh
        mesh.vertices[:] = np.reshape(self.vertices, (-1, 3))
        mesh.look[:] = np.reshape(self.look, (-1, 3))
        mesh.errors[:], mesh.alive[:] = self.errors, self.alive
        return sum(self.alive)

    def _remove(self, vertex: int) -> list[int]:
        """Move a vertex onto a neighbour; returns the ring, empty if it cannot be moved."""
        star = self._surround(vertex)
        if star is None or not self._project(vertex, star):
            return []
        best, onto, looks = inf, -1, list[int]()
        for m in range(len(star.ring)):
            error, new = self._try(star, vertex, m)
            if error < best:
                best, onto, looks = error, m, new
        if onto < 0:
            return []
        for j, corner in enumerate(star.corners):
            self.errors[corner // 3] = star.error + best
            if j in (onto, (onto - 1) % len(star.ring)):
                self.alive[corner // 3] = 0
            else:
                self.vertices[corner], self.look[corner] = star.ring[onto], looks[j]
                self.corners[star.ring[onto]].append(corner)
        self.corners[vertex] = []
        return star.ring

    def _around(self, vertex: int) -> Iterator[int]:
        return (corner for corner in reversed(self.corners[vertex]) if self.alive[corner // 3])

    def _surround(self, vertex: int) -> _Star | None:
        """The star of a vertex; None if its triangles do not surround it."""
        star = _Star([], [])
        for corner in self._around(vertex):
            star.corners.append(corner)
            star.ring.append(self.vertices[_beside(corner, 1)])
        count = len(star.ring)
        if not 3 <= count <= _MOST_AROUND:
            return None
        for j in range(count):
            end = self.vertices[_beside(star.corners[j], 2)]
            corners = [i for i in range(count) if star.ring[i] == end]
            place = (j + 1) % count
            if len(corners) != 1 or (corners[0] <= j and corners[0] != place):
                return None
            for rows in (star.corners, star.ring):
                rows[place], rows[corners[0]] = rows[corners[0]], rows[place]
        return star

    def _project(self, vertex: int, star: _Star) -> bool:
        """Project a star along its mean normal; False if triangles overlap."""
        centre, count = self.points[vertex], len(star.ring)
        apart = [tuple(a - b for a, b in zip(self.points[v], centre, strict=True)) for v in star.ring]
        star.reach = sqrt(max(_dot(a, a) for a in apart))
        star.error = max(self.errors[corner // 3] for corner in star.corners)
        normal: Vector = (0.0, 0.0, 0.0)
        for j in range(count):
            area = _cross(apart[j], apart[(j + 1) % count])
            normal = tuple(a + b for a, b in zip(normal, area, strict=True))
        length = sqrt(_dot(normal, normal))
        if not length > 0:
            return False
        normal = tuple(a / length for a in normal)
        least = min(range(3), key=lambda i: abs(normal[i]))
        x = _cross(tuple(float(i == least) for i in range(3)), normal)
        size = sqrt(_dot(x, x))
        x = tuple(a / size for a in x)
        y = _cross(normal, x)
        star.at = [(_dot(a, x), _dot(a, y)) for a in apart]
        star.height = [_dot(a, normal) for a in apart]
        for j in range(count):
            a, b = star.at[j], star.at[(j + 1) % count]
            area2 = _across(a, b)
            if not area2 > 0:
                return False
            star.widest = max(star.widest, _height(area2, a, b, _minus(b, a)))
        return True

    def _try(self, star: _Star, centre: int, m: int) -> tuple[float, list[int]]:
        """The error that a star gets when its centre moves onto vertex `m` of its ring, and the looks at the centre."""
        count, to = len(star.ring), star.at[m]
        never = inf, list[int]()
        error, widest, over, weight = inf, star.widest, -1, (0.0, 0.0, 0.0)
        for j in range(count):
            if j in (m, (m - 1) % count):
                continue
            n = (j + 1) % count
            a, b = star.at[j], star.at[n]
            p, q = _minus(a, to), _minus(b, to)
            area = _across(p, q)
            if not area > 0:
                return never
            height = _height(area, p, q, _minus(b, a))
            if not height * height > _SLIVER * area:
                return never
            widest = max(widest, height)
            w = (_across(a, b), _across(b, to), _across(to, a))
            if over >= 0 or w[1] < 0 or w[2] < 0:
                continue
            over, weight = j, (w[0] / area, w[1] / area, w[2] / area)
            error = abs(weight[0] * star.height[m] + weight[1] * star.height[j] + weight[2] * star.height[n])
        flat = _FLAT * self.limit if widest > _WIDE * self.limit else self.limit
        if over < 0 or not error <= flat or not star.error + error <= self.limit:
            return never
        if not self._keeps_surface(star, centre, m):
            return never
        error = max(error, _error_of_edges(star, m))
        if not error <= flat:
            return never
        error = max(error, self._error_of_borders(star, m))
        look_error, looks = self._choose_looks(star, m)
        error = max(error, look_error)
        error = max(error, self._error_of_look(star, over, looks[over], weight))
        return (error, looks) if star.error + error <= self.limit else never

    def _keeps_surface(self, star: _Star, centre: int, m: int) -> bool:
        """Whether the mesh remains a surface when the centre moves onto a vertex of the ring."""
        count = len(star.ring)
        for corner in self._around(star.ring[m]):
            ends = self.vertices[_beside(corner, 1)], self.vertices[_beside(corner, 2)]
            if centre in ends:
                continue
            common = [j for j in range(count) if star.ring[j] in ends]
            if any(j not in ((m - 1) % count, (m + 1) % count) for j in common):
                return False
            if len(common) == 2 and count == 3:
                return False
        return True

    def _error_of_borders(self, star: _Star, m: int) -> float:
        """How far borders between materials, or between pieces of a texture, move."""
        kinds = [self.look[corner] for corner in star.corners]
        if not self.mesh.textured:
            kinds = [self.slots[look] for look in kinds]
        borders = [j for j in range(len(kinds)) if kinds[j] != kinds[j - 1]]
        if not borders:
            return 0.0
        to, high = star.at[m], star.height[m]
        if len(borders) != 2 or m not in borders:
            return sqrt(to[0] * to[0] + to[1] * to[1] + high * high)
        other = star.at[borders[0] if borders[1] == m else borders[1]]
        d = _minus(other, to)
        return abs(_across(to, other)) / sqrt(d[0] * d[0] + d[1] * d[1])

    def _choose_looks(self, star: _Star, m: int) -> tuple[float, list[int]]:
        """The new looks of the corners at the centre, and the error of those that have no counterpart."""
        count = len(star.ring)
        before = (m - 1) % count
        ends = star.corners[m], star.corners[before]
        old = [self.look[corner] for corner in ends]
        new = [self.look[_beside(ends[0], 1)], self.look[_beside(ends[1], 2)]]
        at, high = star.at[m], star.height[m]
        away = sqrt(at[0] * at[0] + at[1] * at[1] + high * high)
        error, looks = 0.0, [self.look[corner] for corner in star.corners]
        for j, own in enumerate(looks):
            if j in (m, before):
                continue
            if own in old:
                looks[j] = new[old.index(own)]
                continue
            least = away
            for other in old:
                if not self.mesh.textured and self.slots[own] == self.slots[other]:
                    least = min(least, _SHADE * _turn(self.looks[own], self.looks[other]) * star.reach)
            error = max(error, least)
        return error, looks

    def _error_of_look(self, star: _Star, j: int, look: int, weight: Sequence[float]) -> float:
        """The error of the attributes at the centre in the triangle at j that covers it."""
        corner = star.corners[j]
        if look == self.look[corner]:
            return 0.0
        own, a, b = (self.looks[self.look[_beside(corner, by)]] for by in range(3))
        mean = [weight[0] * k + weight[1] * p + weight[2] * q for k, p, q in zip(self.looks[look], a, b, strict=True)]
        length = sqrt(_dot(mean, mean))
        if not length > 0:
            return inf
        mean[:3] = [value / length for value in mean[:3]]
        error = _SHADE * _turn(mean, own) * star.reach
        if not self.mesh.textured:
            return error
        d = _minus(star.at[(j + 1) % len(star.ring)], star.at[j])
        u, v = (b[3] - a[3], b[4] - a[4]), (mean[3] - own[3], mean[4] - own[4])
        whole, part = u[0] * u[0] + u[1] * u[1], v[0] * v[0] + v[1] * v[1]
        if not whole > 0:
            return inf if part > 0 else error
        return max(error, sqrt(part * (d[0] * d[0] + d[1] * d[1]) / whole))


def _error_of_edges(star: _Star, m: int) -> float:
    """The largest distance between both surfaces where an old edge crosses a new one."""
    count, start, error = len(star.ring), star.at[m], 0.0
    for j in range(count):
        if j in (m, (m - 1) % count, (m + 1) % count):
            continue
        d = _minus(star.at[j], start)
        over = _across(start, d)
        for i in range(count):
            under = _across(star.at[i], d)
            if i in (m, j) or under == 0:
                continue
            a, b = over / under, _across(start, star.at[i]) / under
            if 0 < a < 1 and 0 < b < 1:
                new = star.height[m] + b * (star.height[j] - star.height[m])
                error = max(error, abs(a * star.height[i] - new))
    return error


def _beside(corner: int, by: int) -> int:
    return corner - corner % 3 + (corner + by) % 3


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _across(a: Vector, b: Vector) -> float:
    return a[0] * b[1] - a[1] * b[0]


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1])


def _height(area: float, *edges: Vector) -> float:
    """The height of a triangle above its longest edge, from twice its area."""
    return area / sqrt(max(e[0] * e[0] + e[1] * e[1] for e in edges))


def _turn(a: Sequence[float], b: Sequence[float]) -> float:
    """The distance between two normals."""
    d = (a[0] - b[0], a[1] - b[1], a[2] - b[2])
    return sqrt(_dot(d, d))
