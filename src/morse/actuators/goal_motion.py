"""The base class of actuators that drive to a goal position."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.limits import POSITION
from morse.helpers.components import add_data, add_property, add_state

if TYPE_CHECKING:
    from morse.core.object import Object
    from morse.core.robot import Robot
    from morse.core.world import Body

ARRIVED, TRANSIT, STOP = "Arrived", "Transit", "Stop"


def marker(component: Object, name: str) -> Any:
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
