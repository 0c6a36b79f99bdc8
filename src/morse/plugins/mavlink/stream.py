"""The stream of a component on a link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.exceptions import MorseMiddlewareError
from morse.core.streams.kind_stream import KindStream
from morse.plugins.mavlink import STREAM_OPTIONS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.kinds import BoundKind
    from morse.plugins.mavlink.axes import Axes
    from morse.plugins.mavlink.vehicle import Vehicle

#: frames of positions without a MAVLink message
_ELSEWHERE = ("utm", "earth", "geocentric")


class MavlinkStream(KindStream):
    """Sends the messages of a component, or passes the messages for its vehicle to the component.

    Attributes:
        vehicle: the vehicle of the robot; set before `initialize`.
        axes: conversions of the frames ``world``, ``nwu``, ``enu`` and ``ned``; set before `initialize`.
        other_north: why components that find north do not fit to the link, for messages; empty if they do.
    """

    options = STREAM_OPTIONS
    vehicle: Vehicle
    axes: Mapping[str, Axes]
    other_north: str

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
            if bound.kind.name in ("fix", "magnetic_field") and self.other_north:
                raise MorseMiddlewareError(f"mavlink: {self.component_name} {self.other_north}")

    def axes_of(self, frame: str) -> Axes:
        """The conversion for a frame of MORSE."""
        return self.axes[frame if frame in ("ned", "enu") else "world"]

    def number(self, bound: BoundKind) -> int:
        """The id of the component on its vehicle, 0..255."""
        return self.vehicle.number_of(self.component_name) % 256
