"""Drives a robot with a gamepad at the live view."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import SPEED
from morse.helpers.components import add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: dead zone, because a released stick is not exactly centred
_DEAD_ZONE = 0.08


class Joystick(Actuator):
    """The first stick of the gamepad drives (forward, backward) and turns (left, right)."""

    _name = "Joystick Actuator"
    _short_desc = "Drives the robot by a gamepad at the live view"

    obeys_controls = True

    add_property(
        "_type",
        "Velocity",
        "ControlType",
        "string",
        "Velocity sets the speed, Position shifts the body each tick",
        choices=("Velocity", "Position"),
    )
    add_property("_speed", 1.0, "Speed", "float", "Speed at full deflection; turning rate in rad/s", **SPEED)
    add_property("_index", 0, "Index", "int", "Pair of axes: 0 for the first stick, 1 for the second", low=0)

    add_state("_moving", bool, "Whether the stick is deflected")

    _type: str
    _speed: float
    _index: int

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._moving = False

    def default_action(self) -> None:
        """Drive as commanded by the stick; the zero after its release is sent only once."""
        controls = self.context.controls
        axes = controls.axes if controls.robot in (None, self.robot_parent.name()) else ()
        first = 2 * self._index
        turn = ahead = 0.0
        if len(axes) > first + 1:
            turn, ahead = _beyond(-axes[first]), _beyond(-axes[first + 1])
        is_pushed = bool(turn or ahead)
        if not is_pushed and not self._moving:
            return
        self._moving = is_pushed
        self.robot_parent.apply_speed(self._type, (self._speed * ahead, 0.0, 0.0), (0.0, 0.0, self._speed * turn))


def _beyond(axis: float) -> float:
    """Return the deflection of an axis, -1 to 1, measured from the edge of the dead zone."""
    size = abs(axis)
    if size <= _DEAD_ZONE:
        return 0.0
    return (size - _DEAD_ZONE) / (1.0 - _DEAD_ZONE) * (1.0 if axis > 0.0 else -1.0)
