"""Requests of cameras to the renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from morse.rendering.camera_memory import CameraMemory

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.rendering.contents import Contents
    from morse.rendering.lens import Lens
    from morse.rendering.motion import Motion
    from morse.rendering.picture import Picture
    from morse.rendering.shot import Shot


#: bound of the error of simplified meshes in an image, pixels; meshes are not simplified
SCREEN_SPACE_ERROR = 0.0


class Placed(Protocol):
    """An object with a pose: an object of the world, or a `morse.rendering.viewpoint.Viewpoint`."""

    def world_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9, row by row) in the world."""


class Serving(Protocol):
    """What renders images: `morse.rendering.renderer.Renderer`."""

    @property
    def contents(self) -> Contents:
        """The present contents of the world."""

    def serve(self, requests: Sequence[CameraRequest]) -> None:
        """Render the requested images, or begin to."""


class CameraRequest:
    """A camera that looks along the Z axis of an object, with X to the right and Y down.

    Attributes:
        obj: the object.
        lens: may be replaced between images.
        color: whether the image has colours, not only depth and ids.
        normals: whether the image has normals.
        exposure: factor of the light.
        screen_space_error: bound of the error of simplified meshes in the image, pixels; 0 for full detail.
        motion: when the rows are exposed; None for an image of the present instant.
        wanted: returns whether an image is requested now.
        beside: whether images are rendered in a thread while the simulation goes on; `picture` waits for them.
        shot: the last image, which may still be rendered; None before the first.
        memory: what is kept of its images, so that the next ones take less time if the camera stands; None to render
            each image anew.
    """

    def __init__(
        self, server: Serving, obj: Placed, lens: Lens, *, color: bool, normals: bool, wanted: Callable[[], bool]
    ) -> None:
        self.server = server
        self.obj, self.lens, self.color, self.normals, self.wanted = obj, lens, color, normals, wanted
        self.exposure = 1.0
        self.screen_space_error = SCREEN_SPACE_ERROR
        self.motion: Motion | None = None
        self.beside = False
        self.shot: Shot | None = None
        self.memory: CameraMemory | None = CameraMemory()

    @property
    def picture(self) -> Picture | None:
        """The last image; None before the first."""
        return None if self.shot is None else self.shot.picture()
