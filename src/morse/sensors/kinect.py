"""A colour camera and a depth camera in one housing."""

from __future__ import annotations

from morse.core.declarations import BuilderDefaults
from morse.helpers.components import add_kind
from morse.sensors.camera_unit import CameraUnit


class Kinect(CameraUnit):
    """Carries a colour camera ``rgb`` and a depth camera ``depth``."""

    _name = "Kinect"
    _short_desc = "Microsoft Kinect RGB-D sensor"
    _builder = BuilderDefaults(frequency=20.0)

    add_kind(None)
