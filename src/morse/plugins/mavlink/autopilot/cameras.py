"""The cameras of a vehicle, each of which is a component with an id of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import kinds
from morse.plugins.mavlink.autopilot.camera import Camera
from morse.plugins.mavlink.autopilot.photos import Photos

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.core.object import Object
    from morse.plugins.mavlink.autopilot.craft import Craft

#: MAV_COMP_ID_CAMERA and the five that follow
_FIRST, _MOST = 100, 6
#: commands for cameras that arrive at the autopilot go to the first camera, as with PX4
_FORWARDED = (203, 206, 521, 522, 525, 526, 527, 530, 2000, 2001)


class Cameras:
    """The cameras, and their photos."""

    def __init__(self, flight: Craft) -> None:
        self._flight = flight
        self.photos = Photos()
        self._cameras: dict[int, Camera] = {}
        self._sensors: list[Object] = []

    def look_at(self, components: Iterable[Object]) -> None:
        """Find the cameras among the components of the robot."""
        sensors = [one for one in components if _has_photos(one)][:_MOST]
        if sensors != self._sensors:
            self._sensors = sensors
            self._cameras = {
                number: Camera(number, sensor, self._flight, self.photos)
                for number, sensor in enumerate(sensors, _FIRST)
            }

    def is_for(self, component: int, command: int) -> bool:
        """Whether a command for a component is one for a camera."""
        return component in self._cameras or (command in _FORWARDED and bool(self._cameras))

    def obey(self, component: int, command: int, params: tuple[float, ...]) -> int:
        """Execute a command; MAV_RESULT."""
        camera = self._cameras.get(component) or next(iter(self._cameras.values()))
        return camera.obey(command, params)

    def beat(self) -> None:
        """Send the heartbeats of all cameras."""
        for camera in self._cameras.values():
            camera.beat()

    def tick(self, stamp: int) -> None:
        """The end of a tick, at a simulated time, ns."""
        for camera in self._cameras.values():
            camera.tick(stamp)


def _has_photos(component: object) -> bool:
    """Whether a component has colour images."""
    uses = kinds(type(component))
    return any(use.kind == "image" and use.slots.get("encoding") == "rgba8" for use in uses)
