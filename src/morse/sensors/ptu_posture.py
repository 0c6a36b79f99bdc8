"""Angles of a pan-tilt unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_kind

if TYPE_CHECKING:
    from morse.core.robot import Robot
    from morse.core.world import Body


class PTUPosture(Sensor):
    """Measures the angles of the pan-tilt unit to which it is appended: ``ptu.append(posture)``."""

    _name = "PTU posture"
    _short_desc = "A sensor returning the angles of a pan-tilt unit"
    _builder = BuilderDefaults()

    add_data("pan", 0.0, "float", "Angle about the Z axis, positive to the left", unit="rad", frame="joint", angle=True)
    add_data("tilt", 0.0, "float", "Angle about the Y axis, positive downward", unit="rad", frame="joint", angle=True)
    add_kind("joints", names=("pan", "tilt"), position=("pan", "tilt"))

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        actuators = {component.name for component in self.context.scene.components if component.kind == "actuator"}
        holder = obj.parent
        while holder is not None and holder.name not in actuators:
            holder = holder.parent
        if holder is None:
            raise ValueError("it measures a pan-tilt unit: append it to a pan-tilt unit, as in 'ptu.append(posture)'")
        self._unit: str = holder.name

    def measure(self) -> None:
        """Measure the angles."""
        unit = self.context.components[self._unit]
        self.local_data["pan"], self.local_data["tilt"] = unit.pan, unit.tilt  # type: ignore[attr-defined]
