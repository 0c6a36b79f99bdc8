"""Current and temperature of a motor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_property, add_state

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body

#: temperature coefficient of the resistance of copper, 1/K, at 20 °C (IEC 60028)
_COPPER, _REFERENCE = 0.00393, 20.0
_AXES = {"x": 0, "y": 1, "z": 2}


class MotorSensor(Sensor):
    """Measures the current and the temperature of the motor of the joint that carries its link.

    ``robot.append(sensor, "link")``. The current is the torque of the joint about the axis, divided by the torque
    constant and the ratio of the gear: τ / (k_t N). The losses I² R heat the winding, whose resistance is that of
    copper at its temperature: dT/dt = (I² R(T) - (T - T_a) / R_th) / C_th, with one thermal resistance R_th and
    capacity C_th.
    """

    _name = "Motor sensor"
    _short_desc = "Current and temperature of the motor of a joint"
    _source = "one-body thermal model of an electric motor; copper: IEC 60028"
    _builder = BuilderDefaults(frequency=60.0)

    add_data("current", 0.0, "float", "Of the motor", unit="A")
    add_data("temperature", 25.0, "float", "Of the winding", unit="°C")
    add_property("axis", "z", "axis", "string", "Axis of the joint in the frame of the sensor", choices=("x", "y", "z"))
    add_property("torque_constant", 0.05, "torque_constant", "float", "k_t", unit="N·m/A", low=1e-4, high=100.0)
    add_property("gear", 100.0, "gear", "float", "N, turns of the motor for a turn of the joint", low=0.01, high=1e4)
    add_property("resistance", 0.5, "resistance", "float", "R of the winding at 20 °C", unit="Ω", low=1e-4, high=1e4)
    add_property("thermal_resistance", 3.0, "thermal_resistance", "float", "R_th", unit="K/W", low=1e-3, high=1e3)
    add_property("thermal_capacity", 20.0, "thermal_capacity", "float", "C_th", unit="J/K", low=1e-2, high=1e6)
    add_property("ambient", 25.0, "ambient", "float", "Temperature of the air", unit="°C", low=-60.0, high=100.0)

    add_state("_heat", float | None, "Temperature of the winding", unit="°C")
    add_state("_time", float, "Time of the last measurement", unit="s")

    #: the physics gives its link a body of its own
    measures_joint = True
    axis: str
    torque_constant: float
    gear: float
    resistance: float
    thermal_resistance: float
    thermal_capacity: float
    ambient: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._heat: float | None = None
        self._time = self.clock.time

    def measure(self) -> None:
        """Measure current and temperature."""
        position, rotation = self.bge_object.world_pose()
        _, torque = self.context.world.joint_moment([self.bge_object]).load(self.bge_object, position)
        column = _AXES[self.axis]
        about = sum(rotation[3 * row + column] * torque[row] for row in range(3))
        current = about / (self.torque_constant * self.gear)
        now = self.clock.time
        self._heat = self.heated(self.ambient if self._heat is None else self._heat, current, now - self._time)
        self._time = now
        self.local_data["current"], self.local_data["temperature"] = current, self._heat

    def heated(self, temperature: float, current: float, seconds: float) -> float:
        """Return the temperature (°C) after some time (s) with a current (A)."""
        loss = current * current * self.resistance
        # the loss rises with the temperature: an implicit step is stable for all lengths
        rise = loss * _COPPER
        numerator = temperature + seconds / self.thermal_capacity * (
            loss * (1.0 - _COPPER * _REFERENCE) + self.ambient / self.thermal_resistance
        )
        denominator = 1.0 + seconds / self.thermal_capacity * (1.0 / self.thermal_resistance - rise)
        # beyond a current at which no temperature is stable, the winding burns
        return min(numerator / denominator, 1000.0) if denominator > 0.0 else 1000.0
