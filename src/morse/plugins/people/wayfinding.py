"""The ground on which people walk: walls from collision shapes, the distance to them, and the ways to goals.

Everything is on a grid: the distance to the nearest wall, and for each goal the time to it, by the eikonal equation.
Both are read between the cells by bilinear interpolation, so that people walk smoothly and cut no corners.
"""

from __future__ import annotations

import copy
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.walking import arrival, wall
from morse.scene import ShapeKind
from morse.scene.extent import corners
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from morse.scene import Node

    Floats = NDArray[np.float64]

#: m, of a cell; larger cells in areas that would have more than `_MOST` cells
CELL, _MOST = 0.1, 1_500_000
#: m: distances to walls are known up to this
FAR = 3.0
#: m: bodies of people are wider than what they step over, and lower than what they pass below
STEP, HEIGHT = 0.25, 1.9
#: m: they keep this distance from walls where they can, and are slower in the time to a goal where they cannot
_ROOM = 0.45
#: m: bodies give way by so much between two walls
_SQUEEZED = 0.03
#: share of the speed there
_NARROW = 0.4


def walls(nodes: Iterable[Node], floor: float, step: float = STEP) -> list[Floats]:
    """Return the convex polygons (V, 2), counter-clockwise, m, in which nobody can walk.

    They are the shadows of what is between the height of a step and that of a head.

    Args:
        nodes: with collision shapes.
        floor: height of the floor, m.
        step: m, what is lower is no wall.
    """
    polygons = []
    for node in nodes:
        frame = rigid_frame(node)
        position = np.array([float(v) for v in frame.position])
        rotation = np.array([[float(v) for v in row] for row in frame.rotation])
        for shape in node.shapes or ():
            if shape.kind is ShapeKind.HEIGHT_FIELD:
                continue  # the ground itself
            polygon = _slice(corners(shape, position, rotation), floor + step, floor + HEIGHT)
            if polygon is not None:
                polygons.append(polygon)
    return polygons


#: points of a convex part beyond which its slice is that of its bounding points in the band
_MOST_POINTS = 64


def _slice(points: Floats, low: float, high: float) -> Floats | None:
    """Return the hull (V, 2) of the part of a convex body between two heights; None if nothing is there."""
    heights = points[:, 2]
    if heights.min() >= high or heights.max() <= low:
        return None
    inside = (heights >= low) & (heights <= high)
    parts = [points[inside, :2]]
    if not inside.all():
        if len(points) > _MOST_POINTS:
            parts.append(points[:, :2])
        else:
            for level in (low, high):
                below, above = points[heights < level], points[heights > level]
                if len(below) and len(above):
                    a, b = below[:, None, :], above[None, :, :]
                    share = (level - a[..., 2]) / (b[..., 2] - a[..., 2])
                    parts.append((a[..., :2] + share[..., None] * (b[..., :2] - a[..., :2])).reshape(-1, 2))
    flat = np.concatenate(parts)
    return hull(flat) if len(flat) else None


def hull(points: Floats) -> Floats:
    """Return the convex hull (V, 2) of points (N, 2), counter-clockwise (monotone chain)."""
    rows = sorted(set(map(tuple, points.round(6).tolist())))
    if len(rows) < 3:
        return np.array(rows, dtype=np.float64)

    def chain(ordered: Iterable[tuple[float, ...]]) -> list[tuple[float, ...]]:
        out: list[tuple[float, ...]] = []
        for x, y in ordered:
            while len(out) > 1 and (out[-1][0] - out[-2][0]) * (y - out[-2][1]) <= (out[-1][1] - out[-2][1]) * (
                x - out[-2][0]
            ):
                out.pop()
            out.append((x, y))
        return out[:-1]

    return np.array(chain(rows) + chain(rows[::-1]), dtype=np.float64)


def inside(polygon: Floats, points: Floats) -> NDArray[np.bool_]:
    """Return whether points (N, 2) are in a simple polygon (V, 2), by the crossings of a ray."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, 0, None], points[:, 1, None]
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    odd: NDArray[np.bool_] = (crosses & (x < at)).sum(axis=1) % 2 == 1
    return odd


def distance_to(polygon: Floats, points: Floats) -> Floats:
    """Return the distances (N,) of points (N, 2) to a convex polygon (V, 2), m; negative within it."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    way = b - a
    squared = np.maximum((way * way).sum(axis=1), 1e-12)
    apart = points[:, None, :] - a
    share = np.clip((apart * way).sum(axis=2) / squared, 0.0, 1.0)
    rest = apart - share[..., None] * way
    distance = np.sqrt((rest * rest).sum(axis=2).min(axis=1))
    within = (way[:, 0] * apart[..., 1] - way[:, 1] * apart[..., 0] >= 0.0).all(axis=1) & (len(polygon) > 2)
    signed: Floats = np.where(within, -distance, distance)
    return signed


class Way(NamedTuple):
    """The way to a goal.

    Attributes:
        time: (H, W) m, the length of the way where it is wide; infinite where there is none.
        direction: (H, W, 2) unit vectors; 0 at the goal, and where there is no way.
        level: the way without stairs; None if it is the same.
    """

    time: Floats
    direction: Floats
    level: Way | None = None


class Link(NamedTuple):
    """Places of which each may be reached from each other one, other than on foot: the cabin of a lift on its floors.

    Attributes:
        cells: (S,) numbers of cells of the grid.
        costs: (S, S) m, ways that last as long.
        is_level: whether those may go there who take no stairs.
    """

    cells: NDArray[np.intp]
    costs: Floats
    is_level: bool = True


class Ground:
    """Walls and ways on a grid.

    Args:
        polygons: convex walls (V, 2), m.
        low, high: corners (2,) of the area, m.
        radius: m, of those who walk.
        floors: number of grounds of that size that are to be put `beside` each other.
        slow: how much longer a way lasts than on the level.

    Attributes:
        cell: m.
        origin: (2,) m, centre of the first cell.
        shape: numbers of cells along Y and X.
        gap: (H, W) m, distance to the nearest wall, at most `FAR`.
        links: between places, which ways use.
        parts: number of the grounds that are beside each other.
    """

    def __init__(
        self,
        polygons: Sequence[Floats],
        low: Floats,
        high: Floats,
        radius: float = 0.25,
        floors: int = 1,
        slow: float = 1.0,
    ) -> None:
        size = np.maximum(np.asarray(high, dtype=np.float64) - low, 1.0)
        self.cell = max(CELL, math.sqrt(float(size[0] * size[1]) * floors / _MOST))
        self.links: list[Link] = []
        self.parts = 1
        self.origin = np.asarray(low, dtype=np.float64)
        self.shape = (int(size[1] / self.cell) + 2, int(size[0] / self.cell) + 2)
        self.radius = radius
        self.gap = np.full(self.shape, FAR)
        for polygon in polygons:
            self._enter(polygon)
        # the normal of the nearest wall: the gradient of the distance
        self._gradient = np.stack(_slopes(self.gap, self.cell), axis=-1)
        self._gradient[self.gap >= FAR] = 0.0
        self.is_free = self.gap > radius
        self.is_free[[0, -1]] = self.is_free[:, [0, -1]] = False
        narrow = np.clip((self.gap - radius) / max(_ROOM - radius, 0.05), 0.0, 1.0)
        #: (H, W) m, through a cell
        self._times = slow * self.cell / (_NARROW + (1.0 - _NARROW) * narrow)

    @property
    def breadth(self) -> float:
        """Extent along X, m, at which another ground may be put beside this one."""
        return self.cell * self.shape[1]

    @classmethod
    def beside(cls, grounds: Sequence[Ground]) -> Ground:
        """Return one ground of several ones of the same size, put side by side along X; nobody walks across the seams.

        The first one stays where it is.
        """
        first = grounds[0]
        if len(grounds) == 1:
            return first
        whole = copy.copy(first)
        whole.parts = len(grounds)
        whole.gap = np.hstack([one.gap for one in grounds])
        width, every = first.shape[1], np.arange(len(grounds))
        whole.gap[:, np.concatenate([every * width, every * width + width - 1])] = 0.0
        whole.shape = (first.shape[0], width * len(grounds))
        whole.is_free = np.hstack([one.is_free for one in grounds])
        whole._gradient = np.hstack([one._gradient for one in grounds])
        whole._times = np.hstack([one._times for one in grounds])
        return whole

    def cell_at(self, point: Floats) -> int:
        """Return the number of the free cell nearest to a point (2,), at most 0.5 m away; -1 if there is none."""
        cells = np.flatnonzero(self.cells_beside(point, 0.5))
        return int(cells[0]) if len(cells) else -1

    def reaches(self, point: Floats) -> bool:
        """Return whether a point (2,) of the world, m, is within the first part of the ground."""
        place = (point - self.origin) / self.cell
        return bool(((place >= 0.0) & (place <= (self.shape[1] // self.parts - 1, self.shape[0] - 1))).all())

    def _enter(self, polygon: Floats) -> None:
        rows, columns = self._window(polygon.min(axis=0) - FAR, polygon.max(axis=0) + FAR)
        if rows.stop <= rows.start or columns.stop <= columns.start:
            return
        wall(self.gap, polygon, rows, columns, self.origin, self.cell)

    def _window(self, low: Floats, high: Floats) -> tuple[slice, slice]:
        first = np.floor((low - self.origin) / self.cell).astype(int)
        last = np.ceil((high - self.origin) / self.cell).astype(int) + 1
        height, width = self.shape
        return slice(max(first[1], 0), min(last[1], height)), slice(max(first[0], 0), min(last[0], width))

    # -- reading between cells ---------------------------------------------------------------

    def _corners(self, points: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp], Floats, Floats]:
        height, width = self.shape
        place = (points - self.origin) / self.cell
        column = np.clip(np.floor(place[:, 0]), 0, width - 2).astype(np.intp)
        row = np.clip(np.floor(place[:, 1]), 0, height - 2).astype(np.intp)
        return row, column, np.clip(place[:, 0] - column, 0.0, 1.0), np.clip(place[:, 1] - row, 0.0, 1.0)

    def clearance(self, points: Floats) -> tuple[Floats, Floats]:
        """Return the distances (N,) of points (N, 2) to the nearest wall, m, and the vectors (N, 2) away from it.

        The vectors are shorter than 1 between two walls, and 0 far from all.
        """
        row, column, x, y = self._corners(points)
        gap, normal = np.zeros(len(points)), np.zeros((len(points), 2))
        for r, c, weight in (
            (row, column, (1 - x) * (1 - y)),
            (row, column + 1, x * (1 - y)),
            (row + 1, column, (1 - x) * y),
            (row + 1, column + 1, x * y),
        ):
            gap += weight * self.gap[r, c]
            normal += weight[:, None] * self._gradient[r, c]
        return gap, normal

    def heading(self, way: Way, points: Floats) -> Floats:
        """Return the unit vectors (N, 2) along a way; 0 where it ends, or where there is none."""
        return self.headings([way], np.zeros(len(points), dtype=np.intp), points)

    def headings(self, ways: Sequence[Way], which: NDArray[np.intp], points: Floats) -> Floats:
        """Return the unit vectors (N, 2) of points (N, 2), each along the way of its number (N,); 0 for -1."""
        row, column, x, y = self._corners(points)
        corners = np.zeros((4, len(points), 2))
        for number in np.unique(which[which >= 0]).tolist():
            rows = np.flatnonzero(which == number)
            r, c, direction = row[rows], column[rows], ways[number].direction
            for k in range(4):
                corners[k, rows] = direction[r + k // 2, c + k % 2]
        weights = ((1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y)
        total = np.zeros((len(points), 2))
        for weight, corner in zip(weights, corners, strict=True):
            total += weight[:, None] * corner
        size = np.sqrt((total * total).sum(axis=1))
        unit: Floats = total / np.maximum(size, 1e-9)[:, None] * (size > 1e-6)[:, None]
        return unit

    def time(self, way: Way, points: Floats) -> Floats:
        """Return the lengths (N,) of the ways from points (N, 2), m; infinite where there is none."""
        return self.times([way], np.zeros(len(points), dtype=np.intp), points)

    def times(self, ways: Sequence[Way], which: NDArray[np.intp], points: Floats) -> Floats:
        """Return the lengths (N,) of the ways from points (N, 2), each on the way of its number (N,), m.

        They are infinite where there is none, and for the number -1.
        """
        row, column, _, _ = self._corners(points)
        best = np.full(len(points), np.inf)
        for number in np.unique(which[which >= 0]).tolist():
            rows = np.flatnonzero(which == number)
            r, c, time = row[rows], column[rows], ways[number].time
            best[rows] = np.minimum(
                np.minimum(time[r, c], time[r, c + 1]), np.minimum(time[r + 1, c], time[r + 1, c + 1])
            )
        return best

    def keep_out(self, before: Floats, after: Floats, radius: Floats) -> Floats:
        """Return where walkers arrive who do not enter walls: they slide along them.

        Args:
            before, after: (N, 2) m, positions.
            radius: (N,) m.
        """
        gap, normal = self.clearance(after)
        lacking = radius - gap
        is_broad = (radius > self.radius) & (lacking > 0.0)
        if is_broad.any():
            # bodies are pressed against walls, and squeeze through where the room is narrower than they are
            there, _ = self.clearance(after + np.where(is_broad, lacking, 0.0)[:, None] * normal)
            lacking = np.where(is_broad & (there < radius - _SQUEEZED), np.minimum(radius, self.radius) - gap, lacking)
        blocked = lacking > 0.0
        if blocked.any():
            after = after + np.where(blocked, lacking, 0.0)[:, None] * normal
            gap, _ = self.clearance(after)
            earlier, _ = self.clearance(before)
            through = blocked & (gap < 0.5 * self.radius) & (gap < earlier)
            after = np.where(through[:, None], before, after)
        low = self.origin + self.cell
        high = self.origin + self.cell * (np.array([self.shape[1], self.shape[0]]) - 2)
        limited: Floats = np.clip(after, low, high)
        return limited

    # -- ways --------------------------------------------------------------------------------

    def cells_beside(self, point: Floats, within: float) -> NDArray[np.bool_]:
        """Return (H, W) the free cells nearest to a point, within a distance, m, on all sides of what stands there.

        Sides are equal if they differ by 0.3 m: people who go to a bench go to the side on which they are.
        """
        found = np.zeros(self.shape, dtype=bool)
        rows, columns = self._window(point - within, point + within)
        r, c = np.nonzero(self.is_free[rows, columns])
        if not len(r):
            return found
        r, c = r + rows.start, c + columns.start
        apart = self.origin + self.cell * np.stack([c, r], axis=1) - point
        distance = np.sqrt((apart * apart).sum(axis=1))
        nearest = float(distance.min())
        if nearest > within:
            return found
        # in the open, the cells around the point; beside something, one row of cells on each side
        good = distance <= (nearest + 0.3 if nearest > self.cell else 1.1 * self.cell)
        found[r[good], c[good]] = True
        return found

    def cells_in(self, area: Floats) -> NDArray[np.bool_]:
        """Return (H, W) the free cells whose centres are in a polygon (V, 2)."""
        found = np.zeros(self.shape, dtype=bool)
        rows, columns = self._window(area.min(axis=0), area.max(axis=0))
        r, c = np.meshgrid(np.arange(rows.start, rows.stop), np.arange(columns.start, columns.stop), indexing="ij")
        centres = self.origin + self.cell * np.stack([c.ravel(), r.ravel()], axis=1)
        if len(centres):
            found[rows, columns] = inside(area, centres).reshape(r.shape)
        return found & self.is_free

    def way_to(self, goal: NDArray[np.bool_]) -> Way:
        """Return the way to the nearest of some cells (H, W)."""
        level = [one for one in self.links if one.is_level]
        way = self._way(goal, self.links)
        return way if len(level) == len(self.links) else way._replace(level=self._way(goal, level))

    def _way(self, goal: NDArray[np.bool_], links: Sequence[Link]) -> Way:
        time = self._arrival(goal, links)
        filled = _continued(time)
        x, y = _downhill(filled)
        size = np.sqrt(x * x + y * y)
        good = (size > 0.0) & np.isfinite(size) & ~goal
        scale = 1.0 / np.where(good, size, 1.0)
        direction = np.stack([np.where(good, x * scale, 0.0), np.where(good, y * scale, 0.0)], axis=-1)
        return Way(time, direction)

    def _arrival(self, goal: NDArray[np.bool_], links: Sequence[Link]) -> Floats:
        """Solve the eikonal equation from some cells (H, W); links shorten the times until none does."""
        time = np.where(goal & self.is_free, 0.0, np.inf)
        seeds = np.flatnonzero(time == 0.0)
        while len(seeds):
            arrival(time, self.is_free, self._times, seeds)
            seeds = self._linked(time.ravel(), links)
        return time

    def _linked(self, time: Floats, links: Sequence[Link]) -> NDArray[np.intp]:
        """Let links shorten the times (H W,); return the cells that are nearer now."""
        changed = [np.zeros(0, dtype=np.intp)]
        for link in links:
            through = (time[link.cells][None, :] + link.costs).min(axis=1)
            better = through < time[link.cells] - 1e-6
            time[link.cells[better]] = through[better]
            changed.append(link.cells[better])
        return np.concatenate(changed)


def _slopes(values: Floats, cell: float) -> tuple[Floats, Floats]:
    return np.asarray(np.gradient(values, cell, axis=1)), np.asarray(np.gradient(values, cell, axis=0))


def _shifted(values: Floats, rows: int, columns: int) -> Floats:
    """Return the values (H, W) of neighbours; infinite beyond the edge."""
    result = np.full_like(values, np.inf)
    height, width = values.shape
    result[max(-rows, 0) : height - max(rows, 0), max(-columns, 0) : width - max(columns, 0)] = values[
        max(rows, 0) : height - max(-rows, 0), max(columns, 0) : width - max(-columns, 0)
    ]
    return result


def _continued(time: Floats) -> Floats:
    """Continue times a few cells into walls, so that who is pressed into them finds out again."""
    for _ in range(6):
        near = np.minimum(
            np.minimum(_shifted(time, 0, 1), _shifted(time, 0, -1)),
            np.minimum(_shifted(time, 1, 0), _shifted(time, -1, 0)),
        )
        time = np.where(np.isinf(time), near + 10.0, time)
    return time


def _downhill(time: Floats) -> tuple[Floats, Floats]:
    """Return the components (H, W) of the way down: towards the lower neighbour along each axis."""
    result = []
    for rows, columns in ((0, 1), (1, 0)):
        up, down = _shifted(time, rows, columns), _shifted(time, -rows, -columns)
        with np.errstate(invalid="ignore"):
            rise_up, rise_down = time - up, time - down
        best = np.maximum(
            np.nan_to_num(rise_up, nan=0.0, posinf=1.0, neginf=0.0),
            np.nan_to_num(rise_down, nan=0.0, posinf=1.0, neginf=0.0),
        )
        positive = np.maximum(best, 0.0)
        toward_up = np.nan_to_num(rise_up, nan=0.0, posinf=1.0, neginf=0.0) >= np.nan_to_num(
            rise_down, nan=0.0, posinf=1.0, neginf=0.0
        )
        result.append(np.where(np.isfinite(positive), np.where(toward_up, positive, -positive), 0.0))
    return result[0], result[1]
