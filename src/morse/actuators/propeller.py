"""A propeller with its motor, as in multicopters."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.helpers import air
from morse.helpers.components import add_data, add_property, add_state
from morse.helpers.joint_motors import JointMotors
from morse.mathutils.rotations import turn, turn_back
from morse.scene import Control

if TYPE_CHECKING:
    from morse.core.limits import Limits
    from morse.core.robot import Robot
    from morse.core.world import Body

#: N and N m
_STRONGEST = 1e8
_SPEED: Limits = {"unit": "rad/s", "low": -1e5, "high": 1e5}


class Propeller(Actuator):
    """Turns a propeller about the Z axis of the component, on the link to which it is appended.

    With the speed w, the thrust is T = k w^2 along Z. The air turns the propeller back by the torque c T, and moving
    through the air sideways with the velocity u causes the force -d |w| u and the torque -m |w| u. The speed follows
    the command with a time constant, which may differ for faster and slower speeds.

    Source: F. Furrer, M. Burri, M. Achtelik and R. Siegwart, RotorS - A Modular Gazebo MAV Simulator Framework, in
    Robot Operating System (ROS), Springer, 2016, equations 1 to 6.
    """

    applies_forces = True
    _name = "Propeller"
    _short_desc = "Thrust and torque of a propeller at a commanded speed"

    add_data("speed", 0.0, "float", "Commanded speed", **_SPEED)
    add_property("_joint", "", "Joint", "string", "Joint that shows the rotation; empty for none")
    add_property(
        "_thrust", 8.5e-6, "MotorConstant", "float", "Thrust divided by the square of the speed, N s^2", low=0.0
    )
    add_property(
        "_moment", 0.016, "MomentConstant", "float", "Torque divided by the thrust", unit="m", low=0.0, high=100.0
    )
    add_property("_drag", 0.0, "RotorDrag", "float", "Sideways force divided by speed and velocity, N s^2/m", low=0.0)
    add_property("_rolling", 0.0, "RollingMoment", "float", "Torque divided by speed and velocity, N s^2", low=0.0)
    add_property("_direction", 1.0, "Direction", "float", "1: counter-clockwise seen from above, -1: clockwise")
    add_property("_up", 0.0125, "TimeConstantUp", "float", "Of faster speeds", unit="s", low=0.0, high=100.0)
    add_property("_down", 0.025, "TimeConstantDown", "float", "Of slower speeds", unit="s", low=0.0, high=100.0)
    add_property("_most", 1000.0, "MaxSpeed", "float", "Largest speed", unit="rad/s", low=0.0, high=1e5)
    add_property("_slowdown", 10.0, "Slowdown", "float", "Speed divided by that of the joint", low=1e-3, high=1e4)

    add_state("omega", float, "Speed", unit="rad/s")

    _joint: str
    _thrust: float
    _moment: float
    _drag: float
    _rolling: float
    _direction: float
    _up: float
    _down: float
    _most: float
    _slowdown: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.omega = 0.0
        self._motor: JointMotors | None = None
        if self._joint:
            self._motor = JointMotors(self.robot_parent.bge_object, (self._joint,), Control.VELOCITY)

    def default_action(self) -> None:
        """Turn the propeller, and apply its forces."""
        goal = min(max(self.local_data["speed"], -self._most), self._most)
        constant = self._up if abs(goal) > abs(self.omega) else self._down
        step = 1.0 / self.frequency
        self.omega = goal if constant <= 0.0 else goal + (self.omega - goal) * math.exp(-step / constant)
        if self._motor is not None:
            self._motor.tell((self._direction * self.omega / self._slowdown,))
        if not self.omega:
            return
        link = self.bge_object.parent or self.robot_parent.bge_object
        rotation = self.bge_object.world_pose()[1]
        speed = abs(self.omega)
        thrust = self._thrust * self.omega * speed
        lifting = thrust * air.thrust(self.context, self.robot_parent.bge_object)
        x, y, _ = turn_back(rotation, link.velocity()[0])
        drag, rolling = -self._drag * speed, -self._rolling * speed
        force = (_within(drag * x), _within(drag * y), _within(lifting))
        torque = (_within(rolling * x), _within(rolling * y), _within(-self._direction * self._moment * thrust))
        link.wrench(turn(rotation, force), turn(rotation, torque), False)


def _within(value: float) -> float:
    return min(max(value, -_STRONGEST), _STRONGEST)
