"""Laser scanners, whose rays a script may create again."""

from __future__ import annotations

from morse.builder.creator import SensorCreator
from morse.core import declarations
from morse.core.exceptions import MorseBuilderError

_SHAPE = ("scan_window", "resolution", "layers", "layer_separation", "layer_offset")


class LaserSensorWithArc(SensorCreator):
    """A laser scanner; `morse.sensors.laserscanner.LaserScanner` runs."""

    _classpath = "morse.sensors.laserscanner.LaserScanner"

    def create_laser_arc(self) -> None:
        """Check the properties that say where the rays go.

        The rays are made from these properties when the simulation starts, whether this is called or not.

        Raises:
            MorseBuilderError: no fan of rays has such properties.
        """
        # scripts that make no arcs themselves should not wait for numpy
        from morse.helpers.fans import fan

        cls = self.component_class()
        declared = {} if cls is None else {p.name: p.default for p in declarations.properties(cls).values()}
        values = [self.property_value(name) for name in _SHAPE]
        given = [declared[name] if value is None else value for name, value in zip(_SHAPE, values, strict=True)]
        try:
            fan(*given)
        except ValueError as error:
            raise MorseBuilderError(f"{type(self).__name__}.create_laser_arc(): {error}") from None
