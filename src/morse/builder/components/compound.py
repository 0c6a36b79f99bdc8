"""A sensor that combines other sensors."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.creator import SensorCreator
from morse.builder.errors import checks

if TYPE_CHECKING:
    from morse.core.values import Options


class CompoundSensor(SensorCreator):
    """Several sensors combined; the component class is `morse.sensors.compound.CompoundSensor`."""

    _classpath = "morse.sensors.compound.CompoundSensor"

    def __init__(self, sensors: Iterable[Any], name: str | None = None) -> None:
        """Combine sensors.

        Args:
            sensors: the other sensors.
        """
        super().__init__(name)
        if not isinstance(sensors, Iterable):
            raise TypeError(f"CompoundSensor(sensors) takes a list of sensors, got {checks.shown(sensors)}")
        self.sensors = list(sensors)
        for sensor in self.sensors:
            if not isinstance(sensor, AbstractComponent):
                raise TypeError(f"CompoundSensor(sensors) takes a list of sensors; one item is {checks.shown(sensor)}")

    def _scene_options(self) -> Options:
        # the names of the other sensors are known only at this point
        self.properties(sensors=",".join(sensor.name for sensor in self.sensors))
        return super()._scene_options()
