"""A colour sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.helpers.components import add_data, add_property
from morse.mathutils.portable import linear_light
from morse.sensors.camera import Camera

if TYPE_CHECKING:
    from morse.core.limits import Limits
    from morse.rendering import Picture

_CHANNEL: Limits = {"unit": "1", "low": 0.0, "high": 1.0}


class ColorSensor(Camera):
    """Measures the mean colour in a narrow cone: red, green and blue light, and all light.

    The numbers are linear light, 1 for white in full light: those of the data sheets of such sensors are proportional
    to it. They are the means of the pixels of a small camera.
    """

    _name = "Colour sensor"
    _short_desc = "Mean colour in a narrow cone"
    _builder = BuilderDefaults(
        frequency=10.0, properties={"cam_width": 8, "cam_height": 8, "cam_fov": 20.0, "cam_near": 0.005}
    )

    add_data("red", 0.0, "float", "Red light", **_CHANNEL)
    add_data("green", 0.0, "float", "Green light", **_CHANNEL)
    add_data("blue", 0.0, "float", "Blue light", **_CHANNEL)
    add_data("clear", 0.0, "float", "All light, by the weights of ITU-R BT.709", follows="red", **_CHANNEL)

    add_property("errors", False, "errors", "bool", "With noise of 1 %")

    uses = ("rgb",)
    errors: bool

    def take(self, picture: Picture) -> None:
        """Measure the colour."""
        assert picture.rgba is not None
        light = linear_light(np.arange(256) / 255.0)[picture.rgba[..., :3]].reshape(-1, 3).mean(axis=0)
        if self.errors:
            light = np.clip(light * (1.0 + 0.01 * self.tick_random("light").standard_normal(3)), 0.0, 1.0)
        for name, value in zip(("red", "green", "blue"), light.tolist(), strict=True):
            self.local_data[name] = value

    def report(self) -> None:
        """Compute all light."""
        data = self.local_data
        data["clear"] = 0.2126 * data["red"] + 0.7152 * data["green"] + 0.0722 * data["blue"]
