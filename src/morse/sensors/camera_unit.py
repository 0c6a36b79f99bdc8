"""The base class of sensors that carry cameras."""

from __future__ import annotations

from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible
from morse.core.status import SUCCESS
from morse.sensors.camera import Camera, Pictures


class CameraUnit(Sensor):
    """Carries cameras that capture images simultaneously.

    Attributes:
        moves_parts: whether the components on it may move.
    """

    moves_parts = False

    def cameras(self) -> list[Camera]:
        """The cameras mounted on it."""
        inside = f"{self.name()}."
        components = (c for name, c in self.context.components.items() if name.startswith(inside))
        return [camera for camera in components if isinstance(camera, Camera)]

    @interruptible
    @async_service
    def capture(self, n: Pictures) -> None:
        """Capture images with all cameras; the service ends when the last image has been captured.

        Args:
            n: number of images per camera; a negative number for no limit.
        """
        for camera in self.cameras():
            camera.start(int(n))

    def interrupt(self) -> None:
        """End `capture`."""
        for camera in self.cameras():
            camera.start(0)
        super().interrupt()

    def measure(self) -> None:
        """Check whether all images were captured."""
        if self.running_service == "capture" and not any(camera.capturing for camera in self.cameras()):
            self.completed(SUCCESS)
