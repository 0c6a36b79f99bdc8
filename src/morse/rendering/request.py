"""Requests of cameras to the renderer."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.rendering.lens import Lens
    from morse.rendering.motion import Motion
    from morse.rendering.renderer import Renderer
    from morse.scene import Node


class Placed(Protocol):
    """An object with a pose: an object of the world, or a `morse.rendering.viewpoint.Viewpoint`."""

    def world_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9, row by row) in the world."""


class Picture(NamedTuple):
    """An image of a camera; its arrays are not shared.

    Attributes:
        rgb: (H, W, 3) uint8, or None if it was not requested.
        depth: (H, W) float32, metres along the axis of the camera, 0 without a surface.
        ids: (H, W) int32, index in `nodes`, -1 without a surface.
        normals: (H, W, 3) float32, unit normals of the surfaces, towards the camera: X right, Y down, Z forward; 0
            without a surface; None if they were not requested.
        nodes: the nodes of the ids.
        models: (I, 12) float32, mesh to world of each node, 3x4 row by row; zeros for invisible nodes.
        eye: (3,) float32, position of the camera in the world frame.
        axes: (3, 3) float32, its right, down and forward axes, in rows.
    """

    rgb: NDArray[np.uint8] | None
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    normals: NDArray[np.float32] | None
    nodes: list[Node]
    models: NDArray[np.float32]
    eye: NDArray[np.float32]
    axes: NDArray[np.float32]


class CameraRequest:
    """A camera that looks along the Z axis of an object, with X to the right and Y down.

    Attributes:
        obj: the object.
        lens: may be replaced between images.
        color: whether the image has colours, not only depth and ids.
        normals: whether the image has normals.
        exposure: factor of the light.
        motion: when the rows are exposed; None for an image of the present instant.
        wanted: returns whether an image is requested now.
        picture: the last image; None before the first.
    """

    def __init__(
        self, server: Renderer, obj: Placed, lens: Lens, *, color: bool, normals: bool, wanted: Callable[[], bool]
    ) -> None:
        self.server = server
        self.obj, self.lens, self.color, self.normals, self.wanted = obj, lens, color, normals, wanted
        self.exposure = 1.0
        self.motion: Motion | None = None
        self.picture: Picture | None = None
