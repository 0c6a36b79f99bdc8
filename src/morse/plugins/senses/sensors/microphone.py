"""A microphone array."""

from __future__ import annotations

import math

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_data, add_property
from morse.plugins.senses.scanning import number_of
from morse.plugins.senses.sources import sources, walls


class Microphone(Sensor):
    """Measures the level of sound, and the direction of the loudest source.

    An object with the property ``sound_level`` is a source of that level at 1 m, dB. The level of a source falls by 20
    log r in free air and by ``wall_loss`` for each object between; the levels of sources add as powers, with the
    ``floor``.
    """

    _name = "Microphone"
    _short_desc = "Level of sound, and direction of the loudest source"
    _source = "ISO 9613-2, divergence"
    _builder = BuilderDefaults(frequency=20.0, visual=Visual("cylinder", (0.02, 0.02, 0.01), (0.1, 0.1, 0.1)))

    add_data("level", 0.0, "float", "Of all sources", unit="dB")
    add_data("azimuth", 0.0, "float", "Of the loudest source, to the left of X", unit="rad", angle=True)
    add_data("elevation", 0.0, "float", "Of the loudest source", unit="rad", low=-math.pi / 2.0, high=math.pi / 2.0)
    add_data("heard", False, "bool", "Whether a source is louder than the floor")
    add_property("floor", 30.0, "floor", "float", "Level without sources", unit="dB", low=-20.0, high=150.0)
    add_property("wall_loss", 30.0, "wall_loss", "float", "Loss by an object between", unit="dB", low=0.0, high=200.0)

    floor: float
    wall_loss: float

    def measure(self) -> None:
        """Measure level and direction."""
        power = 10.0 ** (self.floor / 10.0)
        loudest, data = self.floor, self.local_data
        data["heard"], data["azimuth"], data["elevation"] = False, 0.0, 0.0
        for source in sources(self, "sound_level"):
            level = number_of(source.body, "sound_level", -100.0, -100.0, 250.0)
            level -= 20.0 * math.log10(max(source.distance, 0.01))
            level -= self.wall_loss * len(walls(self, source.body))
            power += 10.0 ** (level / 10.0)
            if level > loudest:
                loudest = level
                data["heard"], data["azimuth"], data["elevation"] = True, source.azimuth, source.elevation
        data["level"] = 10.0 * math.log10(power)
