"""The base class of actuators that drive to a goal position."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.limits import POSITION
from morse.helpers.components import add_data, add_property, add_state

if TYPE_CHECKING:
    from collections.abc import Collection

    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.world import Body, World


ARRIVED, TRANSIT, STOP = "Arrived", "Transit", "Stop"


def marker(component: Object, name: str) -> Body | None:
    """Return the object of that name, which marks the goal of a robot; None if there is none."""
    return component.context.world.objects_by_name.get(name) if name else None


class GoalMotion(Actuator):
    """Receives a goal position, initially the present position, to which its subclasses drive the robot."""

    add_data("x", 0.0, "float", "X of the goal; initially the position of the actuator", frame="world", **POSITION)
    add_data("y", 0.0, "float", "Y of the goal; initially the position of the actuator", frame="world", **POSITION)
    add_data("z", 0.0, "float", "Z of the goal; initially the position of the actuator", frame="world", **POSITION)
    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed of the body, Position shifts it each tick",
        choices=("Velocity", "Position"),
    )
    add_property(
        "_remain_at_destination",
        False,
        "RemainAtDestination",
        "bool",
        "Hold the goal position actively; otherwise the robot is not controlled within the tolerance",
    )

    add_state("_moving", bool, "Whether a service moves the robot")

    _type: str
    _remain_at_destination: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.local_data.update(zip("xyz", map(float, obj.world_pose()[0]), strict=True))
        self._moving = False

    def _drive(self, linear: tuple[float, float, float], turn: float = 0.0) -> None:
        self._moving = True
        self.robot_parent.apply_speed(self._type, linear, (0.0, 0.0, turn))

    def _halt(self, *, hold: bool = False) -> None:
        """Stop: send one command, or one command every tick to ``hold`` the position."""
        if self._moving or hold:
            self.robot_parent.apply_speed(self._type, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        self._moving = False

    def _arrive(self) -> None:
        """The robot has arrived."""
        self._halt(hold=self._remain_at_destination)
        self.robot_parent.move_status = ARRIVED
        if self.on_completion is not None:
            self.completed(status.SUCCESS, ARRIVED)


#: metres
REACH = 3.0
#: positions of the radars: in front of, to either side of, and above the actuator, m
_AHEAD, _ASIDE, _ABOVE = 0.7, 0.4, 0.8
#: half opening angle of the cones, rad
_HALF_ANGLE = math.radians(5.0)
#: number of rays on the surface of a cone, in addition to the central ray
_ROUND = 8


class ObstacleRadars:
    """Two cones of 5 degrees with a range of 3 m, to the left and to the right of the centre of the robot.

    Rays are cast along the axis and along eight lines on the surface of each cone.

    Args:
        world: the world.
        obj: the object of the actuator.
    """

    def __init__(self, world: World, obj: Body) -> None:
        tangent = math.tan(_HALF_ANGLE)
        turns = [2.0 * math.pi * i / _ROUND for i in range(_ROUND)]
        cone = [(1.0, 0.0, 0.0), *((1.0, tangent * math.cos(a), tangent * math.sin(a)) for a in turns)]
        origins = [(_AHEAD, side * _ASIDE, _ABOVE) for side in (1.0, -1.0) for _ in cone]
        self._rays = world.rays.bundle(obj, cone * 2, REACH, origins)
        self._each = len(cone)

    def look(self, names: Collection[str]) -> tuple[float, float]:
        """Return the distances of the nearest obstacles to the left and to the right, m; infinite for none.

        Args:
            names: objects with one of these properties are ignored.
        """
        rays = self._rays
        rays.refresh()
        distances = rays.distances.tolist()
        if names:
            for i, distance in enumerate(distances):
                if distance < math.inf and self._is_ignored(i, names):
                    distances[i] = math.inf
        return min(distances[: self._each]), min(distances[self._each :])

    def _is_ignored(self, ray: int, names: Collection[str]) -> bool:
        obj = self._rays.object_of(ray)
        while obj is not None:
            if any(name in obj for name in names):
                return True
            obj = obj.parent
        return False


class PoseHolding(Actuator):
    """Holds the robot at a pose, independent of forces; the robot is released when the actuator is deactivated."""

    @property
    def active(self) -> bool:
        """Whether it holds the robot."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        Actuator.active.fset(self, value)  # type: ignore[attr-defined] # a property
        if not self._active:
            self.robot_parent.bge_object.restoreDynamics()
