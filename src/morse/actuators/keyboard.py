"""Drives a robot with the keyboard of the live view."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.limits import SPEED
from morse.core.services import service
from morse.core.wheeled_robot import PhysicsDifferentialRobot
from morse.helpers.components import add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: key to the axis it moves: index into (vx, vy, vz, roll, pitch, yaw), and direction
_KEYS = {
    "ArrowUp": (0, 1.0),
    "ArrowDown": (0, -1.0),
    "KeyU": (1, 1.0),
    "KeyO": (1, -1.0),
    "KeyT": (2, 1.0),
    "KeyG": (2, -1.0),
    "KeyL": (3, 1.0),
    "KeyJ": (3, -1.0),
    "KeyI": (4, 1.0),
    "KeyK": (4, -1.0),
    "ArrowLeft": (5, 1.0),
    "ArrowRight": (5, -1.0),
}


class Keyboard(Actuator):
    """Arrows drive and turn; T/G move up and down, U/O sideways, J/L roll, I/K pitch."""

    _name = "Keyboard Actuator"
    _short_desc = "Drives the robot by the keyboard of the live view"

    obeys_controls = True

    add_property(
        "_type",
        "Position",
        "ControlType",
        "string",
        "Position shifts the robot, Velocity sets its speed, Differential turns its wheels",
        choices=("Position", "Velocity", "Differential"),
    )
    add_property(
        "_speed", 1.0, "Speed", "float", "Linear speed in m/s; the turning rate in rad/s is half of it", **SPEED
    )

    add_state("_moving", bool, "Whether a key is pressed")

    _type: str
    _speed: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._moving = False

    @property
    def listening(self) -> bool:
        """Whether the keys control this robot: it is selected in the view, or no robot is selected."""
        return self.context.controls.robot in (None, self.robot_parent.name())

    @service(changes=False)
    def get_keys(self) -> dict[str, str]:
        """Return the keys and their functions."""
        names = ("forward", "left", "up", "roll", "pitch", "yaw")
        return {key: ("+" if sign > 0 else "-") + names[axis] for key, (axis, sign) in _KEYS.items()}

    def default_action(self) -> None:
        """Drive as commanded by the keys; the zero after the last release is sent only once."""
        keys = self.context.controls.keys if self.listening else frozenset()
        motion = [0.0] * 6
        is_pressed = False
        for key in keys:
            if key in _KEYS:
                axis, sign = _KEYS[key]
                motion[axis] += sign
                is_pressed = True
        if not is_pressed and not self._moving:
            return
        self._moving = is_pressed
        linear = [self._speed * value for value in motion[:3]]
        angular = [0.5 * self._speed * value for value in motion[3:]]
        if self._type == "Differential" and isinstance(self.robot_parent, PhysicsDifferentialRobot):
            self.robot_parent.apply_vw_wheels(linear[0], angular[2])
        else:
            self.robot_parent.apply_speed(self._type, linear, angular)
