"""Several sensors combined."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults
from morse.core.exceptions import MorseRPCTypeError
from morse.core.reports.quoting import nearest, shown
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_property

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.object import Object


class CompoundSensor(Sensor):
    """Publishes the data of other sensors in one message: the full name of each sensor to its data.

    Middlewares that carry message kinds get the messages of each sensor, on a sub-topic of its name.

    The data are those of the last measurement of each sensor, without its delay.
    """

    _name = "Compound sensor"
    _short_desc = "A sensor that publishes the data of several other sensors in one message"
    _builder = BuilderDefaults()

    add_property("_sensors", "", "sensors", "string", "Full names of the sensors, joined by commas")

    _sensors: str

    @property
    def kind_members(self) -> Mapping[str, Object]:
        """Return the sensors by name, or by full name if several sensors have the same name."""
        names = _names(self._sensors)
        short = [name.rpartition(".")[2] for name in names]
        return {
            own if short.count(own) == 1 else name.replace(".", "_"): self.context.components[name]
            for name, own in zip(names, short, strict=True)
            if name in self.context.components
        }

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        before = self._sensors
        super().set_property(name, value)
        components = self.context.components
        for member in _names(self._sensors):
            if member == self.name() or member not in components:
                self._sensors = before
                raise MorseRPCTypeError(
                    f"{self.name()}: there is no other sensor {shown(member)}{nearest(member, components)}"
                )
        for name_before in set(_names(before)) - set(_names(self._sensors)):
            self.local_data.pop(name_before, None)

    def measure(self) -> None:
        """Copy the data of all sensors."""
        components, data = self.context.components, self.local_data
        for name in _names(self._sensors):
            member = components.get(name)
            if member is None:  # the sensor was deleted
                data.pop(name, None)
            else:
                data[name] = dict(member.local_data.items())


def _names(sensors: str) -> list[str]:
    return [name for name in map(str.strip, sensors.split(",")) if name]
