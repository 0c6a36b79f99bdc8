"""The shadows of a spot lamp: a depth image from the lamp."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import CAMERA, NO_SURFACE, Light, Poses, bounds_for
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from typing import Protocol

    from numpy.typing import NDArray

    from morse.kernel.drawing import Pictures
    from morse.rendering.lights import Spot

    class Drawer(Protocol):
        """Renders images; see `morse.kernel.drawing`."""

        def draw(self, cameras: NDArray[np.void], poses: Poses, light: Light, samples: int) -> Pictures:
            """The images of cameras."""

        def bound_shadows(self, light: Light) -> None:
            """Set the bounds of the map."""


#: texels along a side, and texels outside the cone on each side
_SIZE, _BORDER = 512, 4
#: m: surfaces that are nearer, such as the housing of the lamp, and surfaces that are farther cast no shadow
_NEAR, _FAR = 0.2, 200.0


class SpotShadows:
    """The shadow map of a spot lamp; it is rendered again if the lamp or a surface has moved."""

    def __init__(self) -> None:
        self._of: tuple[Spot, NDArray[np.float32]] | None = None
        self._frame = self._map = np.zeros(0, np.float32)
        self._bounds: NDArray[np.float32] | None = None

    def update(self, light: Light, spot: Spot | None, poses: Poses, drawer: Drawer) -> Light:
        """Return the lamps with the shadows of the spot lamp at the present poses."""
        if spot is None or not np.isfinite((*spot.position, *spot.rotation)).all():
            return light._replace(lamp_frame=None, lamp_shadow=None, lamp_bounds=None)
        if self._of is None or self._of[0] != spot or not np.array_equal(self._of[1], poses.models):
            self._render(light, spot, poses, drawer)
            self._of = spot, poses.models
        return light._replace(lamp_frame=self._frame, lamp_shadow=self._map, lamp_bounds=self._bounds)

    def _render(self, light: Light, spot: Spot, poses: Poses, drawer: Drawer) -> None:
        # its axes: right, down, and forward, which is -Z
        axes = np.reshape(spot.rotation, (3, 3)).T * np.array([[1.0], [-1.0], [-1.0]])
        focal = (_SIZE / 2 - _BORDER) / math.tan(spot.angle)
        camera = np.zeros(1, CAMERA)
        camera["fx"] = camera["fy"] = focal
        camera["cx"] = camera["cy"] = _SIZE / 2
        camera["width"] = camera["height"] = _SIZE
        camera["near"], camera["far"] = _NEAR, _FAR
        camera["axes"], camera["eye"], camera["exposure"] = axes.ravel(), spot.position, 1.0
        depth = drawer.draw(camera, poses, light, 1).depth.reshape(_SIZE, _SIZE)
        self._map = np.where(depth > 0.0, -depth, np.float32(NO_SURFACE)).astype(np.float32)
        self._bounds = bounds_for(self._map)
        drawer.bound_shadows(light._replace(shadow=self._map, shadow_bounds=self._bounds))
        matrix = matmul(np.array([[focal, 0, _SIZE / 2], [0, focal, _SIZE / 2], [0, 0, 1]]), axes)
        frame = np.zeros(16)
        frame[:12] = np.column_stack([matrix, matmul(-matrix, np.array(spot.position))]).ravel()
        frame[12] = 1 / focal
        self._frame = frame.astype(np.float32)
