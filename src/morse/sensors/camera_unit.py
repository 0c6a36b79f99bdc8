"""What carries cameras."""

from __future__ import annotations

from morse.core.sensor import Sensor
from morse.core.services import async_service, interruptible
from morse.core.status import SUCCESS
from morse.sensors.camera import Camera, Pictures


class CameraUnit(Sensor):
    """Carries cameras, and lets all of them take pictures at once."""

    def cameras(self) -> list[Camera]:
        """The cameras that it carries."""
        inside = f"{self.name()}."
        found = (c for name, c in self.context.components.items() if name.startswith(inside))
        return [camera for camera in found if isinstance(camera, Camera)]

    @interruptible
    @async_service
    def capture(self, n: Pictures) -> None:
        """Let all cameras take pictures; ends when the last one is taken.

        Args:
            n: how many each; a negative number for pictures without end.
        """
        for camera in self.cameras():
            camera.start(int(n))

    def interrupt(self) -> None:
        """End `capture`."""
        for camera in self.cameras():
            camera.start(0)
        super().interrupt()

    def measure(self) -> None:
        """See whether all pictures were taken."""
        if self.running_service == "capture" and not any(camera.capturing for camera in self.cameras()):
            self.completed(SUCCESS)
