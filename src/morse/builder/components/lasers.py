"""Laser scanners."""

from __future__ import annotations

from morse.builder.creator import SensorCreator
from morse.core import declarations
from morse.core.exceptions import MorseBuilderError

_SHAPE = ("scan_window", "resolution", "layers", "layer_separation", "layer_offset")


class LaserSensorWithArc(SensorCreator):
    """A laser scanner; its component class is `morse.sensors.laserscanner.LaserScanner`."""

    _classpath = "morse.sensors.laserscanner.LaserScanner"

    def create_laser_arc(self) -> None:
        """Validate the properties that determine the rays.

        The rays are created from these properties when the simulation starts, even if this method is not called.

        Raises:
            MorseBuilderError: the properties are not valid for a fan of rays.
        """
        # imported on demand, because importing numpy takes time
        from morse.helpers.fans import fan

        cls = self.component_class()
        defaults = {} if cls is None else {p.name: p.default for p in declarations.properties(cls).values()}
        values = [self.property_value(name) for name in _SHAPE]
        shape = [defaults[name] if value is None else value for name, value in zip(_SHAPE, values, strict=True)]
        try:
            fan(*shape)
        except ValueError as error:
            raise MorseBuilderError(f"{type(self).__name__}.create_laser_arc(): {error}") from None
