"""Drives a robot to a position with obstacle avoidance."""

from __future__ import annotations

import math
from functools import cached_property
from typing import TYPE_CHECKING

from morse.actuators.goal_motion import REACH, STOP, TRANSIT, GoalMotion, ObstacleRadars, marker
from morse.core.calls import of_distance
from morse.core.limits import LENGTH, AbsoluteSpeed, Length, Position
from morse.core.reports.quoting import nearest, quoted
from morse.core.services import async_service, interruptible, service
from morse.helpers.components import add_data, add_kind, add_property, add_state

if TYPE_CHECKING:
    from morse.core.limits import Limits
    from morse.core.robot import Robot
    from morse.core.world import Body

_SPEED: Limits = {"unit": "m/s", "low": 0.0, "high": 1e4}
#: heading error above which the robot turns on the spot
_TURN_ON_THE_SPOT = math.radians(60.0)
#: distance of an obstacle from the radars below which the robot turns on the spot, m
_NO_ROOM = 1.0
#: additional turn after the obstacle has left the cones, because the cones are narrower than the robot
_FARTHER = math.radians(20.0)
#: additional distance after an obstacle, until the robot has passed it with its whole length, m
_BEYOND = 1.5


class Waypoint(GoalMotion):
    """Drives the robot to a position by forward speed and yaw rate, and avoids obstacles that its radars detect.

    The robot turns towards the goal at half its speed (rad per m). It turns on the spot if the heading error is 60
    degrees or more, and drives straight if the error is less than ``AngleTolerance``. Two radars have a range of 3 m.
    The robot turns away from the side with the nearer obstacle, passes it, and then continues to the goal. The radars
    are not used within 3 m of the goal.
    """

    _name = "Waypoint"
    _short_desc = "Motion controller which drives the robot to a position"

    add_data("tolerance", 0.5, "float", "Distance at which the robot has arrived", **LENGTH)
    add_data("speed", 1.0, "float", "Speed of the robot; initially the property Speed", **_SPEED)
    add_property("_obstacle_avoidance", True, "ObstacleAvoidance", "bool", "Steer around obstacles")
    add_property("_free_z", False, "FreeZ", "bool", "Move vertically as well, for aircraft and submarines")
    add_property(
        "_angle_tolerance",
        math.radians(10.0),
        "AngleTolerance",
        "float",
        "Heading errors below it are not corrected",
        unit="rad",
        low=0.0,
        high=math.pi,
    )
    add_property("_speed", 1.0, "Speed", "float", "Speed until a command sets it", **_SPEED)
    add_property("_target", "", "Target", "string", "Name of an object that is moved to the goal")
    add_property(
        "_ignore",
        "",
        "Ignore",
        "string",
        "Objects with one of these properties are not avoided: names joined by commas",
    )
    add_kind("pose", position=("x", "y", "z"), tolerance="tolerance", speed="speed")

    add_state("_called_off", tuple | None, "Position at which a motion was cancelled", unit="m")
    add_state("_marked", tuple | None, "Position of the target object", unit="m")
    add_state("_side", float, "1 to pass an obstacle on the left, -1 on the right, 0 without obstacle")
    add_state("_speed_before_stop", float, "Speed to which resume() returns", unit="m/s")
    add_state("_straight", float, "Remaining distance past an obstacle", unit="m")
    add_state("_turn_on", float, "Remaining turn after an obstacle has left the radars", unit="rad")

    _obstacle_avoidance: bool
    _free_z: bool
    _angle_tolerance: float
    _speed: float
    _target: str
    _ignore: str

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.local_data["speed"] = float(self._speed)
        self._speed_before_stop = float(self._speed)
        #: position at which a motion was cancelled; being there does not count as an arrival
        self._called_off: tuple[float, float, float] | None = None
        #: +1 to pass an obstacle on the left, -1 on the right, 0 without obstacle
        self._side = 0.0
        #: remaining angle, rad, and distance, m, after an obstacle has left the cones
        self._turn_on = self._straight = 0.0
        self._marked: tuple[float, float, float] | None = None
        if self._target and marker(self, self._target) is None:
            hint = nearest(self._target, sorted(self.context.world.objects_by_name))
            text = f"{self.name()}: there is no object {quoted(self._target)} (Target){hint}"
            self.context.complaints.warn(text, text)

    @cached_property
    def radars(self) -> ObstacleRadars:
        """The radars, created on demand."""
        return ObstacleRadars(self.context.world, self.bge_object)

    # -- services --------------------------------------------------------------------------

    @service
    def setdest(
        self, x: Position, y: Position, z: Position, tolerance: Length = 0.5, speed: AbsoluteSpeed = 1.0
    ) -> bool:
        """Drive to a position without waiting for the arrival.

        Args:
            x: metres.
            y: metres.
            z: metres; used only with ``FreeZ``.
            tolerance: metres.
            speed: m/s.

        Returns:
            False if the robot is already there, True otherwise.
        """
        if self._distance(x, y, z) <= tolerance:
            return False
        self._go(x, y, z, tolerance, speed)
        return True

    @interruptible
    @async_service
    def goto(self, x: Position, y: Position, z: Position, tolerance: Length = 0.5, speed: AbsoluteSpeed = 1.0) -> None:
        """Drive to a position; the service ends with ``Arrived``.

        Args:
            x: metres.
            y: metres.
            z: metres; used only with ``FreeZ``.
            tolerance: metres.
            speed: m/s.
        """
        self._go(x, y, z, tolerance, speed)

    @service
    def stop(self) -> str:
        """Drive no more, so that the robot rolls out; a running ``goto`` waits until ``resume`` is called."""
        data = self.local_data
        if data["speed"]:
            self._speed_before_stop = data["speed"]
        data["speed"] = 0.0
        self.robot_parent.move_status = STOP
        return STOP

    @service
    def resume(self) -> str:
        """Continue after ``stop``, at the previous speed."""
        if not self.local_data["speed"]:
            self.local_data["speed"] = self._speed_before_stop
        self.robot_parent.move_status = TRANSIT
        return TRANSIT

    @service(changes=False)
    def get_status(self) -> str:
        """Return ``Transit``, ``Arrived`` or ``Stop``."""
        return str(self.robot_parent.move_status)

    def interrupt(self) -> None:
        """Stop at the present position."""
        here = self.bge_object.world_pose()[0]
        self._called_off = (float(here[0]), float(here[1]), float(here[2]))
        self.local_data.update(zip("xyz", self._called_off, strict=True))
        self.robot_parent.move_status = STOP
        super().interrupt()

    def progress(self) -> dict[str, object]:
        """Return the distance to the destination, and the time at the present speed."""
        data = self.local_data
        return of_distance(self._distance(data["x"], data["y"], data["z"]), data["speed"])

    def _go(self, x: float, y: float, z: float, tolerance: float, speed: float) -> None:
        self.local_data.update(x=float(x), y=float(y), z=float(z), tolerance=float(tolerance), speed=float(speed))
        self._called_off = None
        self._side = self._turn_on = self._straight = 0.0
        self.robot_parent.move_status = TRANSIT

    # -- motion ----------------------------------------------------------------------------

    def _distance(self, x: float, y: float, z: float) -> float:
        here = self.bge_object.world_pose()[0]
        flat = math.hypot(x - here[0], y - here[1])
        return math.hypot(flat, z - here[2]) if self._free_z else flat

    def default_action(self) -> None:
        """Move by one tick."""
        data = self.local_data
        place = data["x"], data["y"], data["z"]
        if place != self._marked:
            self._mark(place)
        distance = self._distance(*place)
        if distance <= data["tolerance"]:
            if place == self._called_off:
                self._halt(hold=self._remain_at_destination)
            else:
                self._arrive()
        elif not data["speed"]:
            # without a command, the robot rolls out
            self._moving = False
        else:
            self.robot_parent.move_status = TRANSIT
            self._go_on(place, distance, data["speed"])

    def _mark(self, place: tuple[float, float, float]) -> None:
        target_marker = marker(self, self._target)
        if target_marker is not None:
            target_marker.worldPosition = place
        self._marked = place

    def _go_on(self, place: tuple[float, float, float], distance: float, speed: float) -> None:
        x, y, z = self.bge_object.world_pose()[0]
        r = self.robot_parent.bge_object.world_pose()[1]
        across, climb = math.hypot(place[0] - x, place[1] - y), 0.0
        speed = min(speed, distance * self.frequency)
        rate = 0.5 * self.local_data["speed"]
        if self._free_z:
            climb = speed * (place[2] - z) / distance
            speed *= across / distance
            if across <= 0.5 * self.local_data["tolerance"]:
                # directly above or below the goal the heading is undefined
                self._drive((speed, 0.0, climb))
                return
        wrong = math.remainder(math.atan2(place[1] - y, place[0] - x) - math.atan2(r[3], r[0]), 2.0 * math.pi)
        if self._obstacle_avoidance and distance + self.local_data["tolerance"] > REACH:
            around = self._around(speed, rate, aside=abs(wrong) >= self._angle_tolerance)
            if around is not None:
                self._drive((around[0], 0.0, climb), around[1])
                return
        turn = 0.0
        if abs(wrong) >= self._angle_tolerance:
            turn = math.copysign(min(rate, 0.5 * abs(wrong) * self.frequency), wrong)
        self._drive((0.0 if abs(wrong) >= _TURN_ON_THE_SPOT else speed, 0.0, climb), turn)

    def _around(self, speed: float, rate: float, *, aside: bool) -> tuple[float, float] | None:
        """Return forward speed and yaw rate for obstacle avoidance; None without obstacles."""
        names = [name.strip() for name in self._ignore.split(",") if name.strip()] if self._ignore else ()
        left, right = self.radars.look(names)
        near = min(left, right)
        if near < math.inf:
            if not self._side:
                self._side = -1.0 if left < right else 1.0
            self._turn_on, self._straight = _FARTHER, near + _BEYOND
        elif self._turn_on > 0.0:
            self._turn_on -= rate / self.frequency
        elif self._straight > 0.0:
            self._straight -= speed / self.frequency
            return speed, 0.0
        if self._turn_on > 0.0:
            return (speed if self._straight > _NO_ROOM + _BEYOND else 0.0), self._side * rate
        if not aside:
            self._side = 0.0
        return None
