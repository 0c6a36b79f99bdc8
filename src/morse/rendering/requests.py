"""What cameras request, and what the images of a tick show, independent of later changes of cameras and world."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from morse.kernel.drawing.arrays import CAMERA
from morse.kernel.drawing.native import Kept
from morse.mathutils.portable import matmul
from morse.rendering.distortion import DistortedLens, Drawn
from morse.rendering.lens import moved

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Pictures
    from morse.rendering.contents import Contents
    from morse.rendering.lens import Lens, Motion
    from morse.rendering.picture import Picture, Shot


# What a camera keeps of its images, so that a camera that stands renders less.


class CameraMemory:
    """What is kept of the images of a camera: of each undistorted image, and each band of rows."""

    def __init__(self) -> None:
        self._kept: list[Kept] = []

    def of(self, first: int, count: int) -> list[Kept]:
        """Return what is kept of some of the undistorted images, from the number ``first``."""
        while len(self._kept) < first + count:
            self._kept.append(Kept())
        return self._kept[first : first + count]


# Requests of cameras to the renderer.

#: bound of the error of simplified meshes in an image, pixels; meshes are not simplified
SCREEN_SPACE_ERROR = 0.0


class Placed(Protocol):
    """An object with a pose: an object of the world, or a `morse.rendering.renderer.Viewpoint`."""

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


# What the images of a tick show, independent of later changes of cameras and world.


class Order(NamedTuple):
    """An image to be rendered.

    Attributes:
        lens, color, normals, exposure, screen_space_error, motion: see `CameraRequest`.
        position: (3,) m, of the camera.
        rotation: (3, 3) camera to world.
        velocity: (1, 3) m/s and (1, 3) rad/s, world axes; None if the image shows one instant only.
        memory: of the camera; None to render each image anew.
        band: number of the band of rows.
    """

    lens: Lens
    color: bool
    normals: bool
    exposure: float
    screen_space_error: float
    motion: Motion | None
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]
    velocity: tuple[NDArray[np.float64], NDArray[np.float64]] | None
    memory: CameraMemory | None = None
    band: int = 0

    def pose(self, time: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return position (3,) and rotation (3, 3) at a time relative to the tick, s, at constant velocity."""
        if not time or self.velocity is None:
            return self.position, self.rotation
        places, turns = moved(self.position[None], self.rotation[None], *self.velocity, time)
        return places[0], turns[0]


def order_of(request: CameraRequest) -> Order:
    """Return the image that a camera requests at its present pose; what it keeps is in ``request.memory``."""
    position, rotation = request.obj.world_pose()
    return Order(
        request.lens,
        request.color,
        request.normals,
        request.exposure,
        request.screen_space_error,
        request.motion,
        np.array(position, np.float64),
        np.reshape(np.array(rotation, np.float64), (3, 3)),
        None if request.motion is None else _velocity(request.obj),
        request.memory,
    )


def _velocity(obj: Placed) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    velocity = getattr(obj, "velocity", None)
    if velocity is None:
        return None
    linear, angular = (np.nan_to_num(np.array([part], np.float64)) for part in velocity())
    return linear, angular


class View(NamedTuple):
    """An undistorted image for an order.

    Attributes:
        lens: its lens.
        turn: (3, 3) its axes in the frame of the camera, in columns.
    """

    lens: Lens
    turn: NDArray[np.float64]


_STRAIGHT = np.eye(3)


def views_of(order: Order) -> list[View]:
    """Return the undistorted images from which the image of an order is sampled."""
    lens = order.lens
    if isinstance(lens, DistortedLens):
        return [View(flat.lens, flat.turn) for flat in lens.warp.flats]
    return [View(lens, _STRAIGHT)]


def pixels_of(order: Order) -> int:
    """Return the number of pixels of the undistorted images of an order."""
    return sum(view.lens.width * view.lens.height for view in views_of(order))


def cameras_of(orders: Sequence[Order], time: float) -> np.ndarray:
    """Return the undistorted images of orders, (K,) `CAMERA`, at a time relative to the tick."""
    views = [(order, view) for order in orders for view in views_of(order)]
    cameras = np.zeros(len(views), CAMERA)
    for number, (order, view) in enumerate(views):
        position, rotation = order.pose(time)
        lens = view.lens
        # the rotations of undistorted images permute axes, so that these products are exact
        axes = matmul(rotation, view.turn).T.ravel()
        # one assignment takes a fraction of the time of one for each field
        cameras[number] = (
            *(lens.fx, lens.fy, lens.cx, lens.cy, lens.near, lens.far, axes, position, order.exposure),
            order.screen_space_error / _magnification(lens),
            *(lens.width, lens.height, 0, order.color, order.normals, 0, 0.0),
        )
    return cameras


def _magnification(lens: Lens) -> float:
    """The largest shift in an undistorted image, pixels, for a shift of a point by its depth."""
    # a point at x = X / Z that moves by (dX, dZ) shifts by (dX - x dZ) / Z
    x, y = (
        max(at, size - at) / focal
        for at, size, focal in ((lens.cx, lens.width, lens.fx), (lens.cy, lens.height, lens.fy))
    )
    return max(lens.fx, lens.fy) * math.sqrt(1.0 + x * x + y * y)


def kept_of(orders: Sequence[Order]) -> list[Kept | None]:
    """Return what is kept of the undistorted images of orders."""
    images: list[Kept | None] = []
    for order in orders:
        count = len(views_of(order))
        images += [None] * count if order.memory is None else order.memory.of(order.band * count, count)
    return images


def cut(pictures: Pictures, row: Any) -> Drawn:
    """Return one of the rendered images."""
    shape, first = (int(row["height"]), int(row["width"])), int(row["pixel"])
    part = slice(first, first + shape[0] * shape[1])
    return Drawn(
        pictures.rgba[part].reshape(*shape, 4) if row["color"] else None,
        pictures.depth[part].reshape(shape),
        pictures.ids[part].reshape(shape),
        pictures.normals[part].reshape(*shape, 3) if row["normals"] else None,
    )
