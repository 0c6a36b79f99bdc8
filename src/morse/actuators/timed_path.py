"""Moves a robot along a path with times, such as a pedestrian of a world."""

from __future__ import annotations

import math
from bisect import bisect_right
from typing import TYPE_CHECKING

from morse.actuators.goal_motion import PoseHolding
from morse.core.limits import ANGLE, POSITION
from morse.helpers.components import add_data, add_kind, add_property, euler
from morse.mathutils.rotations import rotation_from_euler

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_Point = tuple[float, ...]
_FIELDS = ("x", "y", "z", "roll", "pitch", "yaw")
_MOST_POINTS = 10_000


class TimedPath(PoseHolding):
    """Moves the robot along the points of a path, whatever the forces on it.

    Between two points, the position and the angles change in proportion to the time; each angle takes the shorter way.
    """

    _name = "Timed path"
    _short_desc = "Moves the robot along points, each at its time"

    add_data("x", 0.0, "float", "X of the present place", frame="world", **POSITION)
    add_data("y", 0.0, "float", "Y of the present place", frame="world", **POSITION)
    add_data("z", 0.0, "float", "Z of the present place", frame="world", **POSITION)
    add_data("yaw", 0.0, "float", "Rotation about Z", frame="world", **ANGLE)
    add_data("pitch", 0.0, "float", "Rotation about Y", frame="world", **ANGLE)
    add_data("roll", 0.0, "float", "Rotation about X", frame="world", **ANGLE)
    add_kind("pose", position=("x", "y", "z"), orientation=euler("roll", "pitch", "yaw"))
    add_property("_points", "", "Points", "string", "Points ``time x y z roll pitch yaw``, separated by semicolons")
    add_property("_loop", True, "Loop", "bool", "Whether the path begins again at its end")
    add_property("_delay", 0.0, "Delay", "float", "Time before the first start", unit="s", low=0.0, high=1e9)

    _points: str
    _loop: bool
    _delay: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._path = _path(self._points)
        self._times = [point[0] for point in self._path]

    def default_action(self) -> None:
        """Place the robot on the path."""
        if not self._path:
            return
        time, length = self.clock.time - self._delay, self._times[-1]
        if self._loop and length > 0.0 and time > length:
            time %= length
        values = self._at(min(max(time, 0.0), length))
        self.local_data.update(zip(_FIELDS, values, strict=True))
        body = self.robot_parent.bge_object
        body.set_pose(values[:3], rotation_from_euler(values[3:], "XYZ"))
        body.halt()
        body.suspendDynamics()

    def _at(self, time: float) -> _Point:
        """Position and angles at a time, s."""
        after = bisect_right(self._times, time)
        if after == 0 or after == len(self._times):
            return self._path[max(after - 1, 0)][1:]
        one, other = self._path[after - 1], self._path[after]
        share = (time - one[0]) / (other[0] - one[0])
        place = [a + share * (b - a) for a, b in zip(one[1:4], other[1:4], strict=True)]
        angles = [
            math.remainder(a + share * math.remainder(b - a, math.tau), math.tau)
            for a, b in zip(one[4:], other[4:], strict=True)
        ]
        return (*place, *angles)


def _path(text: str) -> list[_Point]:
    """The points of a path, in the order of their times.

    Raises:
        ValueError: a point has not seven finite numbers, or there are too many.
    """
    points = []
    for part in filter(str.strip, text.split(";")):
        try:
            point = tuple(float(word) for word in part.split())
        except ValueError:
            point = ()
        if len(point) != 7 or not all(abs(value) <= 1e6 for value in point):
            raise ValueError(f"Points: expected 'time x y z roll pitch yaw', not {part.strip()[:60]!r}")
        points.append(point)
    if len(points) > _MOST_POINTS:
        raise ValueError(f"Points: {len(points)} points, at most {_MOST_POINTS} can be used")
    return sorted(points)
