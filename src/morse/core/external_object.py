"""Components whose data come from outside the simulation, under the names of MORSE 1.4.

In a hybrid simulation, a real device measures or acts: its data arrive on a stream, and clients read them
from the simulation like those of a simulated device.
"""

from __future__ import annotations

from morse.core.actuator import Actuator
from morse.core.guard import modify
from morse.core.sensor import Sensor
from morse.core.streams.functions import publish


class ExternalObject(Actuator):
    """A component that both reads and publishes its data.

    A script adds one stream for each direction: ``device.add_stream('socket', direction='IN')`` and
    ``direction='OUT'``. Its modifiers may have a direction as well: ``device.alter('NED', direction='IN')``.
    """

    def action(self) -> None:
        """One tick: pose, streams that are read, `default_action`, modifiers, streams that are sent."""
        if not self._active:
            return
        super().action()
        if self._active:
            self.send_output()

    def send_output(self) -> None:
        """Apply the modifiers of the output, and publish ``local_data``."""
        if modify(self, self.output_modifiers):
            publish(self, self.output_functions)


class ExternalSensor(ExternalObject, Sensor):
    """A sensor outside the simulation. ``timestamp`` is the simulated time at which its data are published."""

    def action(self) -> None:
        """One tick; delay and noise that the script declares change the data that have arrived."""
        if self._active and self.realism is not None:
            self.realism.act()
        else:
            super().action()

    def sensor_setup(self) -> None:
        """Take the data that have arrived, as a measurement with delay and noise."""
        super().sensor_setup()
        self.take_input()

    def send_output(self) -> None:
        """Set ``timestamp``, compute the fields that depend on others, apply the modifiers, and publish."""
        self.local_data["timestamp"] = self.clock.time
        self.report()
        super().send_output()


class ExternalActuator(ExternalObject):
    """An actuator outside the simulation: it publishes the commands that it gets."""
