"""The stream of a component on a link."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.core.exceptions import MorseMiddlewareError
from morse.core.kind_stream import KindStream
from morse.middleware.mavlink.mapping import STREAM_OPTIONS

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind
    from morse.middleware.mavlink.axes import Axes
    from morse.middleware.mavlink.vehicle import Vehicle

#: frames of positions for which MAVLink has no message
_ELSEWHERE = ("utm", "earth", "geocentric")


class MavlinkStream(KindStream):
    """Sends the messages of a component, or gives the component what arrives for its vehicle.

    Attributes:
        vehicle: of the robot; set before `initialize`.
    """

    options = STREAM_OPTIONS
    vehicle: Vehicle

    def initialize(self) -> None:
        """Find out what the component speaks.

        Raises:
            MorseMiddlewareError: MAVLink has no such coordinates, or north is elsewhere for the link.
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
        """How things in a frame of MORSE are turned."""
        known: Axes = self.manager.axes[frame if frame in ("ned", "enu") else "world"]
        return known

    def arrived(self, message: Any) -> None:
        """A message has arrived for the vehicle."""
        for bound in self.kinds:
            take = self.manager.mapping(bound.kind.name, "IN")
            slots: dict[str, Any] | None = take(self, bound, message)
            if slots:
                self.receive(bound, slots)

    def number(self, bound: BoundKind) -> int:
        """A number of the component among those of its vehicle, 0..255."""
        return self.vehicle.number_of(self.component_name) % 256
