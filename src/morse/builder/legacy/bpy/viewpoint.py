"""The camera of the view, which scripts of 1.4 know as the object ``CameraFP``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.blender.pose import LiveEuler, LiveVector
from morse.builder.errors import checks
from morse.builder.legacy.ignored import Facade

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import ViewSettings

NAME = "CameraFP"


def _view() -> ViewSettings:
    return workspace.current().settings.view


class _Place(LiveVector):
    """The position of the camera; assigning items moves it."""

    def __setitem__(self, index: object, value: object) -> None:
        super().__setitem__(index, value)
        x, y, z = self
        _view().camera_location = (x, y, z)


class _Turn(LiveEuler):
    """The angles of the camera; assigning items turns it."""

    def __setitem__(self, index: object, value: object) -> None:
        super().__setitem__(index, value)
        x, y, z = self
        _view().camera_rotation = (x, y, z)


class Viewpoint(Facade):
    """The camera of the live view under the names of an object of Blender."""

    _path = NAME
    name = NAME
    type = "CAMERA"

    @property
    def data(self) -> Lens:
        """Its lens."""
        return Lens()

    @property
    def location(self) -> LiveVector:
        """Position in the world, m."""
        return _Place(list(_view().camera_location), "location")

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        _view().camera_location = checks.triple(value, "location")

    @property
    def rotation_euler(self) -> LiveEuler:
        """Euler angles, rad, XYZ order."""
        return _Turn(list(_view().camera_rotation), "rotation_euler")

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        _view().camera_rotation = checks.triple(value, "rotation_euler")


class Lens(Facade):
    """The lens of the view."""

    _path = f"{NAME}.data"
    name = NAME

    @property
    def clip_start(self) -> float:
        """Distance of the near plane, m."""
        return _view().camera_clip[0]

    @clip_start.setter
    def clip_start(self, value: object) -> None:
        _view().camera_clip = (checks.number(value, "clip_start", above=0.0), self.clip_end)

    @property
    def clip_end(self) -> float:
        """Distance of the far plane, m."""
        return _view().camera_clip[1]

    @clip_end.setter
    def clip_end(self, value: object) -> None:
        _view().camera_clip = (self.clip_start, checks.number(value, "clip_end", above=0.0))

    @property
    def lens(self) -> float:
        """Focal length, mm, for a sensor 32 mm wide."""
        return _view().camera_focal_length

    @lens.setter
    def lens(self, value: object) -> None:
        _view().camera_focal_length = checks.number(value, "lens", above=0.0)
