"""Drives a robot to a place, around what stands in the way."""

from __future__ import annotations

import logging
import math
from functools import cached_property
from typing import Any

from morse.actuators.going import STOP, TRANSIT, Going, marker
from morse.actuators.obstacle_radars import REACH, ObstacleRadars
from morse.core.hints import nearest
from morse.core.limits import LENGTH, AbsoluteSpeed, Length, Position
from morse.core.services import async_service, interruptible, service
from morse.helpers.components import add_data, add_kind, add_property

logger = logging.getLogger(__name__)

_SPEED: dict[str, Any] = {"unit": "m/s", "low": 0.0, "high": 1e4}
#: a robot that looks farther aside turns on the spot
_TURN_ON_THE_SPOT = math.radians(60.0)
#: m ahead of the radars; nearer things leave no room for a bend
_NO_ROOM = 1.0
#: the cones are narrower than the robot: it turns so much farther than until they see nothing any more
_FARTHER = math.radians(20.0)
#: m that it goes on beyond what it has seen, until its whole length has passed
_BEYOND = 1.5


class Waypoint(Going):
    """Drives the robot to a place by a forward speed and a yaw rate, and steers away from what its radars see.

    The robot turns at half its speed (rad per m) towards the place, on the spot as long as the heading is wrong by
    60 degrees or more, and goes straight on while it is wrong by less than ``AngleTolerance``. Two radars look 3 m
    ahead. The robot turns away from the side where something is nearer, passes by, and takes up its way again; the
    last 3 m to the place it does not look.
    """

    _name = "Waypoint"
    _short_desc = "Motion controller which drives the robot to a place"

    not_state = ("radars",)

    add_data("tolerance", 0.5, "float", "How near is near enough", **LENGTH)
    add_data("speed", 1.0, "float", "How fast it goes; at first the property Speed", **_SPEED)
    add_property("_obstacle_avoidance", True, "ObstacleAvoidance", "bool", "Steer away from what is in the way")
    add_property("_free_z", False, "FreeZ", "bool", "Go up and down, too: for aircraft and submarines")
    add_property(
        "_angle_tolerance",
        math.radians(10.0),
        "AngleTolerance",
        "float",
        "A heading that is wrong by less is not corrected",
        unit="rad",
        low=0.0,
        high=math.pi,
    )
    add_property("_speed", 1.0, "Speed", "float", "Speed until another one is asked for", **_SPEED)
    add_property("_target", "", "Target", "string", "Name of an object that is put to the place to go to")
    add_property(
        "_ignore", "", "Ignore", "string", "Things with one of these properties are not avoided: names and commas"
    )
    add_kind("pose", position=("x", "y", "z"), tolerance="tolerance", speed="speed")

    _obstacle_avoidance: bool
    _free_z: bool
    _angle_tolerance: float
    _speed: float
    _target: str
    _ignore: str

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.local_data["speed"] = float(self._speed)
        self._speed_before_stop = float(self._speed)
        #: where it was called off: standing there is no arrival
        self._called_off: tuple[float, float, float] | None = None
        #: +1 to pass by on the left, -1 on the right, 0 if nothing was seen
        self._side = 0.0
        #: radians to turn on, and metres to go straight on then, after something went out of sight
        self._turn_on = self._straight = 0.0
        self._marked: tuple[float, float, float] | None = None
        if self._target and marker(self, self._target) is None:
            known = nearest(self._target, sorted(self.context.world.objects_by_name))
            logger.warning("%s: there is no object '%s' (Target)%s", self.name(), self._target, known)

    @cached_property
    def radars(self) -> ObstacleRadars:
        """What looks ahead; made when the robot goes for the first time."""
        return ObstacleRadars(self.context.world, self.bge_object)

    # -- services --------------------------------------------------------------------------

    @service
    def setdest(
        self, x: Position, y: Position, z: Position, tolerance: Length = 0.5, speed: AbsoluteSpeed = 1.0
    ) -> bool:
        """Go to a place, and do not tell when it is reached.

        Args:
            x: metres.
            y: metres.
            z: metres; counts only with ``FreeZ``.
            tolerance: metres.
            speed: m/s.

        Returns:
            False if the robot is there already, True otherwise.
        """
        if self._distance(x, y, z) <= tolerance:
            return False
        self._go(x, y, z, tolerance, speed)
        return True

    @interruptible
    @async_service
    def goto(self, x: Position, y: Position, z: Position, tolerance: Length = 0.5, speed: AbsoluteSpeed = 1.0) -> None:
        """Go to a place; ends with ``Arrived``.

        Args:
            x: metres.
            y: metres.
            z: metres; counts only with ``FreeZ``.
            tolerance: metres.
            speed: m/s.
        """
        self._go(x, y, z, tolerance, speed)

    @service
    def stop(self) -> str:
        """Stand still; ``resume`` goes on, and a ``goto`` that is under way waits for that."""
        data = self.local_data
        if data["speed"]:
            self._speed_before_stop = data["speed"]
        data["speed"] = 0.0
        self.robot_parent.move_status = STOP
        return STOP

    @service
    def resume(self) -> str:
        """Go on after ``stop``, as fast as before."""
        if not self.local_data["speed"]:
            self.local_data["speed"] = self._speed_before_stop
        self.robot_parent.move_status = TRANSIT
        return TRANSIT

    @service(changes=False)
    def get_status(self) -> str:
        """``Transit``, ``Arrived`` or ``Stop``."""
        return str(self.robot_parent.move_status)

    def interrupt(self) -> None:
        """Stay where it is."""
        here = self.bge_object.world_pose()[0]
        self._called_off = (float(here[0]), float(here[1]), float(here[2]))
        self.local_data.update(zip("xyz", self._called_off, strict=True))
        self.robot_parent.move_status = STOP
        super().interrupt()

    def _go(self, x: float, y: float, z: float, tolerance: float, speed: float) -> None:
        self.local_data.update(x=float(x), y=float(y), z=float(z), tolerance=float(tolerance), speed=float(speed))
        self._called_off = None
        self._side = self._turn_on = self._straight = 0.0
        self.robot_parent.move_status = TRANSIT

    # -- the way ---------------------------------------------------------------------------

    def _distance(self, x: float, y: float, z: float) -> float:
        here = self.bge_object.world_pose()[0]
        flat = math.hypot(x - here[0], y - here[1])
        return math.hypot(flat, z - here[2]) if self._free_z else flat

    def default_action(self) -> None:
        """Go on."""
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
            self._halt()
        else:
            self.robot_parent.move_status = TRANSIT
            self._go_on(place, distance, data["speed"])

    def _mark(self, place: tuple[float, float, float]) -> None:
        shown = marker(self, self._target)
        if shown is not None:
            shown.worldPosition = place
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
                # straight above or below: no heading leads there
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
        """Forward speed and yaw rate that lead around what the radars see; None if the way is free."""
        left, right = self.radars.look([name.strip() for name in self._ignore.split(",") if name.strip()])
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
