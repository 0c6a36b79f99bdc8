"""The base class of sensors."""

from __future__ import annotations

from typing import Any

from morse.core.declarations import add_data
from morse.core.object import Object
from morse.core.services import service


class Sensor(Object):
    """Measures something and publishes it: fill ``local_data`` in ``default_action``."""

    add_data("timestamp", 0.0, "float", "Simulated time of the measurement", unit="s")

    @service
    def get_local_data(self) -> dict[str, Any]:
        """The present data of the sensor."""
        return self.local_data

    def sensor_setup(self) -> None:
        """Take the pose and the time of a measurement."""
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time

    def action(self) -> None:
        """One measurement: pose, time, `default_action`, modifiers, streams."""
        if not self._active:
            return
        self.position_3d.update(self.bge_object)
        self.local_data["timestamp"] = self.clock.time
        self.default_action()
        for modifier in self.output_modifiers:
            modifier.modify()
        for publish in self.output_functions:
            publish(self)
