"""The states of doors, gates and lifts, for middlewares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind
from morse.plugins.facilities.robots.door import Opening
from morse.plugins.facilities.robots.lift import Lift

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

_DOORS = {"closed": 0, "moving": 1, "open": 2}


class DoorState(Sensor):
    """Publishes the state of the door or gate on which it is mounted; with ROS 2, as ``rmf_door_msgs/DoorState``."""

    _name = "DoorState"
    _short_desc = "The state of a door or a gate, as messages"
    _builder = BuilderDefaults(frequency=10.0)

    add_data("door_name", "", "string", "Name of the door")
    add_data("current_mode", 0, "int", "0 closed, 1 moving, 2 open", low=0, high=2)
    add_kind("door_state", door_name="door_name", current_mode="current_mode")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._door = parent if isinstance(parent, Opening) else None
        if self._door is None:
            text = f"{self.name()} is mounted on a door or a gate: door.append(DoorState()); it does nothing here"
            self.context.complaints.warn(text, text)
        else:
            self.local_data["door_name"] = self._door.name()

    def measure(self) -> None:
        """Read the state of the door."""
        if self._door is not None:
            self.local_data["current_mode"] = _DOORS[self._door.local_data["state"]]


class LiftState(Sensor):
    """Publishes the state of the lift on which it is mounted; with ROS 2, as ``rmf_lift_msgs/LiftState``."""

    _name = "LiftState"
    _short_desc = "The state of a lift, as messages"
    _builder = BuilderDefaults(frequency=10.0)

    add_data("lift_name", "", "string", "Name of the lift")
    add_data("available_floors", [], "list", "Names of the floors: their numbers")
    add_data("current_floor", "0", "string", "The floor where it is, or that it has passed last")
    add_data("destination_floor", "0", "string", "The floor to which it goes")
    add_data("door_state", 0, "int", "0 closed, 1 moving, 2 open", low=0, high=2)
    add_data("motion_state", 0, "int", "0 stopped, 1 up, 2 down", low=0, high=2)
    add_kind(
        "lift_state",
        lift_name="lift_name",
        available_floors="available_floors",
        current_floor="current_floor",
        destination_floor="destination_floor",
        door_state="door_state",
        motion_state="motion_state",
    )

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._lift = parent if isinstance(parent, Lift) else None
        if self._lift is None:
            text = f"{self.name()} is mounted on a lift: lift.append(LiftState()); it does nothing here"
            self.context.complaints.warn(text, text)
        else:
            self.local_data["lift_name"] = self._lift.name()
            self.local_data["available_floors"] = [str(number) for number in range(len(self._lift.levels))]

    def measure(self) -> None:
        """Read the state of the lift."""
        if self._lift is None:
            return
        data, lift = self.local_data, self._lift.local_data
        data["current_floor"], data["destination_floor"] = str(lift["level"]), str(lift["destination"])
        data["door_state"] = 0 if lift["openness"] == 0.0 else 2 if lift["openness"] == 1.0 else 1
        data["motion_state"] = 0 if lift["speed"] == 0.0 else 1 if lift["speed"] > 0.0 else 2
