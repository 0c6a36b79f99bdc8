"""Requests to doors, gates and lifts, of middlewares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.helpers.components import add_data, add_kind
from morse.plugins.facilities.robots.door import Opening
from morse.plugins.facilities.robots.lift import Lift

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_OPEN = 2
_END = 0


class DoorRequest(Actuator):
    """Opens and closes the door or gate on which it is mounted; with ROS 2, by ``rmf_door_msgs/DoorRequest``.

    The door stays open as long as 2 is requested, whatever its ``hold`` says.
    """

    _name = "DoorRequest"
    _short_desc = "Opens and closes a door or a gate by messages"

    add_data("door_name", "", "string", "Name of the door; requests to others are ignored")
    add_data("requested_mode", 0, "int", "0 closed, 2 open", low=0, high=2)
    add_kind("door_request", door_name="door_name", requested_mode="requested_mode")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._door = parent if isinstance(parent, Opening) else None
        if self._door is None:
            text = f"{self.name()} is mounted on a door or a gate: door.append(DoorRequest()); it does nothing here"
            self.context.complaints.warn(text, text)
        self._wanted = 0

    def default_action(self) -> None:
        """Open while it is asked for; close once when that ends."""
        data, door = self.local_data, self._door
        if door is None or data["door_name"] not in ("", door.name()):
            return
        mode = data["requested_mode"]
        if mode == _OPEN:
            door.keep_open()
        elif mode == 0 and self._wanted == _OPEN:
            door.close()
        self._wanted = mode


class LiftRequest(Actuator):
    """Calls the lift on which it is mounted; with ROS 2, by ``rmf_lift_msgs/LiftRequest``."""

    _name = "LiftRequest"
    _short_desc = "Calls a lift by messages"

    add_data("lift_name", "", "string", "Name of the lift; requests to others are ignored")
    add_data("session_id", "", "string", "Who asks")
    add_data("request_type", 1, "int", "0 ends the session, 1 of a robot, 2 of a person", low=0, high=2)
    add_data("destination_floor", "", "string", "Number of the floor; empty for none")
    add_data("door_state", 0, "int", "0 closed, 2 open", low=0, high=2)
    add_kind(
        "lift_request",
        lift_name="lift_name",
        session_id="session_id",
        request_type="request_type",
        destination_floor="destination_floor",
        door_state="door_state",
    )

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._lift = parent if isinstance(parent, Lift) else None
        if self._lift is None:
            text = f"{self.name()} is mounted on a lift: lift.append(LiftRequest()); it does nothing here"
            self.context.complaints.warn(text, text)
        self._done = ""

    def default_action(self) -> None:
        """Call the lift once for each new floor; hold its doors open while that is asked for."""
        data, lift = self.local_data, self._lift
        if lift is None or data["lift_name"] not in ("", lift.name()) or data["request_type"] == _END:
            self._done = ""
            return
        floor = data["destination_floor"]
        if floor and floor != self._done:
            self._done = floor
            if floor.isdecimal() and len(floor) < 4 and int(floor) < len(lift.levels):
                lift.call(int(floor))
            else:
                text = f"{self.name()}: {lift.name()} has the floors 0 to {len(lift.levels) - 1}, not '{floor:.40}'"
                self.context.complaints.warn(text, text)
        if data["door_state"] == _OPEN and str(lift.local_data["level"]) == floor:
            lift.hold_doors(1.0)
