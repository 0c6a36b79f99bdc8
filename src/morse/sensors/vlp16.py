"""A Velodyne VLP-16 with a horizontal field of view of 180 degrees."""

from __future__ import annotations

from morse.core.declarations import BuilderDefaults
from morse.sensors.depth_camera_aggregator import DepthCameraAggregator


class VLP16_180(DepthCameraAggregator):  # noqa: N801 (its name in MORSE 1.4)
    """Sixteen rows of points over 180 degrees, computed from three depth cameras."""

    _name = "VLP-16"
    _short_desc = "Velodyne VLP-16 over 180 degrees: three depth cameras of which 16 rows are kept"
    _builder = BuilderDefaults(frequency=10.0)
