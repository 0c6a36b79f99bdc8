"""What a camera keeps of its images, so that a camera that stands renders less."""

from __future__ import annotations

from morse.kernel.drawing import Kept


class CameraMemory:
    """What is kept of the images of a camera: of each undistorted image, and each band of rows."""

    def __init__(self) -> None:
        self._kept: list[Kept] = []

    def of(self, first: int, count: int) -> list[Kept]:
        """Return what is kept of some of the undistorted images, from the number ``first``."""
        while len(self._kept) < first + count:
            self._kept.append(Kept())
        return self._kept[first : first + count]
