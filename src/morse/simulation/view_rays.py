"""Shows pages what sensors see along their rays."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.sensor import Sensor
from morse.physics.rays import RayBundle
from morse.viewer.view_messages import Rays

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.viewer.server import ViewServer

#: of more rays, every second, third, ... is shown: 28 bytes each, ten times a second
_MOST_SHOWN = 4000


class ViewRays:
    """Sends the rays of the sensors that pages look at, and of those whose arc is to be visible."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._sent: dict[str, int] = {}
        self._sensors: list[Sensor] = []
        self.restarted()

    def restarted(self) -> None:
        """The components are new ones."""
        self._sensors = [
            c for c in self._context.components.values() if isinstance(c, Sensor) and isinstance(c.rays, RayBundle)
        ]

    def update(self) -> None:
        """Send what has been cast since the last call."""
        wished = self._server.wishes.overlays
        for sensor in self._sensors:
            name = sensor.name()
            if name not in wished and not getattr(sensor, "visible_arc", False):
                self._sent.pop(name, None)
            elif sensor.rays.stamp >= 0 and self._sent.get(name) != sensor.rays.stamp:
                self._sent[name] = sensor.rays.stamp
                segments = sensor.rays.segments()
                step = -(-len(segments) // _MOST_SHOWN)
                self._server.send(Rays(segments[:: max(step, 1)].tobytes(), name))
