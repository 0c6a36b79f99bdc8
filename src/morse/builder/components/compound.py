"""A sensor that is made of others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.creator import SensorCreator
from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable


class CompoundSensor(SensorCreator):
    """Several sensors as one; `morse.sensors.compound.CompoundSensor` runs."""

    _classpath = "morse.sensors.compound.CompoundSensor"

    def __init__(self, sensors: Iterable[Any], name: str | None = None) -> None:
        """Make a sensor of others.

        Args:
            sensors: the other sensors.
        """
        super().__init__(name)
        self.sensors = list(sensors)
        for sensor in self.sensors:
            if not isinstance(sensor, AbstractComponent):
                raise TypeError(f"CompoundSensor(sensors) takes a list of sensors, got {checks.shown(sensor)} in it")

    def _scene_options(self) -> dict[str, object]:
        # the names of the others are known now
        self.properties(sensors=",".join(sensor.name for sensor in self.sensors))
        return super()._scene_options()
