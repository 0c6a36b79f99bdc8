"""Laser scanners: they have rays that a script may want to make anew."""

from __future__ import annotations

from typing import Any, ClassVar

from morse.builder import workspace
from morse.builder.creator import SensorCreator
from morse.core import declarations
from morse.core.declarations import Visual
from morse.core.exceptions import MorseBuilderError

__all__ = ["Hokuyo", "Infrared", "LaserScanner", "LaserSensorWithArc", "Sick", "SickLDMRS", "VelodyneRayCast"]

_SHAPE = ("scan_window", "resolution", "layers", "layer_separation", "layer_offset")


class LaserSensorWithArc(SensorCreator):
    """A laser scanner; `morse.sensors.laserscanner.LaserScanner` runs.

    Attributes:
        _settings: properties that differ from those of a plain scanner.
        _rate: Hz.
        _visual: the body that marks it in the view, or None.
        _mesh: model file and the object in it that is its body, or None.
    """

    _classpath = "morse.sensors.laserscanner.LaserScanner"
    _settings: ClassVar[dict[str, Any]] = {}
    _rate = 10.0
    _visual: Visual | None = Visual("cylinder", (0.05, 0.05, 0.05), (0.1, 0.1, 0.1))
    _mesh: tuple[str, str] | None = None

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name)
        self.frequency(self._rate)
        self.properties(**self._settings)
        if self._mesh is not None:
            model, mesh = self._mesh
            for body in self.append_meshes([mesh], model):
                workspace.current().attach(self.scene_node, body.node)
        elif self._visual is not None:
            self._add_marker(self._visual)

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


class LaserScanner(LaserSensorWithArc):
    """A laser scanner without presets: 30 m, 180 degrees, 1 degree."""


class Sick(LaserSensorWithArc):
    """A SICK LMS: 30 m, 180 degrees, 1 degree, 10 Hz."""

    _settings: ClassVar[dict[str, Any]] = {
        "laser_range": 30.0,
        "scan_window": 180.0,
        "resolution": 1.0,
        "Visible_arc": False,
    }
    _mesh = ("sick", "SickMesh")


class SickLDMRS(LaserSensorWithArc):
    """A SICK LD-MRS: 30 m, 100 degrees, 0.25 degrees, four layers, 4 Hz."""

    _settings: ClassVar[dict[str, Any]] = {
        "laser_range": 30.0,
        "scan_window": 100.0,
        "resolution": 0.25,
        "layers": 4,
        "layer_separation": 0.8,
        "layer_offset": 0.125,
        "Visible_arc": False,
    }
    _rate = 4.0
    _visual = Visual("cube", (0.05, 0.0825, 0.044), (1.0, 1.0, 0.9))


class Hokuyo(LaserSensorWithArc):
    """A Hokuyo: 30 m, 270 degrees, 0.25 degrees, 10 Hz."""

    _settings: ClassVar[dict[str, Any]] = {
        "laser_range": 30.0,
        "scan_window": 270.0,
        "resolution": 0.25,
        "Visible_arc": False,
    }
    _visual = Visual("cylinder", (0.04, 0.04, 0.08), (0.0, 0.0, 0.0))


class Infrared(LaserSensorWithArc):
    """An infrared proximity sensor: 2 m, 20 degrees, 1 degree, 10 Hz."""

    _settings: ClassVar[dict[str, Any]] = {
        "laser_range": 2.0,
        "scan_window": 20.0,
        "resolution": 1.0,
        "Visible_arc": True,
    }
    _visual = Visual("cube", (0.02, 0.02, 0.02), (0.8, 0.8, 0.8))


class VelodyneRayCast(LaserSensorWithArc):
    """A turning upright fan of rays: 50 m, 31.5 degrees, 0.5 degrees; it turns by 0.01745 rad a measurement."""

    _classpath = "morse.sensors.laserscanner.LaserScannerRotationZ"
    _settings: ClassVar[dict[str, Any]] = {
        "laser_range": 50.0,
        "scan_window": 31.5,
        "resolution": 0.5,
        "Visible_arc": False,
    }
    _mesh = ("velodyne", "VelodyneMesh")
