"""The geofence: where a vehicle may be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from morse.plugins.mavlink.autopilot import items

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.mathutils.rotations import Triple
    from morse.plugins.mavlink.autopilot.items import Item
    from morse.plugins.mavlink.autopilot.place import Place
    from morse.plugins.mavlink.messages import MavlinkMessage

#: MAV_CMD_NAV_FENCE: a vertex of a polygon to stay in, or out of; a circle to stay in, or out of
_INSIDE, _OUTSIDE, _IN_CIRCLE, _OUT_OF_CIRCLE = 5001, 5002, 5003, 5004
#: FENCE_BREACH
NO_BREACH, BOUNDARY, TOO_HIGH = 0, 3, 2
_FEWEST_CORNERS = 3
_LARGEST = 1e7

_Point = tuple[float, float]


class _Area(NamedTuple):
    """A polygon, or a circle: one point with a radius, m."""

    stays_in: bool
    points: tuple[_Point, ...]
    radius: float

    def has(self, x: float, y: float) -> bool:
        """Whether a point is inside."""
        if self.radius:
            return math.dist(self.points[0], (x, y)) <= self.radius
        is_inside = False
        for (ax, ay), (bx, by) in zip(self.points, (*self.points[1:], self.points[0]), strict=True):
            if (ay > y) != (by > y) and x < ax + (bx - ax) * (y - ay) / (by - ay):
                is_inside = not is_inside
        return is_inside


class Fence:
    """Polygons and circles; the vehicle stays inside one of those to stay in, and outside all others, as with PX4.

    Attributes:
        items: as they were uploaded.
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        self.items: list[Item] = []
        self._areas: tuple[_Area, ...] = ()

    @staticmethod
    def item_of(message: MavlinkMessage) -> Item | int:
        """Read MISSION_ITEM_INT or MISSION_ITEM; MAV_MISSION_RESULT if it is not valid or not supported."""
        item = items.item_of(message, (_INSIDE, _OUTSIDE, _IN_CIRCLE, _OUT_OF_CIRCLE))
        if isinstance(item, int):
            return item
        size = item.params[0]
        if item.command in (_IN_CIRCLE, _OUT_OF_CIRCLE):
            return item if 0.0 < size < _LARGEST else items.INVALID_PARAM[0]
        return item if size >= _FEWEST_CORNERS and size == int(size) else items.INVALID_PARAM[0]

    def replace(self, fence: list[Item]) -> int:
        """Store other items; MAV_MISSION_RESULT."""
        try:
            areas = tuple(self._areas_of(fence))
        except ValueError:
            return items.ERROR
        self.items, self._areas = fence, areas
        return items.ACCEPTED

    def _areas_of(self, fence: list[Item]) -> Iterator[_Area]:
        """The areas of items.

        Raises:
            ValueError: a polygon lacks corners.
        """
        corners: list[_Point] = []
        before: tuple[int, float] | None = None
        for item in fence:
            x, y, _ = self._place.from_earth(item.x * 1e-7, item.y * 1e-7, 0.0)
            size = item.params[0]
            if corners and before != (item.command, size):
                break
            if item.command in (_IN_CIRCLE, _OUT_OF_CIRCLE):
                yield _Area(item.command == _IN_CIRCLE, ((x, y),), size)
                continue
            corners.append((x, y))
            before = item.command, size
            if len(corners) == size:
                yield _Area(item.command == _INSIDE, tuple(corners), 0.0)
                corners = []
        if corners:
            raise ValueError("a polygon lacks corners")

    def breach(self, position: Triple, home: Triple, farthest: float, highest: float) -> int:
        """FENCE_BREACH of a position.

        Args:
            position: in the world, m.
            home: in the world, m.
            farthest: largest distance from home, m; 0 for any.
            highest: largest height above home, m; 0 for any.
        """
        x, y, z = position
        if highest and z - home[2] > highest:
            return TOO_HIGH
        if farthest and math.dist(home[:2], (x, y)) > farthest:
            return BOUNDARY
        insides = [area for area in self._areas if area.stays_in]
        if insides and not any(area.has(x, y) for area in insides):
            return BOUNDARY
        return BOUNDARY if any(area.has(x, y) for area in self._areas if not area.stays_in) else NO_BREACH
