"""Simulated time."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.core.sensor import Sensor
from morse.helpers.components import add_kind


class Clock(Sensor):
    """Publishes simulated time, in ``timestamp``."""

    _name = "Clock"
    _short_desc = "A sensor that publishes simulated time"
    _builder = BuilderDefaults(visual=Visual("cylinder", (0.02, 0.02, 0.02), (0.9, 0.9, 0.9)))

    add_kind("clock", now="timestamp")
