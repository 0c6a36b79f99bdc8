"""Contact sensors."""

from __future__ import annotations

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.core.streams.functions import publish
from morse.core.streams.kind_stream import KindStream
from morse.helpers.components import add_data, add_kind, add_property, add_state


def touched_names(sensor: ContactSensor) -> list[str]:
    """The names in the field ``objects``."""
    return [name for name in sensor.local_data["objects"].split(",") if name]


class ContactSensor(Sensor):
    """A sensor that detects which objects touch its body.

    The body is a cuboid whose half sizes are the ``scale`` of the sensor. It belongs to the robot and does not collide.
    """

    add_data("collision", False, "bool", "Whether it touches an object")
    add_data("objects", "", "string", "Names of the touched objects, joined by commas", follows="collision")
    add_property(
        "_only_objects_with_property",
        "",
        "only_objects_with_property",
        "string",
        "Detect only objects with this property; empty for all objects",
    )

    _only_objects_with_property: str
    #: distance below which objects touch, m
    margin = 1e-3

    def touched(self) -> list[str]:
        """The names of the objects that touch it now."""
        prop = self._only_objects_with_property
        objects = self.context.world.touched_by(self.bge_object, self.margin)
        return [obj.name for obj in objects if not prop or prop in obj.properties]

    def take(self, names: list[str]) -> None:
        """Fill the data with the touched objects."""
        self.local_data["collision"] = bool(names)
        self.local_data["objects"] = ",".join(names)


class Collision(ContactSensor):
    """Reports the objects that touch its body, while there are any.

    It does not publish while it does not touch an object; middlewares with message kinds get one message when the
    contact ends. Unless the script sets a scale, its body is a cube of 4 cm.
    """

    _name = "Collision"
    _short_desc = "A sensor that reports which objects touch it, while there are any"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.02, 0.02), (0.8, 0.2, 0.1)))

    add_kind("contact", touching="collision", names=touched_names)

    add_state("_names", list, "Names of the objects that touch it")

    def action(self) -> None:
        """Do one measurement, if it touches an object."""
        if not self._active:
            return
        self._names = self.touched()
        if self._names:
            super().action()
            return
        was_touching = self.local_data["collision"]
        self.take([])
        if was_touching:
            self._tell_the_end()

    def _tell_the_end(self) -> None:
        """Send one message to middlewares with message kinds when a contact has ended."""
        self.local_data["timestamp"] = self.clock.time
        streams = [one for one in self.output_functions if _sends_kinds(getattr(one, "__self__", None))]
        publish(self, streams)

    def measure(self) -> None:
        """Measure the touched objects."""
        self.take(self._names)


def _sends_kinds(stream: object) -> bool:
    return isinstance(stream, KindStream) and stream.sends_kinds
