"""The stream of a component on a link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.core.streams.kind_stream import KindStream
from morse.middleware.mavlink.mapping import STREAM_OPTIONS

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.middleware.mavlink.axes import Axes
    from morse.middleware.mavlink.datastream import MavlinkDatastreamManager
    from morse.middleware.mavlink.vehicle import Vehicle

#: frames of positions without a MAVLink message
_ELSEWHERE = ("utm", "earth", "geocentric")


class MavlinkStream(KindStream):
    """Sends the messages of a component, or passes the messages for its vehicle to the component.

    Attributes:
        vehicle: the vehicle of the robot; set before `initialize`.
    """

    options = STREAM_OPTIONS
    manager: MavlinkDatastreamManager
    vehicle: Vehicle

    def initialize(self) -> None:
        """Determine the message kinds of the component.

        Raises:
            MorseMiddlewareError: MAVLink has no such coordinates, or the link has another direction of north.
        """
        super().initialize()
        for bound in self.kinds:
            if bound.frame in _ELSEWHERE:
                raise MorseMiddlewareError(
                    f"mavlink: {self.component_name} is in the frame '{bound.frame}', for which MAVLink has no message"
                )
            if bound.kind.name in ("fix", "magnetic_field"):
                self.manager.check_north(self)

    def axes_of(self, frame: str) -> Axes:
        """The conversion for a frame of MORSE."""
        known: Axes = self.manager.axes[frame if frame in ("ned", "enu") else "world"]
        return known

    def number(self, bound: BoundKind) -> int:
        """The id of the component on its vehicle, 0..255."""
        return self.vehicle.number_of(self.component_name) % 256
