"""A row of reflectance sensors for lines on the ground."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.helpers.components import add_data, add_property
from morse.mathutils.portable import linear_light
from morse.sensors.camera import Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.rendering import Picture


def reflectance(rgba: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the luminance (..., ), 0 to 1, of colours (..., 3 or 4) in sRGB, by the weights of ITU-R BT.709."""
    light = linear_light(np.arange(256) / 255.0)
    red, green, blue = (light[rgba[..., axis]] for axis in range(3))
    return np.asarray(0.2126 * red + 0.7152 * green + 0.0722 * blue)


class LineSensor(Camera):
    """Measures how much light comes from points in a row, and where a dark line is among them.

    It is a camera of one row, which is mounted so that it looks down: textures, lamps and shadows count. ``position``
    is the mean of the places of the elements, from 1 at the left to -1 at the right, weighted by how dark they are
    against the brightest; 0 if all are equal.
    """

    _name = "Line sensor"
    _short_desc = "A row of reflectance sensors that finds a line"
    _builder = BuilderDefaults(
        frequency=30.0, properties={"cam_width": 8, "cam_height": 1, "cam_fov": 60.0, "cam_near": 0.005}
    )

    add_data("values", [], "list<float>", "Light of each element, the leftmost first", shape=(None,), low=0.0, high=1.0)
    add_data("position", 0.0, "float", "Place of the line: 1 left, -1 right", low=-1.0, high=1.0, follows="values")

    add_property("errors", False, "errors", "bool", "With noise of 2 %")

    uses = ("rgb",)
    errors: bool

    def take(self, picture: Picture) -> None:
        """Measure the light of each element."""
        assert picture.rgba is not None
        values = reflectance(picture.rgba).mean(axis=0)
        if self.errors:
            values = np.clip(values + self.tick_random("light").standard_normal(values.shape) * 0.02, 0.0, 1.0)
        self.local_data["values"] = values.tolist()

    def report(self) -> None:
        """Compute the position from the light."""
        values = np.asarray(self.local_data["values"], dtype=np.float64)
        dark = values.max(initial=0.0) - values
        places = np.linspace(1.0, -1.0, len(values)) if len(values) > 1 else np.zeros(len(values))
        total = float(dark.sum())
        self.local_data["position"] = float((dark * places).sum()) / total if total > 1e-6 else 0.0
