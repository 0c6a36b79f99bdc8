"""Distances in a fan of directions, by laser."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.core.exceptions import MorseRPCTypeError
from morse.core.local_data import Later, LocalData
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_data, add_level, add_property
from morse.helpers.fans import fan

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.noise import Noise

#: of the fan of a rotating scanner, downward
_TILT = math.radians(12.0)


class LaserScanner(Sensor):
    """Measures the distance to the first thing in each direction of a fan, or of several above each other.

    Directions are counted from right to left, layer by layer, the upper one first. The robot that carries the
    scanner is looked through, and so is everything that does not collide.
    """

    _name = "Laser scanner"
    _short_desc = "Generic laser range sensors"
    _builder = BuilderDefaults(frequency=10.0)

    add_level("raw", None, doc="points and distances", default=True)
    add_level("rssi", None, doc="with the remission: how much light comes back")
    add_level("range", None, doc="distances alone")

    add_data(
        "point_list",
        [],
        "list",
        "Where each ray hit something, [x, y, z] in the frame of the sensor; [0, 0, 0] for no hit",
        level=["raw", "rssi"],
        unit="m",
    )
    add_data("range_list", [], "list", "Distance along each ray; laser_range for no hit", unit="m")
    add_data("remission_list", [], "list", "Specular reflection of what was hit, 0..1; 0 for no hit", level="rssi")

    add_property("laser_range", 30.0, "laser_range", "float", "How far it sees, m")
    add_property("resolution", 1.0, "resolution", "float", "Angle between two rays, degrees")
    add_property("scan_window", 180.0, "scan_window", "float", "Full angle of the fan, degrees")
    add_property("visible_arc", False, "Visible_arc", "bool", "Show the rays in the view")
    add_property("layers", 1, "layers", "integer", "Number of fans above each other")
    add_property("layer_separation", 0.8, "layer_separation", "float", "Angle between two layers, degrees")
    add_property("layer_offset", 0.125, "layer_offset", "float", "Every other layer is turned by this, degrees")

    laser_range: float
    resolution: float
    scan_window: float
    visible_arc: bool
    layers: int
    layer_separation: float
    layer_offset: float

    def __init__(self, obj: Any, parent: Any = None) -> None:
        super().__init__(obj, parent)
        self.local_data = LocalData(self.local_data)
        self.create_laser_arc()

    def create_laser_arc(self) -> None:
        """Make the rays from the properties.

        Raises:
            ValueError: no fan has such properties.
        """
        self._arc = self._arc_properties()
        self.add_rays(self._directions(), self.laser_range)

    def _arc_properties(self) -> tuple[float, ...]:
        return (
            self.laser_range,
            self.scan_window,
            self.resolution,
            self.layers,
            self.layer_separation,
            self.layer_offset,
        )

    def _directions(self) -> NDArray[np.float64]:
        reach, *shape = self._arc_properties()
        if not 0.0 < reach < math.inf:
            raise ValueError(f"laser_range takes a number of metres greater than 0, got {reach!r}")
        return fan(*shape)

    @service
    def set_property(self, name: str, value: Any) -> None:
        """Change a property while the simulation runs."""
        before = dict(self.__dict__)
        super().set_property(name, value)
        try:
            self._directions()
        except ValueError as error:
            self.__dict__.update(before)
            raise MorseRPCTypeError(f"{self.name()}: {error}") from None

    def default_action(self) -> None:
        """Take the scan."""
        if self._arc != self._arc_properties():
            self.create_laser_arc()
        rays, data = self.rays, self.local_data
        rays.refresh()
        sight = rays.sight
        data["range_list"] = Later(sight.range_list)
        if self.level != "range":
            data["point_list"] = Later(sight.point_list)
        if self.level == "rssi":
            data["remission_list"] = rays.remissions.tolist()

    def noisy_fields(self) -> tuple[str, ...]:
        """Noise is in the distances; the points follow them."""
        return ("range_list",)

    def add_noise(self, field: str, noise: Noise, before: Any) -> None:
        """Measure distances, or remissions, with errors; a lost echo is no hit."""
        rays, data = self.rays, self.local_data
        met = rays.hit >= 0
        if field != "range_list":
            rows = np.array(data[field], dtype=np.float64)
            rows[met] = noise.errors(rows[met], common=True)
            data[field] = rows.tolist()
            return
        distances = noise.errors(rays.ranges, common=True)
        met &= ~noise.lost(len(rays)) & (distances < self.laser_range)
        distances = np.where(met, np.maximum(distances, 0.0), self.laser_range)
        data["range_list"] = distances.tolist()
        if "point_list" in data:
            data["point_list"] = (rays.directions * np.where(met, distances, 0.0)[:, None]).tolist()
        if "remission_list" in data:
            data["remission_list"] = np.where(met, rays.remissions, 0.0).tolist()


class LaserScannerRotationZ(LaserScanner):
    """A laser scanner whose fan stands upright and turns about the vertical axis, by a step a measurement.

    The fan is tilted 12 degrees down, as that of a Velodyne HDL-64E, which sees from 2 degrees up to 25 down.
    """

    _name = "Velodyne"
    _short_desc = "Rotating laser scanner with an upright fan of rays"
    _builder = BuilderDefaults("VelodyneRayCast", frequency=10.0)

    add_property("_rotation", 0.01745, "rotation", "float", "Step about the Z axis after each measurement, radians")

    _rotation: float

    def _directions(self) -> NDArray[np.float64]:
        flat = super()._directions()
        # a quarter turn about X, then the tilt about Y
        upright = np.stack([flat[:, 0], -flat[:, 2], flat[:, 1]], axis=1)
        c, s = math.cos(_TILT), math.sin(_TILT)
        return np.asarray(upright @ np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]]))

    def default_action(self) -> None:
        """Take the scan, and turn on."""
        super().default_action()
        self.bge_object.applyRotation((0.0, 0.0, self._rotation), True)
