"""Several synchronised cameras."""

from __future__ import annotations

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_kind
from morse.sensors.camera_unit import CameraUnit


class StereoUnit(CameraUnit):
    """Carries cameras that capture images simultaneously."""

    _name = "Stereo Camera Unit"
    _short_desc = "A pair of cameras to perform stereo vision"
    _builder = BuilderDefaults(visual=Visual("cube", (0.025, 0.24, 0.01), (0.2, 0.2, 0.2)))

    add_kind(None)
