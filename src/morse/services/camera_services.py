"""Services that move the viewpoint of the live view; part of the pseudo component ``simulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import POSITION, Length, Point
from morse.core.mathutils import Euler, Matrix
from morse.core.services import service
from morse.core.validation.arguments import Range

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.scene import ViewSettings

#: 4x4 matrix, row by row
Transform = Annotated[list[list[float]], Range(POSITION["low"], POSITION["high"], shape=(4, 4))]
#: aspect ratio and sensor width (mm) of the viewpoint camera
_ASPECT, _SENSOR = 16.0 / 9.0, 32.0


class ViewpointServices(AbstractObject):
    """Services for ``CameraFP``, the viewpoint camera of the scene.

    Args:
        changed: callback after every change.
    """

    def __init__(self, view: ViewSettings, on_change: Callable[[], None]) -> None:
        super().__init__()
        self._view = view
        self._changed = on_change

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def set_camarafp_far_clip(self, far_clip: Length) -> None:
        """Set the far clipping distance of the viewpoint camera, m; it must be greater than the near distance."""
        near, _ = self._view.camera_clip
        if far_clip <= near:
            raise MorseRPCInvokationError(
                f"far_clip has to be greater than the near clip, {near:g} m, not {far_clip:g}"
            )
        self._view.camera_clip = (near, float(far_clip))
        self._changed()

    @service(changes=False)
    def get_camarafp_position(self) -> list[float]:
        """The position of the viewpoint camera, m."""
        return list(self._view.camera_location)

    @service(changes=False)
    def set_camarafp_position(self, position: Point) -> None:
        """Set the position of the viewpoint camera, m."""
        x, y, z = map(float, position)
        self._view.camera_location = (x, y, z)
        self._changed()

    @service(changes=False)
    def get_camarafp_transform(self) -> list[list[float]]:
        """The pose of the viewpoint camera, 4x4."""
        matrix = Euler(self._view.camera_rotation).to_matrix().to_4x4()
        for i, value in enumerate(self._view.camera_location):
            matrix[i][3] = value
        return [list(row) for row in matrix]

    @service(changes=False)
    def set_camarafp_transform(self, transform: Transform) -> None:
        """Set the pose of the viewpoint camera, 4x4."""
        rows = [[float(number) for number in row] for row in transform]
        x, y, z = Matrix([row[:3] for row in rows[:3]]).to_euler()
        self._view.camera_rotation = (x, y, z)
        self._view.camera_location = (rows[0][3], rows[1][3], rows[2][3])
        self._changed()

    @service(changes=False)
    def get_camarafp_projection_matrix(self) -> list[list[float]]:
        """The projection of the viewpoint camera, 4x4 as OpenGL uses it, for a 16:9 view."""
        near, far = self._view.camera_clip
        f = 2.0 * self._view.camera_focal_length / _SENSOR
        return [
            [f, 0.0, 0.0, 0.0],
            [0.0, f * _ASPECT, 0.0, 0.0],
            [0.0, 0.0, (far + near) / (near - far), 2.0 * far * near / (near - far)],
            [0.0, 0.0, -1.0, 0.0],
        ]
