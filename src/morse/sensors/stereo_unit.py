"""Several synchronised cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_kind
from morse.helpers.transformation import Transformation3d
from morse.sensors.camera_unit import CameraUnit

if TYPE_CHECKING:
    from morse.sensors.camera import Camera

#: largest deviation of the axes of a pair, and of its displacement from them
_PARALLEL = 1e-6


class StereoUnit(CameraUnit):
    """Carries cameras that capture images simultaneously."""

    _name = "Stereo Camera Unit"
    _short_desc = "A pair of cameras to perform stereo vision"
    _builder = BuilderDefaults(visual=Visual("cube", (0.025, 0.24, 0.01), (0.2, 0.2, 0.2)))

    add_kind(None)

    def baseline_of(self, camera: Camera) -> float:
        """Return the distance of the right camera of a parallel pair from the left one, m; 0 for all other cameras."""
        others = [other for other in self.cameras() if other is not camera]
        if len(others) != 1:
            return 0.0
        left = Transformation3d(others[0].bge_object).transformation3d_with(Transformation3d(camera.bge_object))
        # the axes of a camera are those of its image: X to the right
        offset, rotation = left.get_pose()
        is_parallel = max(abs(rotation[0] - 1.0), abs(rotation[4] - 1.0), abs(rotation[8] - 1.0)) < _PARALLEL
        is_beside = max(abs(offset[1]), abs(offset[2])) <= _PARALLEL * offset[0]
        return float(offset[0]) if is_parallel and is_beside and offset[0] > 0.0 else 0.0
