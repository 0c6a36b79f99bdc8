"""What several sensors share: objects with a property, and what is between them and the sensor."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from morse.core.sensor import Sensor
    from morse.core.world import Body

#: most objects with a property, and most surfaces on a line, so that no world makes a sensor slow
_MOST, _SURFACES = 256, 16
#: distance behind a surface from which a line is followed, m
_STEP = 1e-4


class Source(NamedTuple):
    """An object with a property, as a sensor finds it.

    Attributes:
        body: the object.
        offset: (3,) from the sensor, m, in its axes.
        distance: m.
    """

    body: Body
    offset: Sequence[float]
    distance: float

    @property
    def azimuth(self) -> float:
        """Angle to the left of the X axis of the sensor, rad."""
        return math.atan2(self.offset[1], self.offset[0])

    @property
    def elevation(self) -> float:
        """Angle above the X-Y plane of the sensor, rad."""
        return math.atan2(self.offset[2], math.hypot(self.offset[0], self.offset[1]))


class Wall(NamedTuple):
    """An object between two points.

    Attributes:
        body: the object.
        thickness: length of the line inside of it, m.
    """

    body: Body
    thickness: float


def sources(sensor: Sensor, name: str) -> Iterator[Source]:
    """Yield the objects of the world that have a property, in the order of the scene; at most 256."""
    position, rotation = sensor.bge_object.world_pose()
    found = 0
    for body in sensor.context.world.objects():
        if name not in body or found >= _MOST:
            continue
        found += 1
        there = body.world_pose()[0]
        away = [there[axis] - position[axis] for axis in range(3)]
        offset = [sum(rotation[3 * row + axis] * away[row] for row in range(3)) for axis in range(3)]
        yield Source(body, offset, math.sqrt(sum(part * part for part in away)))


def walls(sensor: Sensor, target: Body) -> list[Wall]:
    """Return what is between a sensor and an object, from the sensor on; neither robot nor target counts."""
    begin, end = list(sensor.bge_object.world_pose()[0]), list(target.world_pose()[0])
    length = math.dist(begin, end)
    if length < _STEP:
        return []
    way = [(b - a) / length for a, b in zip(begin, end, strict=True)]
    found: list[Wall] = []
    inside: tuple[Body, float] | None = None
    at = 0.0
    for _ in range(_SURFACES):
        start = [a + w * at for a, w in zip(begin, way, strict=True)]
        if length - at < _STEP:
            break
        body, point, _normal = sensor.bge_object.rayCast(end, start)
        if body is None or point is None or body is target:
            break
        at = math.dist(begin, point)
        if inside is not None and inside[0] is body:
            found[-1] = Wall(body, at - inside[1])
            inside = None
        else:
            # a surface without a back has no thickness
            found.append(Wall(body, 0.0))
            inside = (body, at)
        at += _STEP
    return found
